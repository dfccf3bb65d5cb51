"""Clothoids against adaptive quadrature and published Fresnel integrals."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from roadgpt.geometry import Piece, PieceCurve


def integrated(angle: Callable[[float], float], length: float) -> tuple[float, float]:
    x, _ = quad(lambda s: np.cos(angle(s)), 0, length, epsabs=1e-12, limit=200)
    y, _ = quad(lambda s: np.sin(angle(s)), 0, length, epsabs=1e-12, limit=200)
    return x, y


@given(st.floats(1, 80), st.floats(-0.07, 0.07), st.floats(-0.07, 0.07), st.floats(-4, 4))
def test_a_piece_ends_where_quadrature_says(length: float, k0: float, k1: float, heading: float) -> None:
    def angle(s: float) -> float:
        return heading + k0 * s + (k1 - k0) * s * s / (2 * length)

    end = PieceCurve(0.0, 0.0, heading, (Piece(length, k0, k1),)).at(length)
    assert end == pytest.approx(integrated(angle, length), abs=1e-9)


@given(st.floats(1, 80), st.floats(-0.07, 0.07), st.sampled_from([1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4]))
def test_almost_arcs_are_as_exact(length: float, k0: float, change: float) -> None:
    end = PieceCurve(0.0, 0.0, 0.0, (Piece(length, k0, k0 + change),)).at(length)
    expected = integrated(lambda s: k0 * s + change * s * s / (2 * length), length)
    assert end == pytest.approx(expected, abs=1e-9)


def test_the_fresnel_integrals_of_abramowitz_and_stegun() -> None:
    """Table 7.7 (Handbook of Mathematical Functions, 1964): C(1) = 0.7798934, S(1) = 0.4382591."""
    curve = PieceCurve(0.0, 0.0, 0.0, (Piece(1.0, 0.0, np.pi),))
    assert curve.at(1.0) == pytest.approx([0.7798934, 0.4382591], abs=5e-8)
