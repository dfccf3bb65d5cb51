"""Writes the boundary of a junction: across the lanes of each arm, and along the kerbs between two arms.

Source: ASAM OpenDRIVE 1.8.1, junction boundary. The segments are in counter-clockwise order and close the
boundary. A segment of type "joint" leads across an arm, from the outer edge of one lane to the outer edge of
another lane. A segment of type "lane" leads along the outer edge of a lane. Lane 0 has no width, so its edge
is the line between the two directions of an arm, or the left edge of a connecting road.

With traffic on the left, the boundary is computed for the mirrored network, whose traffic is on the right. It
is then mirrored back: the segments are followed in reverse order, with left and right exchanged."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from roadgpt.brief.junctions import RAMPS
from roadgpt.export.markup import Value, XmlElement
from roadgpt.geometry.curve import Array
from roadgpt.network import Junction, Network, RoadEnd
from roadgpt.network.paved import outline_of, paved_by, stations_of

if TYPE_CHECKING:
    from shapely import LinearRing

CHORD = 0.0005  # m, largest distance between an edge and the chords along which the outline follows it
NEAR = 0.0005  # m, between the outline and the edge that it follows, whose corners are rounded
ROUNDING = 0.01  # m; a station this close to an end of its road is written as "start" or "end"
SHORT = 0.002  # m; shorter pieces of the outline come from rounding and are left out


def boundary(network: Network, junction: Junction) -> XmlElement:
    """Returns the element ``boundary`` of a junction."""
    found = list(_segments(network.right_hand, network.right_hand.junction(junction.id)))
    if network.left_hand:
        found = [segment.mirrored() for segment in reversed(found)]
    return XmlElement("boundary").extended(*(segment.element() for segment in found))


class BoundarySegment(NamedTuple):
    """A segment across the lanes of an arm, or along the outer edge of a lane of a connecting road."""

    road: int
    first: tuple[int, Value]
    """The id of the lane at whose outer edge the segment begins, and the position along the road: "start",
    "end" or a station in metres."""
    last: tuple[int, Value]  # where the segment ends, in the same form as ``first``
    is_across: bool

    def mirrored(self) -> "BoundarySegment":
        """Returns the mirror image of the segment, followed in the opposite direction."""
        (lane, start), (other, end) = self.first, self.last
        return self._replace(first=(-other, end), last=(-lane, start))

    def element(self) -> XmlElement:
        """Returns the element ``segment``."""
        (lane, start), (other, end) = self.first, self.last
        own: dict[str, Value] = {"boundaryLane": lane, "sStart": start, "sEnd": end}
        if self.is_across:
            own = {"contactPoint": start, "jointLaneStart": lane, "jointLaneEnd": other}
        kind = "joint" if self.is_across else "lane"
        return XmlElement("segment", {"type": kind, "roadId": str(self.road), **own})


def _segments(network: Network, junction: Junction) -> Iterator[BoundarySegment]:
    """Yields the segments of a boundary in a network with traffic on the right."""
    arms = [arm.end for arm in junction.arms]
    outline = PavedOutline.of(network, junction) if junction.kind not in RAMPS else None
    for end, after in pairwise([*arms, arms[0]]):
        yield _across(junction, end)
        if outline is None:
            yield from _between(network, junction, end, after)
            continue
        corners = _corner(network, junction, end, 1), _corner(network, junction, after, 0)
        for edge, first, last in outline.between(*corners):
            yield _along(edge.road, edge.lane, first, last)


def _corner(network: Network, junction: Junction, end: RoadEnd, which: int) -> Array:
    member = network.road(end.road)
    lane = _lanes_across(junction, end)[which]
    s = 0.0 if end.contact == "start" else member.road.length
    edges = member.profile.edges_of(lane, s)
    return member.road.at(s, edges.left if lane > 0 else edges.right)[:2]


def _between(network: Network, junction: Junction, end: RoadEnd, after: RoadEnd) -> Iterator[BoundarySegment]:
    """Yields the segments between two neighbouring arms of a merge or an exit, whose ways may lie apart.

    If no way joins the arms, two ways join both to a third arm, or lead from a third arm to both. The
    segments follow one way from the first arm to the third arm, and the other way on to the second arm."""
    ways = {(each.incoming, each.outgoing): each.road for each in junction.connections}

    def right(road: int) -> BoundarySegment:
        return _along(road, -len(network.road(road).profile.right), "start", "end")

    def left(road: int) -> BoundarySegment:
        return _along(road, 0, "end", "start")

    if (end, after) in ways:
        yield right(ways[end, after])
    elif (after, end) in ways:
        yield left(ways[after, end])
    else:
        for third in dict.fromkeys(each for way in ways for each in way):
            if (end, third) in ways and (after, third) in ways:
                yield from (right(ways[end, third]), left(ways[after, third]))
                return
            if (third, end) in ways and (third, after) in ways:
                yield from (left(ways[third, end]), right(ways[third, after]))
                return


def _across(junction: Junction, end: RoadEnd) -> BoundarySegment:
    """Returns the segment across those lanes of an arm that continue in the junction, without shoulders.

    Seen from inside the junction, it leads from right to left: from the lanes out of the junction to those
    into it."""
    first, last = _lanes_across(junction, end)
    return BoundarySegment(end.road, (first, end.contact), (last, end.contact), is_across=True)


def _lanes_across(junction: Junction, end: RoadEnd) -> tuple[int, int]:
    lanes = [link.incoming for each in junction.connections if each.incoming == end for link in each.lanes]
    lanes += [link.outgoing for each in junction.connections if each.outgoing == end for link in each.lanes]
    right, left = min(lanes), max(lanes)
    right, left = right if right < 0 else right - 1, left if left > 0 else left + 1
    return (right, left) if end.contact == "start" else (left, right)


def _along(road: int, lane: int, start: Value, end: Value) -> BoundarySegment:
    return BoundarySegment(road, (lane, start), (lane, end), is_across=False)


@dataclass(frozen=True)
class Edge:
    """One edge of a way through a junction."""

    road: int  # the id of the connecting road
    lane: int  # the id of the lane whose outer edge this is; 0 for the left edge of the road
    s: Array  # increasing stations ``(n,)`` in metres
    points: Array  # points ``(n, 2)`` in metres at these stations

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
            s = stations_of(member.road, CHORD)
            left, right = member.profile.edges(s)
            for lane, t in ((0, left), (-member.profile.count[0], right)):
                edges.append(Edge(member.id, lane, s, member.road.at(s, t)[:, :2]))
        paved = paved_by([member.road for member in roads], CHORD)
        return cls(shapely.LinearRing(outline_of(paved)), tuple(edges))

    def between(self, start: Array, end: Array) -> Iterator[tuple[Edge, Value, Value]]:
        """Yields the edges that the outline follows from one of its points ``(2,)`` to another.

        With each edge come the stations at which the outline joins and leaves this edge, as ``Edge.named``
        returns them. A left edge is followed from higher to lower stations."""
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
        import shapely

        ring = np.asarray(self.ring.coords, float)
        along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(ring, axis=0).T))][:-1]
        first, last = (float(shapely.line_locate_point(self.ring, shapely.Point(p))) for p in (start, end))
        room, places = (last - first) % self.ring.length, (along - first) % self.ring.length
        inside = np.flatnonzero((places > SHORT) & (places < room - SHORT))
        return np.vstack((start, ring[:-1][inside[np.argsort(places[inside])]], end))
