"""Descriptions of measured roads: their facts are those of the road; the same seed gives the same ones."""

import re
from collections.abc import Iterator
from itertools import islice

import pytest

from design.short_searches import short_searches
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.slots import slotted
from roadgpt_training.back_labelling import measured_pairs
from roadgpt_training.pair import Pair, standard
from roadgpt_training.tokens import tokens_of


@pytest.fixture(scope="module")
def pairs() -> Iterator[list[Pair]]:
    """The searches are short because nobody reads what is said of plans without a road."""
    with short_searches():
        yield [*islice(measured_pairs(5), 12)]


def test_plans_stand_as_plans_are_written_and_their_numbers_are_in_the_text(pairs: list[Pair]) -> None:
    for pair in pairs:
        assert standard(read_plan(pair.plan)) == pair.plan
        numbers = {float(number) for number in re.findall(r"\d+", pair.text)}
        assert {abs(float(number)) for number in re.findall(r"=(-?\d+)", pair.plan)} <= numbers | {0.0}
    assert sum(tokens_of(pair.plan, slotted(pair.text).slots) is not None for pair in pairs) > 9


def test_sides_are_said_as_often_as_they_are_planned(pairs: list[Pair]) -> None:
    for pair in pairs:
        for side in ("left", "right"):
            said = len(re.findall(side, pair.text))
            planned = sum(
                int(clause.count.lo or 0) for clause in read_plan(pair.plan).clauses if clause.side == side
            )
            assert said == planned


def test_the_same_seed_describes_the_same_roads(pairs: list[Pair]) -> None:
    assert [*islice(measured_pairs(5), 5)] == pairs[:5]
    assert [*islice(measured_pairs(6), 5)] != pairs[:5]
