"""The share of the car outside the right lane, beside shapely's."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon

from roadgpt.drive.lane_position import LanePolygon
from roadgpt.road import Road, World

NODES = [(20, 30), (60, 40), (95, 75), (90, 120), (120, 150), (170, 140), (190, 90)]
ROAD = Road.through(NODES)
LANE = LanePolygon.along(ROAD, World())
# The lane as one polygon, three times finer than the strip under test.
S = np.linspace(0.0, ROAD.length, 3 * (len(LANE.edges) - 1) + 1)
POLYGON = Polygon(np.vstack([ROAD.at(S)[:, :2], ROAD.at(S, -4.0)[::-1, :2]]))


@given(st.floats(0.0, 1.0), st.floats(-9.0, 5.0), st.floats(-math.pi, math.pi))
@settings(max_examples=60)
def test_the_share_outside_is_shapelys(share, t, turned):
    s = share * ROAD.length
    x, y, _ = ROAD.at(s, t)
    heading = float(ROAD.heading(s)) + turned
    c, n = math.cos(heading), math.sin(heading)
    outline = np.array([[-2.45, -0.93], [2.25, -0.93], [2.25, 0.93], [-2.45, 0.93]])
    box = outline @ np.array([[c, n], [-n, c]]) + [x, y]
    car = Polygon(box)
    expected = 1 - car.intersection(POLYGON).area / car.area
    # A chord of half a metre is at most 2 mm off these arcs: along 5 m of edge a thousandth of the car.
    assert LANE.outside(box, s) == pytest.approx(expected, abs=1.5e-3)
