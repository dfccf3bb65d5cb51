"""Laws of height profiles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.geometry import CubicProfile, GradeProfile, shifted
from roadgpt.geometry.elevation import closed


@st.composite
def profiles(draw: st.DrawFn) -> GradeProfile:
    grades = draw(st.lists(st.floats(-0.15, 0.15), min_size=2, max_size=8))
    steps = draw(st.lists(st.floats(0.5, 80), min_size=len(grades) - 1, max_size=len(grades) - 1))
    return GradeProfile(draw(st.floats(-28, 50)), (0.0, *np.cumsum(steps).tolist()), tuple(grades))


@given(profiles(), st.floats(0.01, 0.99))
def test_grade_is_the_slope_of_the_height(profile: GradeProfile, share: float) -> None:
    s, step = share * profile.stations[-1], 1e-4
    slope = (profile.height(s + step) - profile.height(s - step)) / (2 * step)
    assert profile.grade(s) == pytest.approx(slope, abs=1e-4)


@given(profiles())
def test_heights_and_grades_have_no_jump(profile: GradeProfile) -> None:
    at = np.array(profile.stations[1:-1])
    for ask in (profile.height, profile.grade):
        assert ask(at - 1e-9) == pytest.approx(ask(at + 1e-9), abs=1e-7)


@given(profiles(), st.floats(-0.1, 1.1))
def test_one_station_has_the_height_and_the_grade_of_many(profile: GradeProfile, share: float) -> None:
    s = np.array([share * profile.stations[-1], *profile.stations])
    found = np.array([profile.at(each) for each in s.tolist()])
    assert found[:, 0] == pytest.approx(profile.height(s), abs=1e-12)
    assert found[:, 1] == pytest.approx(profile.grade(s), abs=1e-12)


def test_a_parabola_between_two_grades_is_the_textbook_one() -> None:
    """A crest from +4 % to -2 % over 60 m: its top lies 40 m in, 0.8 m up (y = g1 x - (g1-g2) x^2 / 2L)."""
    profile = GradeProfile(0.0, (0.0, 60.0), (0.04, -0.02))
    assert profile.height(40.0) == pytest.approx(0.8)
    assert profile.grade(40.0) == pytest.approx(0.0)
    assert profile.height(60.0) == pytest.approx(0.6)
    assert profile.vertical_curvature(30.0) == pytest.approx(-0.001)


@given(
    st.lists(st.tuples(*[st.floats(-2, 2)] * 4), min_size=1, max_size=4), st.floats(-3, 13), st.floats(-1, 1)
)
def test_a_cubic_from_another_station_is_the_same_curve(
    rows: list[tuple[float, float, float, float]], s: float, ahead: float
) -> None:
    """numpy.polynomial is the second opinion; the first cubic also applies before its station."""
    profile = CubicProfile(tuple(4.0 * n for n in range(len(rows))), tuple(rows))
    n = min(max(int(s // 4), 0), len(rows) - 1)
    cubic, u = np.polynomial.Polynomial(rows[n]), s - 4 * n
    for found, wanted in (
        (profile.height(s), cubic(u)),
        (profile.grade(s), cubic.deriv()(u)),
        (profile.vertical_curvature(s), cubic.deriv(2)(u)),
        (shifted(np.array([rows[n]]), u)[0], [cubic.deriv(k)(u) / (1, 1, 2, 6)[k] for k in range(4)]),
    ):
        assert found == pytest.approx(wanted, abs=1e-8)
    expected = cubic(u + ahead)
    assert np.polynomial.Polynomial(profile.cubic(s))(ahead) == pytest.approx(expected, abs=1e-8)
    assert profile.cubics([s]).tolist() == [list(profile.cubic(s))]


@given(
    st.lists(st.tuples(*[st.integers(-8, 8).map(lambda n: n / 4)] * 4), min_size=1, max_size=3),
    st.floats(-6, 0),
    st.floats(0, 6),
)
def test_what_lies_farthest_outside_a_range_is_found(
    rows: list[tuple[float, float, float, float]], low: float, high: float
) -> None:
    """Between the stations and at both ends of each cubic; behind the last station it is its height there."""
    profile = CubicProfile(tuple(2.0 * n for n in range(len(rows))), tuple(rows))
    u = np.linspace(0.0, 2.0, 1001)
    z = np.array([*(np.polynomial.Polynomial(row)(u) for row in rows[:-1]), np.full(len(u), rows[-1][0])])
    s = u + 2.0 * np.arange(len(rows))[:, None]
    s[-1] = s[-1, 0]
    most = np.maximum(low - z, z - high).max()
    assert profile.extremes() == (pytest.approx(z.min(), abs=1e-4), pytest.approx(z.max(), abs=1e-4))
    found = profile.beyond(low, high)
    assert (found is None) == (most <= 1e-6)
    if found is not None:
        assert max(low - found[1], found[1] - high) == pytest.approx(most, abs=1e-4)
        assert (np.abs(s - found[0]) + np.abs(z - found[1])).min() < 0.01


CUBIC = (1.0, 0.0, 0.0, 0.0)


@given(
    st.lists(st.tuples(*[st.integers(-4, 4).map(lambda n: n / 8)] * 4), min_size=1, max_size=4),
    st.floats(0.05, 1.0),
)
def test_a_profile_ends_with_its_road(cubics: list[tuple[float, float, float, float]], share: float) -> None:
    """Rows from the end of the road on say nothing of it: at the end is what the row before it leads to."""
    starts = [5.0 * n for n in range(len(cubics))]
    end = 5.0 * len(cubics) * share
    for more in (
        [],
        [(end, (9.0, 0.0, 0.0, 0.0))],
        [(end, (9.0, 1.0, 0.0, 0.0)), (end + 1, (7.0, 0.0, 0.0, 0.0))],
    ):
        known = [row for row in zip(starts, cubics, strict=True) if row[0] < end - 0.01]
        profile = closed([*known, *more], end)
        at = np.array([*np.linspace(0.0, end, 9), end + 3.0])
        row = [max(n for n, (start, _) in enumerate(known) if start <= min(s, end - 1e-6)) for s in at]
        wanted = [
            np.polynomial.Polynomial(known[n][1])(min(s, end) - known[n][0])
            for n, s in zip(row, at, strict=True)
        ]
        assert profile.height(at) == pytest.approx(wanted, abs=1e-6)
