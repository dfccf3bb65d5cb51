"""Degrees of all turns together: read, said, promised, and measured on the roads by another's rule."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt import World, build, draft, read
from roadgpt.brief import check, exactly
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("three turns with a total heading change of 270 degrees, uphill", "turn x3 | up turning=270"),
        ("four turns, total heading change no less than 300 deg", "turn x4 | turning=300.."),
        ("two lefts that add up to 180 degrees, then a straight", "turn x2 left; straight | turning=180"),
        ("five bends, at most 200 degrees of turning in all", "turn x5 | turning=..200"),
        ("Drei Kurven, insgesamt 270 Grad", "turn x3 | turning=270"),
        ("trois virages, 200 degrés au total", "turn x3 | turning=200"),
        ("3 turns total angle around 270 for all of them together", "turn x3 | turning=270"),
        ("five turns, accumulated heading change of 300 degrees or more", "turn x5 | turning=300.."),
        ("three left turns that add up to 270 degrees", "turn x3 left | turning=270"),
    ],
)
def test_degrees_of_all_turns_together_are_read(words: str, wanted: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(wanted)))


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("a 90 degree left, then 40 m", "turn left deg=90; straight len=40"),
        ("three turns in all", "turn x3"),
        ("three bends of 60 degrees", "turn x3 deg=60"),
        ("400 m in total, two turns", "turn x2 | len=400"),
    ],
)
def test_other_degrees_and_other_totals_are_no_degrees_of_all_turns(words: str, wanted: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(wanted)))


def test_the_trained_reader_reads_it() -> None:
    brief = read("three turns; 270 degrees of turning in all")
    assert brief.turning == exactly(270)
    assert brief.unused == ()


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("hairpin x2 | turning=90", "add up to 280 degrees or more"),
        ("turn x2 deg=45 | turning=400", "degrees at most"),
        ("straight | turning=90", "no turns"),
        ("turn x3.. | turning=5000", "no map"),
    ],
)
def test_sums_that_no_turns_have_are_refused(line: str, reason: str) -> None:
    with pytest.raises(BriefError, match=reason):
        check(read_plan(line))


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
