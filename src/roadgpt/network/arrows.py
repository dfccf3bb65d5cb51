"""Computes the lane arrows that are painted on roads before junctions.

An arrow shows the directions into which the connections of its lane lead. The shape is that of StVO sign 297
(Germany). The Vienna Convention on Road Signs and Signals, Annex 2, asks for arrows before junctions where
the road has enough lanes; they are at least 2 m long."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.junctions import RAMPS, Way, side_of
from roadgpt.geometry.curve import Array, wrap_angle
from roadgpt.network.markings import CROSSED, STOP_LINE, line_before
from roadgpt.network.network import Arm, Connection, Junction, Network, NetworkRoad, RoadEnd
from roadgpt.network.surface import triangulated

LENGTH = 5.0  # m (Germany, RMS-1, for limits up to 50 km/h)
AHEAD = 10.0  # m, from the tip of an arrow to the stop line: two waiting cars do not cover the whole arrow
FREE = CROSSED + STOP_LINE  # m, behind an arrow: room for a crosswalk and stop line at the road's other end
BESIDE = 0.25  # m, least distance from an arrow to the edges of its lane
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
        for arrow in _of_arm(network, junction, arm)
    )


def _of_arm(network: Network, junction: Junction, arm: Arm) -> Iterator[PaintedArrow]:
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
    if float(room.min()) < width + 2 * BESIDE:
        return None
    points = member.road.at(s, middle + (outline[:, 1] if at_end else -outline[:, 1]))
    centre = tip + LENGTH / 2
    at = member.road.length - centre if at_end else centre
    t = float(_lane(member, end, index, np.array([at]))[0][0])
    lane = member.ids_towards(end.contact)[index]
    return PaintedArrow(end, lane, ways, at, t, width, points, corners)


def _lane(member: NetworkRoad, end: RoadEnd, index: int, s: Array) -> tuple[Array, Array]:
    """Returns the offset of the middle of a lane and its width, both ``(n,)`` in metres, at stations."""
    is_left = member.side_towards(end.contact) > 0
    begin, edges = member.profile.sides(s), member.profile.lane_edges(s)
    bounds = [begin.left, *edges[0]] if is_left else [begin.right, *edges[1]]
    inner, outer = bounds[index : index + 2]
    return (inner + outer) / 2, np.abs(outer - inner)


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
