"""Degrees of all turns together: read, said, promised, and measured on the roads by another's rule."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt import World, build, draft
from roadgpt.brief.plan import read_plan


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
