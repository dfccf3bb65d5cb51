"""What the network for scenes may write, and which numbers of a text are kept from all networks."""

import contextlib
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.grammar import END, PlanAutomaton, any_change, whole
from roadgpt.brief.readers.model.neural_network import WINDOW, WordPieces
from roadgpt.brief.readers.model.scenes import asked_in, joined, with_named, with_origin, without_scene
from roadgpt.brief.readers.model.slots import NumberSlot, slotted
from roadgpt.brief.readers.model.vocabulary import NUMBER_OF, TOKENS, Compared, change_of
from roadgpt.errors import RoadGPTError
from roadgpt_training.field import parted
from roadgpt_training.tokens import tokens_of

DATA = Path(__file__).resolve().parents[2] / "training" / "data" / "field"
TEXTS = sorted(path for name in ("train", "validation") for path in (DATA / name).glob("*.jsonl"))


def test_plans_of_texts_of_the_field_survive_being_cut_into_tokens() -> None:
    """Nearly all: a few labels have a number that the text tells in words, or behind other numbers."""
    lines = [line for path in TEXTS for line in path.read_text(encoding="utf-8").splitlines()[::27]]
    pairs = [row for row in map(json.loads, lines) if not row["plan"].startswith("!")]
    written = 0
    for row in pairs:
        asked, text = read_plan(row["plan"]), slotted(row["text"])
        road, told = (tokens_of(part, text.slots, Compared.of(text.text)) for part in parted(row["plan"]))
        if road is None or told is None:
            continue
        writer = PlanAutomaton(text.slots, frozenset(word.text for word in text.words), whole=whole)
        for token in (*road, *told, END):
            if NUMBER_OF[token] not in writer.allowed():
                break
            writer.push(token)
        else:
            written += 1
            found = asked_in((*road, *told), text.slots)
            assert found.scene == asked.scene, row
            assert (found.comes_from, found.junctions) == (asked.comes_from, normal(asked).junctions), row
    assert len(pairs) > 300
    assert written >= 0.95 * len(pairs)


@given(
    st.integers(0, 10_000),
    st.lists(st.sampled_from([0.3, 12.0, 40.0, 80.5, 100.0]), max_size=4),
    st.booleans(),
)
def test_whatever_the_network_may_write_of_scenes_is_read_or_refused_in_one_sentence(
    seed: int, values: list[float], is_change: bool
) -> None:
    rng = np.random.default_rng(seed)
    slots = [NumberSlot(value, str(rng.choice(["kmh", "metres", "percent", ""]))) for value in values]  # type: ignore[arg-type]
    writer = PlanAutomaton(slots, frozenset({"3", "15"}), whole=any_change if is_change else whole)
    written: list[str] = []
    while len(written) < 200:
        token = TOKENS[int(rng.choice(writer.allowed()))]
        if token == END:
            break
        writer.push(token)
        written.append(token)
    if not written or written[0].startswith("!"):
        return
    with contextlib.suppress(RoadGPTError):  # such as two causes for one action
        if is_change:
            line = change_plan(read_change_plan(change_of(written, slots)))
            assert change_plan(read_change_plan(line)) == line
        else:
            asked = asked_in(written, slots)
            assert read_plan(plan(asked)) == asked


@pytest.mark.parametrize(
    ("text", "read", "values"),
    [
        ("a 2004 Ford at 50 mph", "a year ford at [unused1] kmh", [80.5]),
        ("a 43-year-old at 18:40 on 12 May 2012", "a age - year - old at time : time on date may date", []),
        ("a driver aged 43", "a driver aged age", []),
        ("I-95 and Route 66", "i - number and route number", []),
        ("brakes with 8 m/s2, then 0.4 g", "brakes with [unused1] mps2 , then [unused2] mps2", [8.0, 3.9]),
        ("15 m/s", "[unused1] kmh", [54.0]),
        ("a road of 2,001 m", "a road of [unused1] metres [unused21]", [2001.0]),
        ("a radius of 2000", "a radius of [unused1]", [2000.0]),
        ("a route of 3 turns", "a route of 3 turns", []),
        ("50 g 3", "[unused1] g 3", [50.0]),
        ("1:10 uphill", "[unused1] percent uphill", [10.0]),
        ("friction 0.25", "friction [unused1]", [0.25]),
        ("eastbound at 70 in a 55 zone", "eastbound at [unused1] kmh in a [unused2] kmh zone", [112.7, 88.5]),
        ("V1 35 mph, V2 doing about 15", "v 1 [unused1] kmh , v 2 doing about [unused2] kmh", [56.3, 24.1]),
        ("northbound, slowed to 20, 3 lanes", "northbound , slowed to [unused1] kmh , 3 lanes", [32.2]),
        (
            "northbound at 70 behind a car doing 60 km/h",
            "northbound at [unused1] behind a car doing [unused2] kmh",
            [70.0, 60.0],
        ),
        ("northbound at 40 Main Street", "northbound at [unused1] main street", [40.0]),
        ("the car drives at 70", "the car drives at [unused1]", [70.0]),
    ],
)
def test_numbers_of_texts_become_slots_words_and_speeds(text: str, read: str, values: list[float]) -> None:
    found = slotted(text)
    assert (found.text, [slot.value for slot in found.slots]) == (read, values)


def test_a_long_text_is_encoded_in_chunks_that_end_with_sentences() -> None:
    pieces = WordPieces(["[PAD]", "[CLS]", "[SEP]", "[UNK]", "a", "b", "."])
    words = [*["a"] * 100, ".", *["b"] * 60, ".", *["a"] * 300]
    chunks = pieces.encode(words)
    assert [len(chunk) for chunk in chunks[:2]] == [103, 63]
    assert all(chunk[0] == 1 and chunk[-1] == 2 and len(chunk) <= WINDOW + 2 for chunk in chunks)
    inner = [pieces.number[word] for word in words]
    assert [piece for chunk in chunks for piece in chunk[1:-1]] == inner
    assert pieces.encode(["a"] * 5) == [[1, 4, 4, 4, 4, 4, 2]]


def test_a_scene_joins_its_road_and_replaces_what_was_named_beside_it() -> None:
    road = read_plan("turn left r=40 | lanes=1 against=1 beside(pedestrian, rain, kerb)")
    told = read_plan("| country && adult crossing left: cross; rain")
    both = joined(road, told)  # a design speed of 80 km/h is not for a radius of 40 m
    assert plan(both) == plan(
        read_plan("turn left r=40 | lanes=1 against=1 beside(kerb) && adult crossing left: cross; rain")
    )
    gentle = joined(read_plan("turn left r=400"), told)
    assert (gentle.surroundings, gentle.speed) == ("country", 80)
    named = with_named(read_plan("turn | beside(kerb, night, snow, ice)"))
    assert plan(named) == "turn | beside(kerb, ice) && night; snow"


def test_road_users_that_the_scene_lacks_are_named() -> None:
    text = slotted("a truck ahead at 60 km/h, a bus stop, a cyclist, after 300 m")
    assert [*without_scene(text, read_plan("&& truck ahead v=60"), ())] == ["cyclist"]
    assert [*without_scene(text, read_plan("turn"), ["cyclist"])] == ["truck"]


@pytest.mark.parametrize(
    ("words", "came", "comes"),
    [
        ("V1 southbound", "south", "north"),
        ("V1 southbound, V2 northbound", "south", "south"),
        ("heading east - north of town", "east", "west"),
        ("from the south", "south", "south"),
        ("a NB car", "north", "south"),
        ("northeast - bound", "northeast", "southwest"),
    ],
)
def test_who_goes_south_comes_from_the_north(words: str, came: str, comes: str) -> None:
    found = with_origin(read_plan(f"| from={came}"), slotted(words))
    assert found.comes_from == comes
