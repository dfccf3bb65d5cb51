"""Computes the lines painted on the roads of a network, and where signs and lights stand at its junctions.

The lines along a road are those of its profile. Inside junctions there are only edge lines along the kerbs,
and lines between the lanes of a road that a ramp joins or leaves. An arm at which traffic has to stop or to
give way has a line across the end of its road. Where traffic gives way to a roundabout, this line lies at the
outer edge of the ring instead.

A lane arrow before a junction shows the directions into which the connections of its lane lead. The shape is
that of StVO sign 297 (Germany). The Vienna Convention on Road Signs and Signals, Annex 2, asks for arrows
before junctions where the road has enough lanes; they are at least 2 m long."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.junctions import RAMPS, side_of
from roadgpt.geometry.curve import Array, wrap_angle
from roadgpt.language.names import Control, Way
from roadgpt.network.network import (
    Arm,
    Connection,
    Contact,
    Junction,
    Network,
    NetworkRoad,
    RoadEnd,
    Roundabout,
)
from roadgpt.network.paved import Area, ribbons, stations_of
from roadgpt.network.surface import triangulated
from roadgpt.road.profile import DASH, GAP, LINE, width_at

BLOCK, BLOCK_GAP = 0.5, 0.25  # m, lengths of a block and of a gap in a give-way line (Germany, RMS-1)
BEFORE = 1.0  # m, from a sign to the junction
BESIDE = 0.6  # m, from the outer edge of the shoulder to the middle of a sign
ABOVE = 0.003  # m, about the largest distance in height between the chords of a line and the road
SHORTEST = 0.3  # m; shorter pieces of lines come from rounding
CIRCLE = 64  # segments in a quarter of the circle on which a give-way line lies

CROSSWALK = (1.0, 3.0)  # m, from a junction to a crosswalk, and length of the stripes (Germany, R-FGUe)
CROSSED = sum(CROSSWALK) + 1.0  # m, from a junction with a crosswalk to a stop line, 1 m before the crosswalk
STOP_LINE = 0.5  # m, width of a stop line; without a crosswalk it lies next to the junction (Germany, RMS-1)
STRIPE = 0.5  # m, width of a stripe of a crosswalk, and of the gap between two stripes (Germany, RMS-1)

StrokeKind = Literal["edge", "lane", "stop", "give_way", "crosswalk"]


class PaintedStroke(NamedTuple):
    """One painted line without gaps; each dash of a broken line is a stroke of its own."""

    kind: StrokeKind
    width: float  # width in metres; half of the width lies on each side of the points
    points: Array  # points ``(n, 3)`` in metres along the middle of the stroke, at the height of the road
    road: int | None = None
    """The id of the road along which the stroke leads; None for a stroke across a road or along a kerb."""


class JunctionSign(NamedTuple):
    """A sign or a light at an arm of a junction."""

    control: Control
    place: tuple[float, float, float]
    """The foot of the post in metres, beside the traffic that the sign is for."""
    heading: float  # the heading in radians of the traffic that the sign is for


def strokes(network: Network) -> tuple[PaintedStroke, ...]:
    """Returns all lines and crosswalks that are painted on a network; ``arrows`` returns the lane arrows."""
    found = [stroke for member in network.roads for stroke in _of_road(network, member)]
    for (_, junctions), paved in zip(network.nodes, network.paved_nodes, strict=True):
        found += _kerb_lines(network, paved, junctions[0].node[2])
        for junction in junctions:
            found += [stroke for arm in junction.arms for stroke in _of_arm(network, junction, arm)]
    for each in network.continuations:
        found += _stripes(network.road(each.before.road), each.before.contact) if each.crosswalk else ()
    return tuple(found)


def signs(network: Network) -> tuple[JunctionSign, ...]:
    """Returns the signs and lights at the arms of all junctions."""
    found = []
    for arm in (arm for junction in network.junctions for arm in junction.arms if arm.control != "none"):
        member = network.road(arm.end.road)
        x, y, z = member.road.at(*place_of_sign(member, arm.end.contact)).tolist()
        found.append(JunctionSign(arm.control, (x, y, z), arm.direction + np.pi))
    return tuple(found)


def _of_road(network: Network, member: NetworkRoad) -> Iterator[PaintedStroke]:
    road, profile = member.road, member.profile
    metres = np.linspace(0.0, road.length, math.ceil(road.length) + 1)
    chords = np.cumsum(np.sqrt(np.abs(road.vertical_curvature(metres)) / (8 * ABOVE)))
    s = np.union1d(stations_of(road), np.interp(np.arange(1.0, chords[-1]), chords, metres))
    first, last = between_crosswalks(network, member)
    painted, boundaries = profile.markings(s), profile.boundaries(s)
    outer = {n for n, at in ((0, 0), (len(painted) - 1, -1)) if boundaries[at][0] == "solid"}
    for number, (marking, edges) in enumerate(painted):
        if number in outer:
            yield PaintedStroke("edge", LINE, road.at(s, (edges.left + edges.right) / 2), member.id)
            continue
        is_broken = marking == "broken"
        starts = np.arange(0.0, road.length, DASH + GAP).tolist() if is_broken else [0.0]
        for at in starts:
            start, end = max(at, first), min(at + DASH if is_broken else road.length, last)
            if end - start < SHORTEST:
                continue
            along = np.r_[start, s[(s > start) & (s < end)], end]
            _, edges = profile.markings(along)[number]
            yield PaintedStroke("lane", LINE, road.at(along, (edges.left + edges.right) / 2), member.id)


def between_crosswalks(network: Network, member: NetworkRoad) -> tuple[float, float]:
    """Returns the first and last station in metres of the lines between a road's lanes, and of its median.
    Lines and median reach from one end of the road to the other, but not across crosswalks."""
    ends = (RoadEnd(member.id, "start") in network.crossed, RoadEnd(member.id, "end") in network.crossed)
    first = min(CROSSED * ends[0], member.road.length)
    return first, max(member.road.length - CROSSED * ends[1], first)


def _kerb_lines(network: Network, inside: Area, height: float) -> Iterator[PaintedStroke]:
    """Yields the edge lines along the kerbs and islands of a junction; the carriageway lies on their left."""
    import shapely

    inner = network.paved.buffer(-LINE / 2, join_style="mitre")
    for polygon in map(shapely.geometry.polygon.orient, shapely.get_parts(inner)):
        for ring in (polygon.exterior, *polygon.interiors):
            for piece in _pieces(shapely.intersection(ring, inside)):
                if piece.length >= SHORTEST:
                    yield PaintedStroke("edge", LINE, _raised(_along(piece, ring), height))


def _pieces(shape: Any) -> list[Any]:
    import shapely

    lines = [part for part in shapely.get_parts(shape) if part.geom_type in ("LineString", "LinearRing")]
    if not lines:
        return []
    return list(shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines))))


def _along(piece: Any, ring: Any) -> Array:
    import shapely

    points = np.asarray(piece.coords, float)[:, :2]
    step = (points[1] - points[0]) * min(0.5, 0.01 / max(np.hypot(*(points[1] - points[0])), 1e-9))
    one, two = shapely.line_locate_point(ring, shapely.points([points[0] + step, points[0] + 1.5 * step]))
    return points if two > one else points[::-1]


def _raised(points: Array, height: float) -> Array:
    return np.column_stack([points, np.full(len(points), height)])


def _of_arm(network: Network, junction: Junction, arm: Arm) -> Iterator[PaintedStroke]:
    """Yields the stripes of a crosswalk, and the stop line of an arm or the blocks of its give-way line."""
    if arm.crosswalk:
        yield from _stripes(network.road(arm.end.road), arm.end.contact)
    line = line_to_stop_at(network, junction, arm)
    if line is not None and arm.control != "yield":
        yield PaintedStroke("stop", STOP_LINE, line)
    elif line is not None:
        for block in _blocks(line):
            yield PaintedStroke("give_way", STOP_LINE, block)


def line_to_stop_at(network: Network, junction: Junction, arm: Arm) -> Array | None:
    """Returns points ``(n, 3)`` in metres along the middle of the line, ``STOP_LINE`` wide, at which traffic
    from an arm stops or gives way. A line across an arm begins at mid-road. None if the arm has priority or
    no sign, or if it gives way to a ring to which it has no connecting road."""
    if arm.control in ("priority", "none"):
        return None
    if gives_way_to_ring(network, junction, arm):
        return _around(network, junction, arm, network.roundabout_of[junction.id])
    s, inner, edge = line_across(network, arm)
    outer = edge - LINE if edge > inner else edge + LINE
    return network.road(arm.end.road).road.at(np.full(2, s), np.array([inner, outer]))


def gives_way_to_ring(network: Network, junction: Junction, arm: Arm) -> bool:
    """Returns whether traffic from an arm gives way at the outer edge of a roundabout's ring. The line then
    lies on the road that leads into the ring, and not on that of the arm."""
    return arm.control == "yield" and arm.line is None and junction.id in network.roundabout_of


def road_of_line(network: Network, junction: Junction, arm: Arm) -> int:
    """Returns the id of the road on which the line of ``line_to_stop_at`` lies."""
    if not gives_way_to_ring(network, junction, arm):
        return arm.end.road
    return next(each.road for each in junction.connections if each.incoming == arm.end)


def line_before(arm: Arm) -> float:
    """Returns the distance in metres from a junction to the stop line of an arm: as a map says, else 0
    without a crosswalk."""
    if arm.line is not None:
        return arm.line
    return CROSSED if arm.crosswalk else 0.0


def line_across(network: Network, arm: Arm) -> tuple[float, float, float]:
    """Returns the station of the line across an arm, and the offsets of its ends at mid-road and at the edge
    of the lanes, all in metres."""
    member, at_end = network.road(arm.end.road), arm.end.contact == "end"
    half = min(line_before(arm) + STOP_LINE / 2, member.road.length)
    s = member.road.length - half if at_end else half
    edges = member.profile.edges(s)
    is_left = member.side_towards(arm.end.contact) > 0
    return s, member.begin_towards(arm.end.contact, s), float(edges.left if is_left else edges.right)


def _stripes(member: NetworkRoad, contact: Contact) -> Iterator[PaintedStroke]:
    """Yields the stripes of a crosswalk at an end of a road."""
    near, length = CROSSWALK
    away = np.minimum(np.array([near, near + length]), member.road.length)
    s = member.road.length - away if contact == "end" else away
    edges = member.profile.edges(float(s[0]))
    left, right = float(edges.left), float(edges.right)
    count = max(1, round((left - right) / (2 * STRIPE)))
    for n in range(count):
        t = right + (left - right) * (n + 0.5) / count
        yield PaintedStroke("crosswalk", STRIPE, member.road.at(s, np.full(2, t)))


def _around(network: Network, junction: Junction, arm: Arm, ring: Roundabout) -> Array | None:
    """Returns the middle ``(n, 3)`` of the line where traffic from an arm enters a roundabout, beside the
    ring; None if no road leads there."""
    import shapely

    onto = [each for each in junction.connections if each.incoming == arm.end]
    off = [each for each in junction.connections if each.outgoing == arm.end]
    if not onto:
        return None
    x, y, z = ring.centre
    circle = shapely.Point(x, y).buffer(ring.radius + ring.width + STOP_LINE / 2, quad_segs=CIRCLE).exterior
    # traffic keeps to its side of the arm: only the part there is crossed by entering traffic
    lane, *others = ribbons([network.road(each.road).road for each in (onto[0], *off)])
    for other in others:
        lane = shapely.difference(lane, other)
    pieces = _pieces(shapely.intersection(circle, lane.buffer(-STOP_LINE / 2)))
    if not pieces:
        return None
    return _raised(np.asarray(max(pieces, key=lambda piece: piece.length).coords, float)[:, :2], z)


def _blocks(line: Array) -> Iterator[Array]:
    along = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
    count = max(1, round((along[-1] + BLOCK_GAP) / (BLOCK + BLOCK_GAP)))
    size = (along[-1] + BLOCK_GAP) / count
    for n in range(count):
        start, end = n * size, n * size + size - BLOCK_GAP
        stops = np.r_[start, along[(along > start) & (along < end)], end]
        yield np.column_stack([np.interp(stops, along, line[:, k]) for k in range(3)])


def place_of_sign(member: NetworkRoad, contact: Contact) -> tuple[float, float]:
    """Returns the station and the offset in metres of the sign at one end of a road: beside the traffic that
    drives towards this end, outside the shoulder."""
    before = min(BEFORE, member.road.length)
    s = member.road.length - before if contact == "end" else before
    lanes = member.profile.along if contact == "end" else member.profile.against
    aside = sum(width_at(lane.width, s) for lane in lanes) + BESIDE
    return s, member.begin_towards(contact, s) + member.side_towards(contact) * aside


LENGTH = 5.0  # m (Germany, RMS-1, for limits up to 50 km/h)
AHEAD = 10.0  # m, from the tip of an arrow to the stop line: two waiting cars do not cover the whole arrow
FREE = CROSSED + STOP_LINE  # m, behind an arrow: room for a crosswalk and stop line at the road's other end
BESIDE_ARROW = 0.25  # m, least distance from an arrow to the edges of its lane
CHORD = 0.5  # m, longest side of the outline, so that the outline follows a bend

# The outline is drawn as on an upright sign and then stretched along the road by the factor STRETCH, because
# drivers see the road surface at a small angle. The lengths below are in metres before stretching.
STRETCH = 2.5
SHAFT = 0.15  # width
HEAD = 0.8, 0.72  # length and width of the head of the shaft
SIDE_HEAD = 0.52, 0.72  # length and width of a head to the side
BEND = 0.33  # radius of the bend before a head to the side, and distance from the shaft to that head
SIDE_TOP = 1.64  # from the foot of an arrow to the middle of a head to the side
SIDE_LOW = 0.8  # like SIDE_TOP, for an arrow that also has a head straight on
ROUGH = 0.005  # largest deviation where a bend is simplified
ORDER: tuple[Way, ...] = ("left", "straight", "right")


@dataclass(frozen=True, eq=False)
class PaintedArrow:
    """One arrow on a lane that leads towards a junction."""

    end: RoadEnd  # the end of the road towards which the lane leads
    lane: int  # the id of the lane
    ways: tuple[Way, ...]  # the directions that the arrow shows, from left to right
    s: float  # the station in metres of the arrow's middle
    t: float  # the offset in metres of the arrow's middle, positive to the left of the reference line
    width: float  # the width of the arrow in metres
    points: Array  # the outline ``(n, 3)`` in metres, counter-clockwise, at the height of the road
    corners: NDArray[np.int64]
    """Triangles that fill the outline: indices ``(m, 3)`` into ``points``, counter-clockwise."""


def arrows(network: Network) -> tuple[PaintedArrow, ...]:
    """Returns the arrows on all roads, ordered by junction, then by arm, then by lane from mid-road outwards.

    An arm has no arrows in any of these cases:

    - It leads to a roundabout, where every lane leads round the ring.
    - It is a two-way road with a single lane towards the junction.
    - It belongs to a merge or exit and leads to one road only.
    - It is too short.

    Besides, a lane has no arrow if it is too narrow or leads nowhere."""
    return tuple(
        arrow
        for junction in network.junctions
        if junction.id not in network.roundabout_of
        for arm in junction.arms
        for arrow in _arrows_of_arm(network, junction, arm)
    )


def _arrows_of_arm(network: Network, junction: Junction, arm: Arm) -> Iterator[PaintedArrow]:
    member = network.road(arm.end.road)
    lanes = member.ids_towards(arm.end.contact)
    ways_on = [each for each in junction.connections if each.incoming == arm.end]
    is_one_way = 0 in member.profile.count
    if (len(lanes) < 2 and not is_one_way) or (junction.kind in RAMPS and len(ways_on) < 2):
        return
    tip = line_before(arm) + STOP_LINE + AHEAD
    if tip + LENGTH + FREE > member.road.length:
        return
    for index, lane in enumerate(lanes):
        found = {
            _way(junction, arm, each) for each in ways_on if any(link.incoming == lane for link in each.lanes)
        }
        ways = tuple(way for way in ORDER if way in found)
        if ways and (arrow := _placed(member, arm.end, index, ways, tip)) is not None:
            yield arrow


def _way(junction: Junction, arm: Arm, connection: Connection) -> Way:
    """Returns the side to which a connection leads from an arm; at ramps, a turn of 1 degree is one to a
    side."""
    out = next(each for each in junction.arms if each.end == connection.outgoing)
    turn = float(np.degrees(wrap_angle(out.direction - arm.direction - np.pi)))
    if junction.kind in RAMPS and abs(turn) > 1.0:
        return "left" if turn > 0 else "right"
    return side_of(turn)


def _placed(
    member: NetworkRoad, end: RoadEnd, index: int, ways: tuple[Way, ...], tip: float
) -> PaintedArrow | None:
    """Returns an arrow on the lane with this index, counted from 0 at mid-road; None if the lane is too
    narrow. ``tip`` is the distance in metres from the tip of the arrow to the end of the road."""
    outline, corners = _shape(ways)
    at_end = end.contact == "end"
    away = tip + LENGTH - outline[:, 0]
    s = member.road.length - away if at_end else away
    middle, room = _lane(member, end, index, s)
    width = float(np.ptp(outline[:, 1]))
    if float(room.min()) < width + 2 * BESIDE_ARROW:
        return None
    points = member.road.at(s, middle + (outline[:, 1] if at_end else -outline[:, 1]))
    centre = tip + LENGTH / 2
    at = member.road.length - centre if at_end else centre
    t = float(_lane(member, end, index, np.array([at]))[0][0])
    lane = member.ids_towards(end.contact)[index]
    return PaintedArrow(end, lane, ways, at, t, width, points, corners)


def _lane(member: NetworkRoad, end: RoadEnd, index: int, s: Array) -> tuple[Array, Array]:
    left, right = member.profile.edges_of(member.ids_towards(end.contact)[index], s)
    return (left + right) / 2, np.abs(left - right)


@lru_cache(maxsize=8)
def _shape(ways: tuple[Way, ...]) -> tuple[Array, NDArray[np.int64]]:
    """Returns the outline ``(n, 2)`` of an arrow in metres, and the triangles that fill it. The outline is
    given by the distance from the foot of the arrow and the offset to the left of its middle."""
    import shapely
    from shapely.affinity import scale, translate

    whole = shapely.union_all([_part(way, "straight" in ways) for way in ways])
    low, high = whole.bounds[1], whole.bounds[3]
    drawn_out = scale(translate(whole, 0.0, -(low + high) / 2), STRETCH, 1.0, origin=(0.0, 0.0))
    outline = shapely.geometry.polygon.orient(shapely.segmentize(drawn_out, CHORD))
    points = np.asarray(outline.exterior.coords, float)[:-1]
    found, corners = triangulated(outline)
    place = {tuple(point): n for n, point in enumerate(points.tolist())}
    return points, np.array([place[tuple(point)] for point in found.tolist()], np.int64)[corners]


def _part(way: Way, is_beside: bool) -> Any:
    """Returns the shaft and the head of one way before it is drawn out; ``is_beside`` a head straight on."""
    import shapely

    top = LENGTH / STRETCH
    if way == "straight":
        long, wide = HEAD
        shaft = shapely.box(0.0, -SHAFT / 2, top - long + 0.01, SHAFT / 2)
        head = [(top - long, -wide / 2), (top, 0.0), (top - long, wide / 2)]
        return shapely.union(shaft, shapely.Polygon(head))
    long, wide = SIDE_HEAD
    at = SIDE_LOW if is_beside else SIDE_TOP
    angle = np.linspace(0.0, np.pi / 2, 5)
    bend = np.column_stack([at - BEND + BEND * np.sin(angle), BEND - BEND * np.cos(angle)])
    shaft = shapely.LineString([(0.0, 0.0), *bend, (at, BEND + 0.01)]).buffer(SHAFT / 2, cap_style="flat")
    head = [(at - wide / 2, BEND), (at + wide / 2, BEND), (at, BEND + long)]
    # thin triangles would turn over where their corners are rounded to millimetres
    whole = shapely.union(shapely.simplify(shaft, ROUGH), shapely.Polygon(head))
    return whole if way == "left" else shapely.transform(whole, lambda points: points * [1.0, -1.0])
