"""Defines the bounding box of a map; it needs shapely in the generator's interpreter."""

from __future__ import annotations

from functools import cached_property
from typing import Any, List, Sequence


class RoadBoundingBox:
    """A rectangle that roads must not leave."""

    def __init__(self, bbox_size: Sequence[float]) -> None:
        """Takes (x, y, x, y) of two corners."""
        assert len(bbox_size) == 4
        self._size = tuple(bbox_size)

    @cached_property
    def bbox(self) -> Any:
        from shapely.geometry import box

        return box(*self._size)

    def get_sides(self) -> List[Any]:
        from shapely.geometry import LineString

        corners = list(self.bbox.exterior.coords)
        return [LineString(pair) for pair in zip(corners, corners[1:])]

    def get_vertices(self) -> List[Any]:
        from shapely.geometry import Point

        return [Point(corner) for corner in self.bbox.exterior.coords]

    def intersects_sides(self, point: Any) -> bool:
        return any(side.intersects(point) for side in self.get_sides())

    def intersects_vertices(self, point: Any) -> bool:
        return any(corner.intersects(point) for corner in self.get_vertices())

    def intersects_boundary(self, other: Any) -> bool:
        return bool(other.intersects(self.bbox.boundary))

    def contains(self, other: Any) -> bool:
        return bool(self.bbox.contains(other.polyline))
