"""Routes and maps from grammars: seeded, sensible, and true to what the rules say."""

import re
from itertools import islice

import numpy as np
import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.errors import RoadGPTError
from roadgpt_training.generator import EVEN, series
from roadgpt_training.grammar import Discarded, grammar_of
from roadgpt_training.labels import REFUSALS
from roadgpt_training.pair import Pair, is_held_out, standard
from roadgpt_training.routes import assembled_route, draw_route
from roadgpt_training.tokens import tokens_of

KINDS = {
    "t_junction", "y_junction", "crossroads", "star", "roundabout", "junction", "merge", "diverge",
    "lane_drop", "lane_gain", "lane_change", "map",
}  # fmt: skip
SAID = {
    "lights", "stop", "yield", "priority", "none", "all_way", "crosswalk", "mini", "large", "oneway",
    "divided", "left_hand", "motorway", "back", "ramp", "main", "skew",
}  # fmt: skip


@pytest.fixture(scope="module", params=sorted(EVEN))
def drawn(request: pytest.FixtureRequest) -> tuple[int, list[Pair]]:
    """A number of draws in a language, and the pairs that they gave."""
    rng = np.random.default_rng(4)
    tries = 150
    return tries, [pair for pair in (draw_route(request.param, rng) for _ in range(tries)) if pair]


def test_the_same_seed_gives_the_same_routes_and_another_others() -> None:
    one, again, other = (list(islice(series(seed, 6, draw_route), 30)) for seed in (5, 5, 6))
    assert one == again
    assert one != other


def test_a_language_tells_of_all_kinds_of_routes_in_many_ways(drawn: tuple[int, list[Pair]]) -> None:
    tries, found = drawn
    assert len(found) > 0.8 * tries
    assert len({pair.text for pair in found}) > 0.9 * len(found)
    assert sum(pair.plan.startswith("!") for pair in found) < 0.1 * len(found)


@pytest.mark.parametrize("language", sorted(EVEN))
def test_the_rules_of_a_language_use_every_word_of_the_plans_of_routes(language: str) -> None:
    rules = grammar_of(language, "networks").rules.values()
    plans = " ".join(rule.plan or rule.text for its in rules for rule in its)
    assert {*re.findall(r"[a-z_]+", plans)} >= KINDS | SAID
    assert "sharp_" in plans
    assert "slight_" in plans


def test_plans_are_in_standard_form_and_their_numbers_stand_in_the_text(
    drawn: tuple[int, list[Pair]],
) -> None:
    _, found = drawn
    lost = 0
    for pair in found:
        assert not is_held_out(pair.text)
        if not pair.plan.startswith(REFUSALS):
            assert standard(read_plan(pair.plan)) == pair.plan
        lost += tokens_of(pair.plan, slotted(pair.text).slots) is None
    assert lost < 0.05 * len(found)


@pytest.mark.parametrize(
    ("raw", "plan"),
    [
        ("left stop t_junction", "t_junction left stop"),
        ("|len=80 // exit=2 roundabout // up |", None),
        ("|len=80 // exit=2 roundabout // |up ", "| len=80 // roundabout exit=2 // | up"),
        ("left turn |up // crossroads straight", "turn left | up // crossroads straight"),
        ("@flat crossroads // t_junction", "| flat // crossroads // | flat // t_junction // | flat"),
        (
            "turn left // crossroads @oneway ||left_hand",
            "turn left | oneway // crossroads // | oneway || left_hand",
        ),
        ("exit= roundabout arms=4", "roundabout arms=4"),
        ("t_junction crossroads", None),
        ("map columns=3 rows=2 lights", "map columns=3 rows=2 lights"),
        ("crossroads !contradiction sides", "!contradiction sides"),
        (" // ".join(["junction"] * 7), None),
        ("back roundabout // crossroads", None),
    ],
)
def test_parts_are_put_into_the_order_of_plans(raw: str, plan: str | None) -> None:
    if plan is None:
        with pytest.raises((Discarded, RoadGPTError)):
            assembled_route(raw)
    else:
        assert (
            read_plan(assembled_route(raw)) == read_plan(plan)
            if plan[0] != "!"
            else assembled_route(raw) == plan
        )
