"""Routes put together of hand-written pairs, and the sides of routes swapped: the labels stay true."""

import json
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from covering import covering
from roadgpt.brief.junctions import JunctionClause
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import WEIGHTS
from roadgpt.brief.readers.model.neural_network import WordPieces
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.vocabulary import OF_ROADS, TOKENS, plan_of
from roadgpt.reading import read_text
from roadgpt_training.data import NETWORK, example, examples
from roadgpt_training.mirror import in_mirror_plan, in_mirror_tokens, mirrored
from roadgpt_training.pair import Pair, standard
from roadgpt_training.routes import routes
from roadgpt_training.tokens import tokens_of
from tables import rows

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture(scope="module")
def pairs() -> list[Pair]:
    """Every fourth of the hand-written pairs of routes."""
    lines = [
        json.loads(line)
        for path in sorted((DATA / "networks" / "train").glob("*.jsonl"))
        for line in path.read_text(encoding="utf-8").splitlines()[::4]
    ]
    return [Pair(**line) for line in lines]


@pytest.fixture(scope="module")
def plans(pairs: list[Pair]) -> list[str]:
    return sorted({pair.plan for pair in pairs if not pair.plan.startswith("!")})


@pytest.fixture(scope="module")
def few(pairs: list[Pair]) -> list[Pair]:
    """Pairs that together have each word of the plans, and each two words in a row, twice."""
    asked = [pair for pair in pairs if not pair.plan.startswith("!")]
    return [asked[place] for place in covering([pair.plan for pair in asked], 2)]


def other_way(junction: JunctionClause) -> JunctionClause:
    """The same junction seen in a mirror, by its fields."""
    swap = {"left": "right", "right": "left"}

    def turned(word: str | None) -> str | None:
        head, bar, tail = (word or "").rpartition("_")
        return f"{head}{bar}{swap.get(tail, tail)}" or None

    order = ("left", "right", "straight")
    ways = {
        name: tuple(way for way in order if way in {swap.get(each, each) for each in getattr(junction, name)})
        for name in ("ways", "only_in", "only_out")
    }
    return junction.model_copy(update={"take": turned(junction.take), "side": turned(junction.side), **ways})


def test_a_mirror_of_a_mirror_is_the_plan_itself(plans: list[str]) -> None:
    for line in plans:
        assert in_mirror_plan(in_mirror_plan(line)) == line
    assert in_mirror_tokens(in_mirror_tokens(TOKENS)) == TOKENS


def test_a_mirrored_plan_takes_every_junction_on_the_other_side(few: list[Pair]) -> None:
    for line in (pair.plan for pair in few):
        brief, seen = read_plan(line), read_plan(in_mirror_plan(line))
        assert [other_way(junction) for junction in brief.junctions] == list(seen.junctions)
        assert len(brief.stretches) == len(seen.stretches)
        assert brief.left_hand == seen.left_hand


def test_tokens_and_words_of_a_plan_are_mirrored_alike(few: list[Pair]) -> None:
    for pair in few:
        slots = slotted(pair.text).slots
        tokens = tokens_of(pair.plan, slots)
        if tokens:
            seen = plan_of(in_mirror_tokens(tokens), slots)
            assert standard(read_plan(seen)) == standard(read_plan(in_mirror_plan(pair.plan)))


@pytest.mark.parametrize(("text", "line", "seen"), rows(__file__, "texts_routes_mirrored"))
def test_texts_of_routes_are_mirrored(text: str, line: str, seen: tuple[str, str]) -> None:
    found = mirrored(text, line)
    assert found is not None
    assert found[0] == seen[0]
    assert seen[1] in found[1]


@pytest.mark.parametrize(("text", "line"), rows(__file__, "right_more_than"))
def test_where_right_is_more_than_the_other_side_of_left_nothing_is_swapped(text: str, line: str) -> None:
    if "that is the third exit" in text:
        line = "roundabout exit=3"
    assert mirrored(text, line) is None


def test_routes_put_together_ask_for_their_parts_in_order() -> None:
    rng = np.random.default_rng(1)
    roads = [
        Pair("two bends uphill", "turn x2 | up", "f", "en"),
        Pair("A hairpin bend.", "hairpin", "f", "en"),
    ]
    junctions = [
        Pair("A crossroads, right.", "crossroads right", "networks/f", "en"),
        Pair("roundabout, second exit", "roundabout exit=2", "networks/f", "en"),
    ]
    texts = {pair.plan: pair.text.strip(" .").lower() for pair in (*roads, *junctions)}
    for pair in islice(routes(roads, junctions, rng), 300):
        assert pair.plan == plan(read_plan(pair.plan))
        assert pair.family.startswith(NETWORK)
        place = -1
        for part in pair.plan.split(" // "):
            place = pair.text.lower().index(texts[part], place + 1)


def test_no_pair_of_networks_is_also_one_of_roads() -> None:
    networks, roads = (texts_of(DATA / "networks" / "train"), texts_of(DATA / "descriptions"))
    assert len(networks) > 10_000
    assert len(roads) > 10_000
    assert not networks & roads


def test_networks_for_single_roads_learn_no_token_of_routes() -> None:
    """So they cannot write a junction, and the reader sees that a route is beyond them."""
    pieces = WordPieces(read_text(WEIGHTS / "pieces.txt").split("\n"))
    pair = Pair("left at the T", "t_junction left", "f", "en")
    road = Pair("a left bend", "turn left", "f", "en")
    assert max(example(pair, pieces).tokens) >= len(OF_ROADS)  # type: ignore[union-attr]
    written = list(islice(examples(3, [pair, road], pieces), 60))
    assert {max(each.tokens) for each in written} < {*range(len(OF_ROADS))}


def texts_of(folder: Path) -> set[str]:
    """The texts in all files of a folder, in lower case."""
    return {
        " ".join(json.loads(line)["text"].lower().split())
        for path in folder.rglob("*.jsonl")
        for line in path.read_text(encoding="utf-8").splitlines()
    }
