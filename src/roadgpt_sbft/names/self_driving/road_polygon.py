"""Defines the area of a road. The Python interpreter that runs the test generator must have shapely."""

from __future__ import annotations

from functools import cached_property
from typing import Any, List, Sequence

from roadgpt_inside import ask
from self_driving.road_points import RoadPoints


class RoadPolygon:
    """The area between the edges of a road. Each polygon is computed when it is first used."""

    def __init__(self, road_points: RoadPoints) -> None:
        assert len(road_points.left) == len(road_points.right) == len(road_points.middle) >= 2
        assert len({node[3] for node in road_points.middle}) == 1, "a road is as wide everywhere"
        self.road_points = road_points
        self.road_width = road_points.middle[0][3]

    @classmethod
    def from_nodes(cls, nodes: Sequence[Sequence[float]]) -> RoadPolygon:
        return cls(RoadPoints.from_nodes(nodes))

    @property
    def num_polygons(self) -> int:
        return len(self.road_points.middle) - 1

    @cached_property
    def polygons(self) -> List[Any]:
        from shapely.geometry import Polygon

        left, right = self.road_points.left, self.road_points.right
        return [Polygon(quad) for quad in zip(left, left[1:], right[1:], right)]

    @cached_property
    def polygon(self) -> Any:
        return _area(self.road_points.left, self.road_points.right)

    @cached_property
    def right_polygon(self) -> Any:
        return _area(self._middle, self.road_points.right)

    @cached_property
    def left_polygon(self) -> Any:
        return _area(self.road_points.left, self._middle)

    @cached_property
    def polyline(self) -> Any:
        return _line(self._middle)

    @cached_property
    def right_polyline(self) -> Any:
        return _line(_between(self._middle, self.road_points.right))

    @cached_property
    def left_polyline(self) -> Any:
        return _line(_between(self.road_points.left, self._middle))

    @property
    def _middle(self) -> List[Any]:
        return [(node[0], node[1]) for node in self.road_points.middle]

    def is_valid(self) -> bool:
        """Returns False if the road intersects itself, else True; nothing else is checked."""
        return bool(ask("clear", left=self.road_points.left, right=self.road_points.right))


def _between(one: List[Any], other: List[Any]) -> List[Any]:
    return [((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) for a, b in zip(one, other)]


def _line(points: List[Any]) -> Any:
    from shapely.geometry import LineString

    return LineString(points)


def _area(left: List[Any], right: List[Any]) -> Any:
    from shapely.geometry import Polygon

    return Polygon([*left, *right[::-1]])
