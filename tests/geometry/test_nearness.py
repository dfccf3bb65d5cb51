"""Places where a line comes near to itself, compared with every pair of points, one after the other."""

import numpy as np
import pytest

from roadgpt.geometry.nearness import BLOCK, meeting


def pairs_one_by_one(
    z: np.ndarray, s: np.ndarray, earlier: np.ndarray, earlier_s: np.ndarray, apart: float, neighbours: float
) -> list[tuple[int, int]]:
    """All pairs in the order of the points of ``z``, then of the earlier ones."""
    return [
        (i, j)
        for i in range(len(z))
        for j in range(len(earlier))
        if abs(z[i] - earlier[j]) < apart and s[i] - earlier_s[j] > neighbours
    ]


def wandering_line(points: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A line whose heading drifts, with a point every 2 m, and the stations of its points."""
    heading = np.cumsum(np.random.default_rng(seed).normal(0.0, 0.3, points))
    return np.cumsum(2.0 * np.exp(1j * heading)), 2.0 * np.arange(points)


@pytest.mark.parametrize("points", [1, 2, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK + 7])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_all_pairs_are_found_in_order(points: int, seed: int) -> None:
    z, s = wandering_line(points, seed)
    found = list(zip(*(at.tolist() for at in meeting(z, s, z, s, 8.0, 26.0)), strict=True))
    assert found == pairs_one_by_one(z, s, z, s, 8.0, 26.0)


def test_a_long_line_meets_itself_somewhere() -> None:
    z, s = wandering_line(3 * BLOCK + 7, 1)
    assert len(meeting(z, s, z, s, 8.0, 26.0)[0]) > 0


def test_another_line_is_compared_from_its_own_points() -> None:
    z, s = wandering_line(200, 4)
    earlier, earlier_s = z[:70], s[:70]
    found = list(
        zip(*(at.tolist() for at in meeting(z[70:], s[70:], earlier, earlier_s, 9.0, 30.0)), strict=True)
    )
    assert found == pairs_one_by_one(z[70:], s[70:], earlier, earlier_s, 9.0, 30.0)
