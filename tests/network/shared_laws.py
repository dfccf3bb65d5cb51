"""Laws that hold for every kind of network, and what tests of refused designs have in common."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from roadgpt.errors import UsageError
from roadgpt.network import Network, RoadEnd


def pose(network: Network, end: RoadEnd, inwards: bool) -> np.ndarray:
    """The point (x, y, z) at an end, the direction of travel as a unit vector, and the grade in it."""
    road = network.road(end.road).road
    s = 0.0 if end.contact == "start" else road.length
    along = (end.contact == "end") == inwards
    heading = float(road.heading(s)) + (0.0 if along else math.pi)
    grade = float(road.grade(s)) * (1 if along else -1)
    return np.array([*road.at(s), math.cos(heading), math.sin(heading), grade])


def check_that_ways_join_the_arms(network: Network, exact: float) -> None:
    """Every connecting road begins and ends on the reference lines of its arms, in metres and radians."""
    for junction in network.junctions:
        for each in junction.connections:
            start = pose(network, RoadEnd(each.road, "start"), inwards=False)
            end = pose(network, RoadEnd(each.road, "end"), inwards=True)
            assert start == pytest.approx(pose(network, each.incoming, inwards=True), abs=exact)
            assert end == pytest.approx(pose(network, each.outgoing, inwards=False), abs=exact)


class Motion:
    """A design that is moved by (dx, dy, dz) metres, and turned about its start."""

    def __init__(self, data: dict[str, Any], by: tuple[float, float, float], degrees: float) -> None:
        x, y, z = data["starting_point"]
        dx, dy, dz = by
        self.design = {
            **data,
            "starting_point": [x + dx, y + dy, z + dz],
            "theta": data["theta"] + degrees,
        }
        self._start, self._by, self._angle = np.array([x, y]), by, math.radians(degrees)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Where points ``(n, 3)`` of the design as it was must lie afterwards."""
        cos, sin = math.cos(self._angle), math.sin(self._angle)
        plan = (points[:, :2] - self._start) @ np.array([[cos, sin], [-sin, cos]])
        return np.column_stack((plan + self._start + self._by[:2], points[:, 2] + self._by[2]))


def sentence_of(build: Callable[[Any], object], data: Any) -> str:
    """The one sentence with which a design is refused."""
    with pytest.raises(UsageError) as error:
        build(data)
    sentence = str(error.value)
    assert "\n" not in sentence
    assert "pydantic" not in sentence
    return sentence
