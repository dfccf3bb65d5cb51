"""The bounding box of a map; it uses shapely of the generator's interpreter."""

from __future__ import annotations

from functools import cached_property
from typing import Any, List, Sequence

from roadgpt_inside import checkout


class RoadBoundingBox:
    """A rectangle that roads must stay in."""

    def __init__(self, bbox_size: Sequence[float]) -> None:
        """Takes (x, y, x, y) of two corners.

        Raises:
            AssertionError: these are not four numbers.
        """
        assert len(bbox_size) == 4
        self._size = tuple(bbox_size)

    @cached_property
    def bbox(self) -> Any:
        """The rectangle."""
        from shapely.geometry import box

        return box(*self._size)

    def get_sides(self) -> List[Any]:
        """Returns four lines."""
        from shapely.geometry import LineString

        corners = list(self.bbox.exterior.coords)
        return [LineString(pair) for pair in zip(corners, corners[1:])]

    def get_vertices(self) -> List[Any]:
        """Returns the corners, the first one twice."""
        from shapely.geometry import Point

        return [Point(corner) for corner in self.bbox.exterior.coords]

    def intersects_sides(self, point: Any) -> bool:
        """Returns whether a point lies on the border."""
        return any(side.intersects(point) for side in self.get_sides())

    def intersects_vertices(self, point: Any) -> bool:
        """Returns whether a point lies in a corner."""
        return any(corner.intersects(point) for corner in self.get_vertices())

    def intersects_boundary(self, other: Any) -> bool:
        """Returns whether an area touches the border."""
        return bool(other.intersects(self.bbox.boundary))

    def contains(self, other: Any) -> bool:
        """Returns whether the middle of a road lies inside."""
        return bool(self.bbox.contains(other.polyline))


def __getattr__(name: str) -> Any:
    return checkout.attribute(__name__, name)
