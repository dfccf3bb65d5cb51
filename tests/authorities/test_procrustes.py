"""scipy's orthogonal Procrustes agrees on how far two roads are apart."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import orthogonal_procrustes

from roadgpt.design.variety import POINTS, STEP, PlanShape, apart, apart_by_metres, shape_of


def random_line(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    s = np.arange(0.0, rng.uniform(60, 320))
    heading = np.cumsum(np.convolve(rng.normal(0, 0.15, len(s)), np.ones(25) / 25, "same"))
    return s, np.cumsum(np.exp(1j * heading))


def slow(a: np.ndarray, b: np.ndarray) -> float:
    """RMS distance of points x + iy after the best shift, turn and mirror."""
    p, q = (np.stack([z.real - z.real.mean(), z.imag - z.imag.mean()], axis=1) for z in (a, b))
    best, _ = orthogonal_procrustes(p, q)  # rotations and mirrors
    return float(np.sqrt(((p @ best - q) ** 2).sum(axis=1).mean()))


def at(line: tuple[np.ndarray, np.ndarray], stations: np.ndarray) -> np.ndarray:
    s, z = line
    return np.interp(stations, s, z.real) + 1j * np.interp(stations, s, z.imag)


@given(st.integers(0, 10**6))
def test_distances_agree(seed: int) -> None:
    rng = np.random.default_rng(seed)
    own, *others = (random_line(rng) for _ in range(5))
    shapes = PlanShape(*(np.array(column) for column in zip(*(shape_of(*o) for o in others), strict=True)))
    by_share, by_metres = apart(shape_of(*own), shapes), apart_by_metres(shape_of(*own), shapes)
    for i, other in enumerate(others):
        pair = [at(line, np.linspace(0, line[0][-1], POINTS)) for line in (own, other)]
        assert by_share[i] == pytest.approx(slow(*pair), abs=1e-5)
        upto = np.arange(0.0, min(own[0][-1], other[0][-1]) + 1e-9, STEP)
        assert by_metres[i] == pytest.approx(slow(at(own, upto), at(other, upto)), abs=1e-4)
