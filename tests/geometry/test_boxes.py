"""Checks boxes against shapely."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.geometry.boxes import corners, distance, part_inside, separation, touch

Box = tuple[float, float, float, float, float]

PLACES, SIZES = st.floats(-8, 8), st.floats(0.2, 12)
BOXES = st.tuples(PLACES, PLACES, st.floats(-7, 7), SIZES, SIZES)
"""x, y, heading, length and width."""


def polygon(box: Box) -> shapely.Polygon:
    """Returns a box as shapely turns and moves a rectangle."""
    x, y, heading, length, width = box
    around = shapely.box(-length / 2, -width / 2, length / 2, width / 2)
    c, s = math.cos(heading), math.sin(heading)
    return shapely.transform(around, lambda at: at @ np.array([[c, s], [-s, c]]) + [x, y])


@given(one=BOXES, two=BOXES)
def test_boxes_are_apart_and_touch_as_shapely_says(one: Box, two: Box) -> None:
    own, other = polygon(one), polygon(two)
    box, its = np.array([one]), np.array([two])
    pair = its[:, :2] - box[:, :2], box[:, 2], box[:, 3:], its[:, 2], its[:, 3:]
    apart, largest = own.distance(other), float(separation(*pair).max())
    assert float(distance(*pair)[0]) == pytest.approx(apart, abs=1e-9)
    assert largest <= apart + 1e-9
    if abs(largest) > 1e-9:
        assert (largest < 0) == own.intersects(other)
        assert touch(two[0] - one[0], two[1] - one[1], *one[2:], *two[2:]) == own.intersects(other)


@given(box=BOXES)
def test_corners_go_around_a_box_from_its_rear_right(box: Box) -> None:
    found = corners(np.array(box[:2]), box[2], np.array(box[3:]))
    assert shapely.Polygon(found).symmetric_difference(polygon(box)).area < 1e-9
    assert shapely.LinearRing(found).is_ccw
    ahead, left = found[1] - found[0], found[3] - found[0]
    assert ahead == pytest.approx(box[3] * np.array([math.cos(box[2]), math.sin(box[2])]), abs=1e-9)
    assert left == pytest.approx(box[4] * np.array([-math.sin(box[2]), math.cos(box[2])]), abs=1e-9)


@given(box=BOXES, start=st.tuples(PLACES, PLACES), end=st.tuples(PLACES, PLACES))
def test_the_part_of_a_line_in_a_box_is_that_of_shapely(
    box: Box, start: tuple[float, float], end: tuple[float, float]
) -> None:
    x, y, heading, length, width = box
    forward, left = end[0] - start[0], end[1] - start[1]
    low, high = part_inside(start[0] - x, start[1] - y, forward, left, heading, length, width, 0.0, 1.0)
    inside = polygon(box).intersection(shapely.LineString([start, end])).length
    assert max(high - low, 0.0) * math.hypot(forward, left) == pytest.approx(inside, abs=1e-6)
