"""Follows the outline of the paved area of a junction from one arm to the next, along the edges of its ways.

The outline is used where roads with several lanes or one-way roads meet, because any way may be the outermost
one there.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.export.markup import Value
from roadgpt.geometry.curve import Array
from roadgpt.network import Junction, Network
from roadgpt.network.paved import outline_of, paved_by, stations_of

if TYPE_CHECKING:
    from shapely import LinearRing

NEAR = 0.005  # m, between the outline and the edge that it follows: both are polylines
ROUNDING = 0.01  # m; a station this close to an end of its road is written as "start" or "end"
SHORT = 0.02  # m; shorter pieces of the outline come from rounding and are left out


@dataclass(frozen=True)
class Edge:
    """One edge of a way through a junction."""

    road: int
    """The id of the connecting road."""
    lane: int
    """The id of the lane whose outer edge this is; 0 for the left edge of the road."""
    s: Array
    """Increasing stations ``(n,)`` in metres."""
    points: Array
    """Points ``(n, 2)`` in metres at these stations."""

    def station(self, point: Array) -> float:
        """Returns the station in metres at which the edge is nearest to a point ``(2,)``."""
        import shapely

        line = shapely.LineString(self.points)
        along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(self.points, axis=0).T))]
        return float(np.interp(shapely.line_locate_point(line, shapely.Point(point)), along, self.s))

    def named(self, s: float) -> Value:
        """Returns "start" or "end" for a station near an end of the road, and any other station unchanged."""
        if s < ROUNDING:
            return "start"
        return "end" if s > float(self.s[-1]) - ROUNDING else s


@dataclass(frozen=True)
class PavedOutline:
    """The outline of the paved area of a junction, counter-clockwise."""

    ring: "LinearRing"
    edges: tuple[Edge, ...]

    @classmethod
    def of(cls, network: Network, junction: Junction) -> "PavedOutline":
        """Returns the outline of a junction of a network with traffic on the right."""
        import shapely

        roads = [network.road(each.road) for each in junction.connections]
        edges = []
        for member in roads:
            s = stations_of(member.road)
            left, right = member.profile.edges(s)
            for lane, t in ((0, left), (-member.profile.count[0], right)):
                edges.append(Edge(member.id, lane, s, member.road.at(s, t)[:, :2]))
        paved = paved_by([member.road for member in roads])
        return cls(shapely.LinearRing(outline_of(paved)), tuple(edges))

    def between(self, start: Array, end: Array) -> Iterator[tuple[Edge, Value, Value]]:
        """Yields the edges that the outline follows from one of its points ``(2,)`` to another.

        With each edge come the stations at which the outline joins and leaves this edge, as ``Edge.named``
        returns them. A left edge is followed from higher to lower stations.
        """
        import shapely

        points = self._points(start, end)
        middles = shapely.points((points[1:] + points[:-1]) / 2)
        lines = [shapely.LineString(edge.points) for edge in self.edges]
        away = np.array([shapely.distance(line, middles) for line in lines])
        first, current = 0, -1
        for n in range(len(middles)):
            if current >= 0 and away[current, n] < NEAR:
                continue
            if current >= 0:
                yield from self._part(current, points[first], points[n])
            nearest = int(np.argmin(away[:, n]))
            first, current = n, nearest if away[nearest, n] < NEAR else -1
        if current >= 0:
            yield from self._part(current, points[first], points[-1])

    def _part(self, number: int, start: Array, end: Array) -> Iterator[tuple[Edge, Value, Value]]:
        edge = self.edges[number]
        first, last = edge.station(start), edge.station(end)
        if abs(last - first) > SHORT:
            yield edge, edge.named(first), edge.named(last)

    def _points(self, start: Array, end: Array) -> Array:
        """Returns the points ``(n, 2)`` of the outline from one of its points to another."""
        import shapely

        ring = np.asarray(self.ring.coords, float)
        along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(ring, axis=0).T))][:-1]
        first, last = (float(shapely.line_locate_point(self.ring, shapely.Point(p))) for p in (start, end))
        length = self.ring.length
        room = (last - first) % length
        places = (along - first) % length
        inside = np.flatnonzero((places > SHORT) & (places < room - SHORT))
        return np.vstack((start, ring[:-1][inside[np.argsort(places[inside])]], end))
