"""Defines the tests that generators make, and counts them by outcome."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from functools import cached_property
from itertools import count
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple

from roadgpt_client import ClientError, plain
from roadgpt_inside import ask
from self_driving.road_polygon import RoadPolygon

rounding_precision = 3
interpolation_distance = 1
smoothness = 0
min_num_nodes = 20

HEIGHT = -28.0  # m, of the competition's flat level
ROAD_WIDTH = 8.0  # m
ALWAYS = ("is_valid", "validation_message", "road_points")
ONCE_DRIVEN = ("id", "execution_data", "test_outcome", "description", "features")
COLUMNS = ("test_generated", "test_valid", "test_invalid", "test_passed", "test_failed", "test_in_error")
TIMES = ("real_time_generation", "real_time_execution", "simulated_time_execution")

Node = Tuple[float, float, float, float]


class RoadTestFactory:
    """Makes tests and gives them numbers."""

    test_id_generator: Iterator[int] = count(1)

    class RoadTest:
        """A test, which is one road. The executor sets its results: ``id``, ``execution_data``,
        ``test_outcome``, ``description``, ``features``."""

        id: int

        def __init__(self, road_points: Any) -> None:
            """Makes a test from control points: a list of pairs, or AssertionError as in the competition."""
            if type(road_points) is not list:
                raise AssertionError("road points are a list of pairs of numbers")
            if any(len(point) != 2 for point in road_points):
                raise AssertionError("every road point is a pair of numbers")
            self.road_points = road_points[:]
            self.interpolated_points = interpolated(road_points)
            self.is_valid: Optional[bool] = None
            self.validation_message: Optional[str] = None

        @cached_property
        def road_polygon(self) -> RoadPolygon:
            return RoadPolygon.from_nodes(self.interpolated_points)

        def get_road_polygon(self) -> RoadPolygon:
            return self.road_polygon

        def get_road_length(self, interpolate_road_points: bool = False) -> float:
            """Returns the length in metres along the interpolated points, which the competition's validator
            first interpolates again."""
            nodes = [node[:2] for node in self.interpolated_points]
            if interpolate_road_points:
                nodes = nodes_of(nodes)
            return math.fsum(math.hypot(x1 - x0, y1 - y0) for (x0, y0), (x1, y1) in zip(nodes, nodes[1:]))

        def set_validity(self, is_valid: bool, validation_message: str) -> None:
            self.is_valid, self.validation_message = is_valid, validation_message

        def to_json(self) -> str:
            """Returns the test as JSON, with the fields of the competition's test files."""
            data = {name: getattr(self, name) for name in ALWAYS}
            data["interpolated_points"] = [node[:2] for node in self.interpolated_points]
            data.update({name: getattr(self, name) for name in ONCE_DRIVEN if hasattr(self, name)})
            return json.dumps(data, default=plain)

    @staticmethod
    def create_road_test(road_points: Any) -> "RoadTestFactory.RoadTest":
        test = RoadTestFactory.RoadTest(road_points)
        test.id = next(RoadTestFactory.test_id_generator)
        return test


def interpolated(road_points: Sequence[Sequence[float]]) -> List[Node]:
    """Returns the competition's interpolated points of a road, each as (x, y, height, width) in metres."""
    if len(road_points) < 2:
        raise ValueError("a road needs two points or more")
    return [(x, y, HEIGHT, ROAD_WIDTH) for x, y in nodes_of(road_points)]


_interpolate = interpolated  # the competition's name


def nodes_of(road_points: Sequence[Sequence[float]]) -> List[Tuple[float, float]]:
    """Returns x and y of the competition's interpolated points of a road, in metres."""
    points = [[float(point[0]), float(point[1])] for point in road_points]
    try:
        return [(x, y) for x, y in ask("nodes", points=points)]
    except ClientError as error:
        raise ValueError(str(error)) from error


@dataclass
class TestGenerationStatistic:
    """Counts tests by outcome, and records the seconds that each test took."""

    __test__ = False  # pytest must not collect this class, in spite of its name

    test_generated: int = 0
    test_valid: int = 0
    test_invalid: int = 0
    test_passed: int = 0
    test_failed: int = 0
    test_in_error: int = 0
    obes: int = 0
    """Number of tests that failed because the car left its lane."""
    test_generation_real_times: List[float] = field(default_factory=list)
    test_execution_real_times: List[float] = field(default_factory=list)
    test_execution_simulation_times: List[float] = field(default_factory=list)

    def add(self, outcome: str, description: str) -> None:
        self.test_generated += 1
        if outcome == "INVALID":
            self.test_invalid += 1
            return
        self.test_valid += 1
        self.test_passed += outcome == "PASS"
        self.test_failed += outcome == "FAIL"
        self.test_in_error += outcome == "ERROR"
        self.obes += outcome == "FAIL" and description.startswith("Car drove out of the lane")

    def _row(self) -> Dict[str, float]:
        counts = {name: float(getattr(self, name)) for name in COLUMNS}
        times = self.test_generation_real_times, self.test_execution_real_times
        seconds = map(sum, (*times, self.test_execution_simulation_times))
        return {**counts, **dict(zip(TIMES, seconds))}

    def __str__(self) -> str:
        return "\n".join(f"{name.replace('_', ' ')}: {value:g}" for name, value in self._row().items())

    def as_csv(self) -> str:
        row = self._row()
        return ",".join(row) + "\n" + ",".join(f"{value:g}" for value in row.values())
