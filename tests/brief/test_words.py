"""The table of words, as data and as a page."""

from pathlib import Path
from typing import get_args

import pytest

from roadgpt.brief.model import Kind, Sharpness, Size, Slope
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import (
    KINDS,
    LENGTH_SLACK,
    PERCENT_SLACK,
    ROAD_LENGTH_SLACK,
    SHARPNESS,
    SIZES,
    SLOPES,
    degrees_slack,
    table,
)

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "words.md"


def test_the_page_is_the_table() -> None:
    assert PAGE.read_text("utf-8") == table()


def test_every_word_of_a_brief_has_a_meaning() -> None:
    assert set(KINDS) == set(get_args(Kind))
    assert set(SHARPNESS) == set(get_args(Sharpness))
    assert set(SIZES) == set(get_args(Size))
    assert set(SLOPES) == set(get_args(Slope))


@pytest.mark.parametrize(
    ("slope", "low", "high"),
    [
        ("up", 3, 12),
        ("down", -12, -3),
        ("flat", -1, 1),
        ("nearly_flat", -3.5, 3.5),
        ("gently_up", 2, 5),
        ("steeply_up", 8, 15),
        ("steeply_down", -15, -8),
    ],
)
def test_slopes_in_percent(slope: Slope, low: float, high: float) -> None:
    assert SLOPES[slope].grade == Range(low, high)


@pytest.mark.parametrize(("sharpness", "radius"), [("gentle", 40), ("sweeping", 60)])
def test_least_radius(sharpness: Sharpness, radius: float) -> None:
    assert SHARPNESS[sharpness].radius == Range(radius)


def test_sharp_turns_and_sizes() -> None:
    assert SHARPNESS["sharp"].radius == Range(0, 30)
    assert SHARPNESS["sharp"].degrees is not None
    assert SHARPNESS["sharp"].degrees.lo == 30
    assert SIZES["long"].length == Range(60)
    assert SIZES["short"].length is not None
    assert SIZES["short"].length.hi == 30


def test_slack() -> None:
    assert [degrees_slack(a) for a in (30, 60, 80, 90, 120)] == pytest.approx([3, 6, 7, 9, 10])
    assert (LENGTH_SLACK, ROAD_LENGTH_SLACK, PERCENT_SLACK) == (0.15, 0.10, 1.0)


def test_aims_lie_within_promises() -> None:
    for meaning in (*KINDS.values(), *SHARPNESS.values()):
        if meaning.aim and meaning.degrees:
            assert meaning.degrees.lo <= meaning.aim.lo < meaning.aim.hi <= meaning.degrees.hi


def test_a_range_holds_its_ends() -> None:
    assert 25 in Range(25, 120)
    assert 24.9 not in Range(25, 120)
    assert 1e6 in Range(40)
