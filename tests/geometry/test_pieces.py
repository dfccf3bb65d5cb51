"""Laws of plan curves made of lines, arcs and clothoids."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.geometry import Piece, PieceCurve, project, wrap_angle
from roadgpt.geometry.curve import wrapped
from roadgpt.geometry.pieces import along_all, joined

curvatures = st.floats(-1 / 14, 1 / 14)
pieces = st.lists(st.builds(Piece, st.floats(0.5, 60), curvatures, curvatures), min_size=1, max_size=6)
curves = st.builds(
    PieceCurve, st.floats(-200, 200), st.floats(-200, 200), st.floats(-10, 10), pieces.map(tuple)
)


@given(curves)
def test_the_curve_is_as_long_as_its_polyline(curve: PieceCurve) -> None:
    s = np.linspace(0, curve.length, 4001)
    walked = np.hypot(*np.diff(curve.at(s), axis=0).T).sum()
    assert walked == pytest.approx(curve.length, rel=1e-5)


@given(curves, st.floats(0, 1))
def test_moving_along_the_curve_moves_along_its_heading(curve: PieceCurve, share: float) -> None:
    s, step = share * curve.length, 1e-4
    ahead = (curve.at(s + step) - curve.at(s - step)) / (2 * step)
    heading = curve.heading(s)
    assert ahead == pytest.approx([np.cos(heading), np.sin(heading)], abs=1e-5)


@given(curves)
def test_heading_is_the_integral_of_curvature(curve: PieceCurve) -> None:
    turned = sum(p.length * (p.k0 + p.k1) / 2 for p in curve.pieces)
    assert curve.heading(curve.length) - curve.heading(0.0) == pytest.approx(turned, abs=1e-9)


@given(curves)
def test_no_gap_between_pieces(curve: PieceCurve) -> None:
    joints = np.cumsum([p.length for p in curve.pieces])[:-1]
    gaps = np.hypot(*(curve.at(joints + 1e-9) - curve.at(joints - 1e-9)).T)
    assert np.all(gaps < 1e-8)


@given(curves)
def test_the_end_is_where_the_curve_is_after_its_length(curve: PieceCurve) -> None:
    x, y, heading = curve.end
    assert [x, y] == pytest.approx(curve.at(curve.length), abs=1e-9)
    assert heading == pytest.approx(curve.heading(curve.length), abs=1e-12)


@given(st.lists(curves, min_size=1, max_size=4))
def test_curves_together_are_where_each_is_alone(several: list[PieceCurve]) -> None:
    """Their ends and the joints of their pieces are among the stations."""
    stations = [np.r_[np.linspace(0, c.length, 9), np.cumsum([p.length for p in c.pieces])] for c in several]
    points, headings = along_all(several, stations)
    pairs = list(zip(several, stations, strict=True))
    assert points == pytest.approx(np.concatenate([c.at(s) for c, s in pairs]), abs=1e-9)
    assert headings == pytest.approx(np.concatenate([c.heading(s) for c, s in pairs]), abs=1e-12)


@given(st.floats(15, 200), st.floats(0.1, 3.0), st.floats(0, 1), st.floats(-13, 13))
def test_projection_undoes_offsets_on_an_arc(radius: float, angle: float, share: float, t: float) -> None:
    curve = PieceCurve(3, 4, 0.5, (Piece(radius * angle, 1 / radius, 1 / radius),))
    s = share * curve.length
    heading = curve.heading(s)
    point = curve.at(s) + t * np.array([-np.sin(heading), np.cos(heading)])
    found_s, found_t = project(curve, point)
    assert (found_s, found_t) == (pytest.approx(s, abs=1e-6), pytest.approx(t, abs=1e-6))


def test_neighbours_of_one_curvature_become_one_piece() -> None:
    parts = [Piece(5), Piece(0.0), Piece(7), Piece(3, 0, 0.1), Piece(4, 0.1, 0.1), Piece(6, 0.1, 0.1)]
    assert joined(parts) == (Piece(12), Piece(3, 0, 0.1), Piece(10, 0.1, 0.1))


@given(st.floats(-1e4, 1e4))
def test_wrapped_angles_point_the_same_way(angle: float) -> None:
    turned = wrap_angle(angle)
    assert -np.pi < turned <= np.pi
    assert np.cos(turned) == pytest.approx(np.cos(angle), abs=1e-9)
    assert np.sin(turned) == pytest.approx(np.sin(angle), abs=1e-9)
    assert wrapped(angle) == float(turned)
