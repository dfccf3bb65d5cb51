"""The area of a road and the box of a map, as generators of the competition ask for them."""

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from roadgpt.check.ribbon import quads_of
from roadgpt.check.sbft import edges, keeps_clear
from roadgpt.geometry.curve import Array

if TYPE_CHECKING:
    from shapely.geometry import LineString, Polygon


class RoadPolygon:
    """The area of a road, between edge points that lie across the way to the next node."""

    def __init__(self, nodes: Array, width: float) -> None:
        """Nodes ``(n, 2)`` in metres."""
        self.nodes = nodes
        self.left, self.right = edges(nodes, width)

    @classmethod
    def from_nodes(cls, nodes: Sequence[Sequence[float]]) -> "RoadPolygon":
        """Of nodes [x, y, height, width], two or more."""
        table = np.asarray(nodes, float)
        return cls(table[:, :2], float(table[0, 3]) if table.shape[1] > 3 else 8.0)

    @cached_property
    def polygon(self) -> "Polygon":
        """The whole road."""
        return _area(self.left, self.right)

    @cached_property
    def polygons(self) -> "list[Polygon]":
        """The road between each two nodes."""
        from shapely.geometry import Polygon

        return [Polygon(quad) for quad in quads_of(self.left, self.right)]

    @cached_property
    def right_polygon(self) -> "Polygon":
        """The right lane."""
        return _area(self.nodes, self.right)

    @cached_property
    def left_polygon(self) -> "Polygon":
        """The left lane."""
        return _area(self.left, self.nodes)

    @cached_property
    def polyline(self) -> "LineString":
        """The nodes."""
        from shapely.geometry import LineString

        return LineString(self.nodes)

    def is_valid(self) -> bool:
        """Does the road keep clear of itself?"""
        return len(self.nodes) > 1 and keeps_clear(quads_of(self.left, self.right))


class RoadBoundingBox:
    """A rectangle that roads are to stay in."""

    def __init__(self, bbox_size: Sequence[float]) -> None:
        """From (x, y, x, y) of two corners."""
        from shapely.geometry import box

        self.bbox = box(*bbox_size)

    def intersects_sides(self, road: Any) -> bool:
        """Does a road touch the border?"""
        return bool(self.bbox.boundary.intersects(getattr(road, "polygon", road)))

    def intersects_vertices(self, road: Any) -> bool:
        """Does a road cover a corner?"""
        from shapely.geometry import MultiPoint

        corners = MultiPoint(list(self.bbox.exterior.coords)[:4])
        return bool(corners.intersects(getattr(road, "polygon", road)))

    def intersects_boundary(self, road: Any) -> bool:
        """Does a road touch the border or cover a corner?"""
        return self.intersects_sides(road) or self.intersects_vertices(road)

    def contains(self, road: Any) -> bool:
        """Does a road lie inside?"""
        return bool(self.bbox.contains(getattr(road, "polygon", road)))


def _area(left: Array, right: Array) -> "Polygon":
    from shapely.geometry import Polygon

    return Polygon(np.concatenate((left, right[::-1])))
