"""Degrees of all turns together: read, said, promised, and measured on the roads by another's rule."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt import World, build, draft, read
from roadgpt.brief import Amount, at_least, at_most, check, exactly
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.total_turning import total_turning
from roadgpt.errors import BriefError


@pytest.mark.parametrize(
    ("words", "degrees", "rest"),
    [
        (
            "three turns with a total heading change of 270 degrees, uphill",
            exactly(270),
            "three turns , uphill",
        ),
        ("four turns, total heading change no less than 300 deg", at_least(300), "four turns"),
        (
            "two lefts that add up to 180 degrees, then a straight",
            exactly(180),
            "two lefts , then a straight",
        ),
        ("five bends, at most 200 degrees of turning in all", at_most(200), "five bends"),
        ("Drei Kurven, insgesamt 270 Grad", exactly(270), "Drei Kurven"),
        ("trois virages, 200 degrés au total", exactly(200), "trois virages"),
        ("turning 270 degrees in all", exactly(270), ""),
        ("3 turns total angle around 270 for all of them together", exactly(270), "3 turns"),
        ("five turns, accumulated heading change of 300 degrees or more", at_least(300), "five turns"),
    ],
)
def test_it_is_taken_out_of_the_words(words: str, degrees: Amount, rest: str) -> None:
    assert total_turning(words) == (degrees, rest)


@pytest.mark.parametrize(
    "words",
    [
        "a 90 degree left, then 40 m",
        "three turns in all",
        "three bends of 60 degrees",
        "400 m in total, two turns",
    ],
)
def test_other_degrees_and_other_totals_are_left_alone(words: str) -> None:
    assert total_turning(words) is None


def test_the_trained_reader_reads_it() -> None:
    brief = read("three turns; 270 degrees of turning in all")
    assert brief.turning == exactly(270)
    assert brief.unused == ()


@pytest.mark.parametrize(
    ("plan", "reason"),
    [
        ("hairpin x2 | turning=90", "add up to 280 degrees or more"),
        ("turn x2 deg=45 | turning=400", "degrees at most"),
        ("straight | turning=90", "no turns"),
        ("turn x3.. | turning=5000", "no map"),
    ],
)
def test_sums_that_no_turns_have_are_refused(plan: str, reason: str) -> None:
    with pytest.raises(BriefError, match=reason):
        check(read_plan(plan))


def total(points: np.ndarray) -> float:
    """Degrees of heading change, from the chords of 1 m alone."""
    x, y = np.diff(points[:, :2], axis=0).T
    return float(np.degrees(np.abs(np.diff(np.unwrap(np.arctan2(y, x))))).sum())


@given(st.integers(2, 5), st.integers(50, 90), st.integers(0, 2**20))
def test_the_turns_of_a_road_add_up_to_it(turns: int, each: int, seed: int) -> None:
    asked = turns * each
    brief = read_plan(f"turn x{turns} | turning={asked}")
    points = build(draft(brief, World(), seed=seed)).centreline()
    assert total(points) == pytest.approx(asked, rel=0.11, abs=4)


@pytest.mark.parametrize("asked", [150, 300, 450])
def test_a_road_of_which_only_the_sum_is_known_has_turns_enough(asked: int) -> None:
    for seed in range(5):
        points = build(draft(read_plan(f"| turns=1.. turning={asked}"), World(), seed=seed)).centreline()
        assert total(points) == pytest.approx(asked, rel=0.11, abs=4)


@pytest.mark.parametrize(
    ("words", "is_alike"),
    [
        ("three left turns of equal angle that add up to 270 degrees", True),
        ("Somme des changements de direction : 360 degrés, répartis à parts égales sur six virages", True),
        ("three left turns that add up to 270 degrees", False),
    ],
)
def test_a_sum_that_is_shared_equally_makes_equal_turns(words: str, is_alike: bool) -> None:
    brief = read(words)
    assert brief.turning is not None
    assert brief.alike is is_alike
