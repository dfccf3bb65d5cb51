"""How alike two roads are: laws that hold for any two, and the thesis' own case of a road that was turned."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import procrustes

from roadgpt.errors import UsageError
from roadgpt.report.similarity import compare, edits, likeness, similarity, spread
from roadgpt.road import Road, build
from strategies import designs

CRITERIA = ("turns", "sequence", "direction", "length", "incline", "shape", "general")
BEND = [[20, 20, 0], [60, 30, 2], [100, 60, 4], [110, 110, 7], [150, 140, 8], [190, 140, 8]]


def moved(points: list[list[float]], angle: float = 0.0, mirror: bool = False) -> Road:
    """Shifted, turned about the map's middle and, where asked, mirrored."""
    p = np.array(points, float)
    plan = p[:, :2] - 125
    if mirror:
        plan[:, 1] *= -1
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return Road.through(np.c_[plan @ turn + [130, 120], p[:, 2]].tolist())


@settings(max_examples=15)
@given(one=designs(), other=designs())
def test_laws(one, other) -> None:
    a, b = build(one), build(other)
    found, back = compare(a, b), compare(b, a)
    for name in CRITERIA:
        assert 0 <= getattr(found, name) <= 1
        assert getattr(found, name) == pytest.approx(getattr(back, name), abs=1e-9)
        assert getattr(compare(a, b, mirror=True), name) >= getattr(found, name) - 1e-9
        assert getattr(compare(a, a), name) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("angle", [0.3, 1.9, -2.5])
def test_turning_and_shifting_change_nothing(angle: float) -> None:
    found = compare(moved(BEND), moved(BEND, angle))
    assert found.general == pytest.approx(1, abs=1e-3)
    assert found.is_duplicate


def test_a_mirror_image_is_another_road_unless_asked() -> None:
    one, other = moved(BEND), moved(BEND, 0.4, mirror=True)
    assert compare(one, other).direction == 0
    assert not compare(one, other).is_duplicate
    assert compare(one, other, mirror=True).general == pytest.approx(1, abs=1e-3)


def test_the_distance_of_plans_is_that_of_procrustes() -> None:
    """scipy's scales both to one size; so the same spread is given to both here."""
    one = np.array(BEND, float)[:, :2]
    other = np.array([[20, 20], [60, 60], [110, 60], [150, 90], [160, 140], [200, 150]], float)
    roads = [Road.through(points.tolist()) for points in (one, other)]
    found = compare(*roads, mirror=True)
    shapes = [likeness(road).shape.shares for road in roads]
    plans = [np.stack([shape.real, shape.imag], axis=1) for shape in shapes]
    _, _, disparity = procrustes(*plans)
    a, b = (float((plan**2).sum()) for plan in plans)
    # disparity = 1 - trace^2 for plans of size 1; without scaling: a + b - 2 sqrt(a b) trace
    square = (a + b - 2 * np.sqrt(a * b * (1 - disparity))) / len(plans[0])
    assert found.metres == pytest.approx(np.sqrt(square), rel=1e-6)


@given(one=st.text("LRS", max_size=8), other=st.text("LRS", max_size=8))
def test_edits_are_those_of_the_slow_way(one: str, other: str) -> None:
    def slow(a: str, b: str) -> int:
        if not a or not b:
            return len(a) + len(b)
        if a[0] == b[0]:
            return slow(a[1:], b[1:])
        return 1 + min(slow(a[1:], b), slow(a, b[1:]), slow(a[1:], b[1:]))

    if len(one) + len(other) <= 10:
        assert edits(one, other) == slow(one, other)
    assert abs(len(one) - len(other)) <= edits(one, other) <= max(len(one), len(other))


def test_twins_among_many_are_named() -> None:
    other = [[30, 200, 0], [80, 190, 0], [120, 140, 0], [180, 130, 0], [200, 60, 0]]
    roads = [likeness(road) for road in (moved(BEND), Road.through(other), moved(BEND, 2.0, mirror=True))]
    found = spread(roads)
    assert found.duplicates == ((0, 2),)
    assert found.metres[0, 2] == pytest.approx(0, abs=0.05)
    assert np.isnan(np.diag(found.metres)).all()
    assert found.nearest[1] > 5
    assert spread(roads, mirror=False).duplicates == ()
    assert [similarity(roads[0], other, mirror=True).is_duplicate for other in roads[1:]] == [False, True]
    assert np.isnan(spread(roads[:1]).general)


def test_a_road_of_one_place_cannot_be_compared() -> None:
    with pytest.raises(UsageError):
        compare(Road.through([[1, 1], [1, 1]]), moved(BEND))
