"""Validates roads as the competition's validator does."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any, Sequence, Tuple

from code_pipeline.tests_generation import RoadTestFactory
from roadgpt_client import ClientError
from roadgpt_inside import ask
from self_driving.bbox import RoadBoundingBox

FEET_PER_METRE = 3.280839895
STRAIGHT = 1e-6  # m^2: three nodes that span less (twice the triangle's area) lie on a line
WRONG_TYPE = "Wrong type"
TOO_FEW = "Not enough road points."
TOO_MANY = "The road definition contains too many points"
OUTSIDE = "Not entirely inside the map boundaries"
CROSSING = "The road is self-intersecting"
TOO_SHORT = "The road is not long enough."
TOO_SHARP = "The road is too sharp"


def find_circle(p1: Sequence[float], p2: Sequence[float], p3: Sequence[float]) -> float:
    """Returns the radius of the circle through three points, in metres; infinite if they are on a line."""
    square = p2[0] * p2[0] + p2[1] * p2[1]
    one = (p1[0] * p1[0] + p1[1] * p1[1] - square) / 2
    other = (square - p3[0] * p3[0] - p3[1] * p3[1]) / 2
    area = (p1[0] - p2[0]) * (p2[1] - p3[1]) - (p2[0] - p3[0]) * (p1[1] - p2[1])
    if abs(area) < STRAIGHT:
        return math.inf
    x = (one * (p2[1] - p3[1]) - other * (p1[1] - p2[1])) / area
    y = ((p1[0] - p2[0]) * other - (p2[0] - p3[0]) * one) / area
    return math.sqrt((x - p1[0]) ** 2 + (y - p1[1]) ** 2)


def smallest_circle(nodes: Sequence[Sequence[float]], w: int) -> float:
    """Returns the smallest radius, in metres, of the circles through the first, middle and last node of each
    window of w nodes.

    The last window is left out, as in the competition's code. Returns infinity if there is no window.
    """
    windows = range(len(nodes) - w)
    return min(
        (find_circle(nodes[i], nodes[i + (w - 1) // 2], nodes[i + w - 1]) for i in windows), default=math.inf
    )


def min_radius(x: Sequence[Sequence[float]], w: int = 5) -> float:
    """Returns the smallest radius of curvature of the nodes, in feet; 0 if the nodes are collinear or too
    few."""
    radius = smallest_circle(x, w)
    return 0.0 if radius == math.inf else radius * FEET_PER_METRE


class TestValidator:
    """Validates tests as the competition's validator does, including its bugs."""

    __test__ = False  # pytest must not collect this class, in spite of its name

    def __init__(self, map_size: float, min_road_length: float = 20) -> None:
        self.map_size = map_size
        self.min_road_length = min_road_length
        self.max_points = 500
        self.box = (0, 0, map_size, map_size)

    @cached_property
    def road_bbox(self) -> RoadBoundingBox:
        return RoadBoundingBox(self.box)

    def is_right_type(self, the_test: Any) -> bool:
        return type(the_test) is RoadTestFactory.RoadTest

    def is_enough_road_points(self, the_test: Any) -> bool:
        return len(the_test.road_points) > 1

    def is_too_many_points(self, the_test: Any) -> bool:
        return len(the_test.road_points) > self.max_points

    def is_inside_map(self, the_test: Any) -> bool:
        """Checks whether the road is inside the map, in the same way as the competition. Because of an
        error in the competition's logic, a road that is wholly outside can pass.
        """
        xs = [node[0] for node in the_test.interpolated_points]
        ys = [node[1] for node in the_test.interpolated_points]
        size = self.map_size
        return bool(
            min(xs) > 0
            or (min(xs) > size and max(xs) > 0)
            or (max(xs) > size and min(ys) > 0)
            or (min(ys) > size and max(ys) > 0)
            or max(ys) > size
        )

    def intersects_boundary(self, the_test: Any) -> bool:
        return bool(self.road_bbox.intersects_boundary(the_test.get_road_polygon().polygon))

    def is_valid_polygon(self, the_test: Any) -> bool:
        return bool(the_test.get_road_polygon().is_valid())

    def is_not_self_intersecting(self, the_test: Any) -> bool:
        return self.is_valid_polygon(the_test)

    def is_minimum_length(self, the_test: Any) -> bool:
        return bool(the_test.get_road_length(interpolate_road_points=True) > self.min_road_length)

    def is_too_sharp(self, the_test: Any, TSHD_RADIUS: float = 47) -> bool:
        """Returns whether the smallest radius of the road is less than ``TSHD_RADIUS`` feet."""
        return TSHD_RADIUS > min_radius(the_test.interpolated_points) > 0.0

    def validate_test(self, the_test: Any) -> Tuple[bool, str]:
        """Returns whether the test is valid, and the message of the first rule that it breaks, or ""."""
        if not self.is_right_type(the_test):
            return False, WRONG_TYPE
        if type(self) is not TestValidator or self.min_road_length != 20 or self.max_points != 500:
            message = self._complaint(the_test)
            return not message, message
        if len(the_test.road_points) < 2:
            return False, TOO_FEW
        try:
            points = [[float(x), float(y)] for x, y in the_test.road_points]
            is_valid, message = ask("verdict", points=points, map_size=self.map_size)
        except (ClientError, TypeError, ValueError) as error:
            return False, str(error)
        return is_valid, message

    def _complaint(self, the_test: Any) -> str:
        """Checks step by step, for subclasses with checks of their own; returns the first complaint."""
        if not self.is_enough_road_points(the_test):
            return TOO_FEW
        if self.is_too_many_points(the_test):
            return TOO_MANY
        if not self.is_inside_map(the_test) or self.intersects_boundary(the_test):
            return OUTSIDE
        if not self.is_valid_polygon(the_test):
            return CROSSING
        if not self.is_minimum_length(the_test):
            return TOO_SHORT
        return TOO_SHARP if self.is_too_sharp(the_test) else ""
