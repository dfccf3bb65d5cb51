"""Writes the boundary of a junction: across the lanes of each arm, and along the kerbs between two arms.

Source: ASAM OpenDRIVE 1.8.1, junction boundary. The segments are in counter-clockwise order and close the
boundary. A segment of type "joint" leads across an arm, from the outer edge of one lane to the outer edge of
another lane. A segment of type "lane" leads along the outer edge of a lane. Lane 0 has no width, so its edge
is the line between the two directions of an arm, or the left edge of a connecting road.

With traffic on the left, the boundary is computed for the mirrored network, whose traffic is on the right. It
is then mirrored back: the segments are followed in reverse order, with left and right exchanged.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from roadgpt.brief.junctions import RAMPS
from roadgpt.export.exporters.opendrive.kerbs import outermost
from roadgpt.export.exporters.opendrive.paved_outline import PavedOutline
from roadgpt.export.markup import Value, XmlElement
from roadgpt.geometry.curve import Array
from roadgpt.network import Connection, Junction, Network, RoadEnd
from roadgpt.network.building import width_at

ROUNDABOUT_WAYS = 3  # number of ways through a roundabout's junction with a two-way road


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
    last: tuple[int, Value]
    """Where the segment ends, in the same form as ``first``."""
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
    ways = {(each.incoming, each.outgoing): each for each in junction.connections}
    if _needs_outline(junction):
        yield from _by_outline(network, junction)
        return
    for n, end in enumerate(arms):
        yield _across(junction, end)
        after = arms[(n + 1) % len(arms)]
        if (right := ways.get((end, after))) is not None:
            # traffic on the right that turns right into the next arm keeps to the kerb
            for road, first, last in outermost(network, junction, right):
                lanes = len(network.road(road).profile.right)
                yield _along(road, -lanes, first or "start", last or "end")
        elif (left := ways.get((after, end))) is not None:
            # along the central island of a roundabout, where there is no traffic on the other side
            yield _along(left.road, 0, "end", "start")
        else:
            yield from _between(network, ways, end, after)


def _needs_outline(junction: Junction) -> bool:
    """Returns whether any way may be the outermost one, because several lanes or one-way roads meet."""
    if junction.kind in RAMPS:
        return False
    count = len(junction.arms)
    usual = ROUNDABOUT_WAYS if junction.kind == "roundabout" else count * (count - 1)
    return len(junction.connections) < usual or any(len(each.lanes) > 1 for each in junction.connections)


def _by_outline(network: Network, junction: Junction) -> Iterator[BoundarySegment]:
    """Yields the segments of a boundary that follows the outline of the paved area."""
    outline, ends = PavedOutline.of(network, junction), [arm.end for arm in junction.arms]
    for n, end in enumerate(ends):
        after = ends[(n + 1) % len(ends)]
        yield _across(junction, end)
        start, goal = _corner(network, junction, end, 1), _corner(network, junction, after, 0)
        for edge, first, last in outline.between(start, goal):
            yield _along(edge.road, edge.lane, first, last)


def _corner(network: Network, junction: Junction, end: RoadEnd, which: int) -> Array:
    """Returns the first (0) or the last (1) point of the segment across an arm."""
    member = network.road(end.road)
    lane = _lanes_across(junction, end)[which]
    s = 0.0 if end.contact == "start" else member.road.length
    side, first = (
        (member.profile.left, member.profile.sides(s).left)
        if lane > 0
        else (member.profile.right, member.profile.sides(s).right)
    )
    oncoming = member.profile.against_ids
    count = oncoming.index(lane) + 1 if lane in oncoming else -min(lane, 0)
    width = sum(width_at(each.width, s) for each in side[:count])
    t = float(first) + (width if lane > 0 else -width)
    return member.road.at(s, t)[:2]


def _between(
    network: Network, ways: Mapping[tuple[RoadEnd, RoadEnd], Connection], end: RoadEnd, after: RoadEnd
) -> Iterator[BoundarySegment]:
    """Yields the segments between two neighbouring arms that no way joins, as at a merge or an exit.

    Two ways join both arms to a third arm, or lead from a third arm to both. The segments follow one
    way from the first arm to the third arm, and the other way on to the second arm.
    """
    for third in dict.fromkeys(each for way in ways for each in way):
        if (end, third) in ways and (after, third) in ways:
            yield _right(network, ways[end, third])
            yield _along(ways[after, third].road, 0, "end", "start")
            return
        if (third, end) in ways and (third, after) in ways:
            yield _along(ways[third, end].road, 0, "end", "start")
            yield _right(network, ways[third, after])
            return


def _right(network: Network, way: Connection) -> BoundarySegment:
    return _along(way.road, -len(network.road(way.road).profile.right), "start", "end")


def _across(junction: Junction, end: RoadEnd) -> BoundarySegment:
    """Returns the segment across those lanes of an arm that continue in the junction.

    Seen from inside the junction, it leads from right to left: from the lanes that lead out of the junction
    to those that lead into it. Shoulders end at the junction.
    """
    first, last = _lanes_across(junction, end)
    return BoundarySegment(end.road, (first, end.contact), (last, end.contact), is_across=True)


def _lanes_across(junction: Junction, end: RoadEnd) -> tuple[int, int]:
    """Returns the lanes at whose outer edges the segment across an arm begins and ends."""
    lanes = [link.incoming for each in junction.connections if each.incoming == end for link in each.lanes]
    lanes += [link.outgoing for each in junction.connections if each.outgoing == end for link in each.lanes]
    right, left = min(lanes), max(lanes)
    right, left = right if right < 0 else right - 1, left if left > 0 else left + 1
    return (right, left) if end.contact == "start" else (left, right)


def _along(road: int, lane: int, start: Value, end: Value) -> BoundarySegment:
    """Returns the segment along the outer edge of a lane of a connecting road, between two stations."""
    return BoundarySegment(road, (lane, start), (lane, end), is_across=False)
