"""A test as generators make it: the competition's RoadTest and what it is asked."""

import json
from collections.abc import Iterator
from functools import cached_property
from itertools import count
from typing import Any

import numpy as np

from roadgpt.check.sbft import TOO_FEW, sbft_verdict
from roadgpt.errors import RoadGPTError
from roadgpt.geometry import interpolate
from roadgpt.sbft.road_polygon import RoadPolygon

HEIGHT = -28.0  # m, of the competition's flat level
ROAD_WIDTH = 8.0  # m
LONGEST = 50_000.0  # m of control polyline; the spline through more would fill the memory
WRONG_TYPE = "Wrong type"
ALWAYS = ("is_valid", "validation_message", "road_points")
ONCE_DRIVEN = ("id", "execution_data", "test_outcome", "description", "features")

Node = tuple[float, float, float, float]


class RoadTestFactory:
    """Makes tests and numbers them."""

    test_id_generator: Iterator[int] = count(1)

    class RoadTest:
        """One road. What becomes of it is set by the executor: ``id``, ``execution_data``, ``test_outcome``,
        ``description``, ``features``."""

        id: int

        def __init__(self, road_points: Any) -> None:
            """A test of control points.

            Raises:
                AssertionError: not a list of pairs, or fewer than two: the competition's own error.
                ValueError: no spline goes through them.
            """
            if type(road_points) is not list:
                raise AssertionError("road points are a list of pairs of numbers")
            if any(len(point) != 2 for point in road_points):
                raise AssertionError("every road point is a pair of numbers")
            self.road_points = road_points[:]
            self.interpolated_points = interpolated(road_points)
            self.is_valid: bool | None = None
            self.validation_message: str | None = None

        @cached_property
        def road_polygon(self) -> RoadPolygon:
            """The area of the road."""
            return RoadPolygon.from_nodes(self.interpolated_points)

        def get_road_polygon(self) -> RoadPolygon:
            """The area of the road."""
            return self.road_polygon

        def get_road_length(self, interpolate_road_points: bool = False) -> float:
            """Metres along the interpolated points; or along those, interpolated once more, as the validator
            measures."""
            nodes = np.asarray(self.interpolated_points)[:, :2]
            if interpolate_road_points:
                nodes = interpolate(nodes)
            return float(np.hypot(*np.diff(nodes, axis=0).T).sum())

        def set_validity(self, is_valid: bool, validation_message: str) -> None:
            """What the validator says."""
            self.is_valid, self.validation_message = is_valid, validation_message

        def to_json(self) -> str:
            """As the competition's files have it."""
            data = {name: getattr(self, name) for name in ALWAYS}
            data["interpolated_points"] = [node[:2] for node in self.interpolated_points]
            data |= {name: getattr(self, name) for name in ONCE_DRIVEN if hasattr(self, name)}
            return json.dumps(data)

    @staticmethod
    def create_road_test(road_points: Any) -> "RoadTestFactory.RoadTest":
        """A test with the next number.

        Raises:
            AssertionError, ValueError: as ``RoadTest``.
        """
        test = RoadTestFactory.RoadTest(road_points)
        test.id = next(RoadTestFactory.test_id_generator)
        return test


def interpolated(road_points: list[Any]) -> list[Node]:
    """The competition's interpolated points: x, y, height and width, in metres.

    Raises:
        AssertionError: fewer than two points.
        ValueError: no spline goes through them.
    """
    if len(road_points) < 2:
        raise AssertionError("a road needs two points or more")
    points = np.asarray([[float(x), float(y)] for x, y in road_points])
    if not np.isfinite(points).all():
        raise ValueError("a number of the road points is not finite")
    if np.hypot(*np.diff(points, axis=0).T).sum() > LONGEST:
        raise ValueError(f"a road of more than {LONGEST / 1000:g} km")
    try:
        nodes = interpolate(points)
    except RoadGPTError as error:
        raise ValueError(str(error)) from error
    return [(x, y, HEIGHT, ROAD_WIDTH) for x, y in nodes.tolist()]


class TestValidator:
    """The competition's validator, quirks included."""

    __test__ = False  # pytest is not to collect it, for all its name

    def __init__(self, map_size: float, min_road_length: float = 20.0) -> None:
        """For a square map; the length is the competition's, whatever is asked for."""
        self.map_size = map_size
        self.min_road_length = min_road_length
        self.box = (0, 0, map_size, map_size)

    def validate_test(self, the_test: Any) -> tuple[bool, str]:
        """(is it valid, and the first complaint): never raises."""
        if type(the_test) is not RoadTestFactory.RoadTest:
            return False, WRONG_TYPE
        points = the_test.road_points
        if len(points) < 2:
            return False, TOO_FEW
        try:
            return sbft_verdict(np.asarray(points, float), self.map_size)
        except (RoadGPTError, TypeError, ValueError) as error:
            return False, str(error)
