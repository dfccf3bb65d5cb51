"""Measures finished networks: the junctions that a route passes, with kind, directions, exits and signs; the
map as a whole, with blocks, ends and distances; and how tightly lines beside a centre line bend.

The direction of an arm is the direction of the straight line from the junction to the point 15 m along the
arm. On a shorter road, the line leads to the far end. So a bend within these 15 m changes the direction."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice, pairwise

import numpy as np
import scipy

from roadgpt.brief.junctions import RAMPS, Control, JunctionKind, LaneKind, Side, Way, side_of
from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import along_all
from roadgpt.network import Connection, Junction, Network, NetworkRoad, Passage, RoadEnd, Route
from roadgpt.network.design import LEAST_WIDTH

FULL = 0.9  # of the width of a lane, above which it is not yet in its taper
OUT = 15.0  # m, from a contact to the point that gives the direction of its arm
T_GAP = (145.0, 215.0)  # degrees, the largest gap between the arms of a T-junction
T_OTHERS = 55.0  # degrees, least other gap
Y_GAP = (85.0, 155.0)  # degrees, every gap between the arms of a fork
LINE = 35.0  # degrees, that opposite arms of crossroads may be off one line
STEP = 0.5  # m, between stations at which the width of a lane is measured
STRAIGHT_ROAD = math.radians(5.0)  # largest change of heading of a road that counts as straight
ROUNDING = 1e-9  # m
GRID = np.linspace(0.0, 1.0, 33)  # ratio of the length of a piece, where its lane varies in width
INSIDE = 1e-9  # m before the end of a road, where the width is evaluated instead of at the end


@dataclass(frozen=True)
class MeasuredJunction:
    """A junction as a route passes it. Angles are in degrees, lengths in metres."""

    s: float  # station at which the route enters the junction
    kinds: tuple[JunctionKind, ...]
    """The kinds that the junction may be called; empty if its angles fit no kind."""
    gaps: tuple[float, ...]
    """Angles between neighbouring arms, counter-clockwise from the arm of arrival; clockwise with traffic on
    the left."""
    turn: float
    """Change of direction of the route, left positive; 180 if the route leaves on the arm of arrival."""
    exit: int
    """Number of the arm on which the route leaves. Arms are counted from 1 in the order of ``gaps``; the arm
    of arrival comes last."""
    ways: tuple[float, ...]
    """Changes of direction from the arm of arrival to each other arm, left positive, in the same order as
    ``gaps``."""
    control: Control  # the sign or the light that the route meets
    outer: float | None  # outer diameter of a roundabout; None for other junctions
    island: float | None  # radius of the central island of a roundabout; None for other junctions
    is_ramp: bool | None = None
    """Whether the route comes from the ramp (merge) or goes to it (diverge); None for other junctions."""
    ramp_side: Side | None = None
    """The side of the main road on which the ramp of a merge or exit lies; None for other junctions."""
    beside: float | None = None
    """Length of the lane for acceleration or deceleration of a merge or exit, without the taper; None for
    other junctions."""
    taper: float | None = None  # length of the taper of this lane; None for other junctions
    ring_lanes: int = 0  # the number of lanes of the ring of a roundabout; 0 for other junctions
    all_controls: tuple[Control, ...] = ()
    """The sign or the light of each arm that has lanes into the junction."""
    only_in: tuple[Way, ...] = ()
    """The sides of one-way arms that lead to the junction; the arm of arrival is left out."""
    only_out: tuple[Way, ...] = ()  # the sides of one-way arms that lead away from the junction

    @property
    def arms(self) -> int:
        """The number of arms."""
        return len(self.gaps)

    @property
    def sides(self) -> tuple[Way, ...]:
        """The side to which each change of direction in ``ways`` leads: "left", "straight" or "right"."""
        return tuple(side_of(turn) for turn in self.ways)

    @property
    def ways_on(self) -> tuple[Way, ...]:
        """The sides on which traffic can leave the junction: ``sides`` without those of ``only_in``."""
        on = list(self.sides)
        for side in self.only_in:
            on.remove(side)
        return tuple(on)


def measured_junctions(route: Route) -> list[MeasuredJunction]:
    """Returns the junctions that a route passes, in driving order. A roundabout counts as one junction."""
    passages = route.passages
    directions = iter(directions_of(route.network, [end for each in passages for end in each.arms]))
    return [_measured(route.network, each, [*islice(directions, len(each.arms))]) for each in passages]


@dataclass(frozen=True)
class MeasuredLanes:
    """A place where the number of lanes changes, or where the route changes its lane."""

    s: float  # station in metres
    kind: LaneKind
    side: Side | None  # the side of the lane that ends or begins, or to which the route changes
    behind: float = 0.0
    """Distance in metres along the route from ``s`` to the place where the ending lane becomes too narrow for
    a car, or the new lane wide enough. For a change of lanes: to the middle of the first change. Negative if
    before ``s``."""


def measured_places(route: Route) -> list[MeasuredJunction | MeasuredLanes]:
    """Returns what a route passes, in driving order: junctions, and places where lanes change."""
    found: list[MeasuredJunction | MeasuredLanes] = [*measured_junctions(route), *_lane_places(route)]
    return sorted(found, key=lambda each: each.s)


def _lane_places(route: Route) -> Iterator[MeasuredLanes]:
    network = route.network
    for (_, one), (start, two) in pairwise(route.roads):
        if RoadEnd(one.id, "end") not in network.continued_at or is_beside_ramp(network, one, two):
            continue
        before, after = one.profile.count[0], two.profile.count[0]
        lanes = [leg.lane for leg in route.legs if leg.road == two.id]
        if after != before:
            pairs = network.continued_at[RoadEnd(two.id, "start")].lanes
            own = two.profile.side
            is_left = (own > 0) == ((own, own) in pairs)
            side: Side = "left" if is_left else "right"
            if after < before:
                yield MeasuredLanes(start, "lane_drop", side, -_narrow_part(one, at_end=True))
            else:
                yield MeasuredLanes(start, "lane_gain", side, _narrow_part(two, at_end=False))
        elif len(lanes) > 1:
            is_left = (lanes[1] > lanes[0]) == two.profile.leads_along(lanes[0])
            middle = two.road.length / len(lanes[1:]) / 2
            yield MeasuredLanes(start, "lane_change", "left" if is_left else "right", middle)


def _narrow_part(member: NetworkRoad, at_end: bool) -> float:
    length = member.road.length
    s = np.linspace(0.0, length, math.ceil(length / STEP) + 1)
    found = 0.0
    for lane in member.profile.along[: member.profile.count[0]]:
        if isinstance(lane.width, CubicProfile):
            wide = s[lane.width.height(s) >= LEAST_WIDTH]
            found = max(found, length - wide[-1] if at_end else wide[0])
    return float(found)


def is_beside_ramp(network: Network, one: NetworkRoad, two: NetworkRoad) -> bool:
    """Returns whether a change of lanes between two roads belongs to a ramp: the first road begins at a merge
    and has the lane for acceleration, or the second ends at an exit and has the lane for deceleration."""
    ends = (RoadEnd(one.id, "start"), "merge"), (RoadEnd(two.id, "end"), "diverge")
    return any(
        (number := network.junction_at.get(end)) is not None and network.junction(number).kind == kind
        for end, kind in ends
    )


def _is_by_ramp(network: Network, passage: Passage) -> bool | None:
    junction = passage.entered
    if junction.kind not in RAMPS:
        return None
    way = _way_of_ramp(network, junction)
    return way.incoming == passage.arrival and way.outgoing == passage.departure


def _way_of_ramp(network: Network, junction: Junction) -> Connection:
    return max(junction.connections, key=lambda each: abs(_turn_of(network, each)))


def _turn_of(network: Network, way: Connection) -> float:
    """Returns the change of heading in radians along a way through a junction, left positive."""
    road = network.road(way.road).road
    return float(road.heading(road.length) - road.heading(0.0))


def side_of_ramp(network: Network, junction: Junction) -> Side:
    """Returns the side of the main road on which the ramp of a merge or exit lies."""
    return "left" if _turn_of(network, _way_of_ramp(network, junction)) > 0 else "right"


def lengths_beside_ramp(network: Network, junction: Junction) -> tuple[float, float]:
    """Returns the lengths in metres of the lane for acceleration or deceleration and of its taper, the part
    in which the lane is at most 0.9 of its full width; both are 0 if there is no such lane."""
    way = _way_of_ramp(network, junction)
    beside = network.road((way.outgoing if junction.kind == "merge" else way.incoming).road)
    is_outer = (side_of_ramp(network, junction) == "left") == network.left_hand
    width = beside.profile.along[beside.profile.count[0] - 1 if is_outer else 0].width
    if not isinstance(width, CubicProfile):
        return 0.0, 0.0
    s = np.linspace(0.0, beside.road.length, max(2, round(beside.road.length)))
    full = float(np.mean(width.height(s) > FULL * width.extremes()[1])) * beside.road.length
    return full, beside.road.length - full


def _measured(network: Network, passage: Passage, directions: Sequence[float]) -> MeasuredJunction:
    ring = network.roundabout_of.get(passage.entered.id)
    is_ramp = _is_by_ramp(network, passage)
    full, taper = (None, None) if is_ramp is None else lengths_beside_ramp(network, passage.entered)
    around = 1 if not network.left_hand else -1
    gaps = [around * (b - a) % 360 for a, b in pairwise([*directions, directions[0]])]
    ways = tuple(_wrapped(each - directions[0] - 180) for each in directions[1:])
    return MeasuredJunction(
        passage.start,
        kinds_of(gaps) if ring is None and is_ramp is None else (passage.entered.kind,),
        tuple(gaps),
        180.0 if passage.exit == len(passage.arms) else ways[passage.exit - 1],
        passage.exit,
        ways,
        passage.control,
        None if ring is None else 2 * (ring.radius + ring.width),
        None if ring is None else ring.radius,
        is_ramp,
        None if is_ramp is None else side_of_ramp(network, passage.entered),
        full,
        taper,
        0 if ring is None else network.road(ring.ring[0]).profile.count[0],
        tuple(arm.control for arm in passage.entered.arms if network.lanes_into(arm.end)),
        *_one_way_sides(network, passage, ways),
    )


def _wrapped(degrees: float) -> float:
    return (degrees + 180) % 360 - 180


def _one_way_sides(
    network: Network, passage: Passage, ways: tuple[float, ...]
) -> tuple[tuple[Way, ...], tuple[Way, ...]]:
    """Returns the sides of the arms whose traffic only drives to a junction, or only away from it."""
    into, out = list[Way](), list[Way]()
    for end, turn in zip(passage.arms[1:], ways, strict=True):
        if not network.lanes_out_of(end):
            into.append(side_of(turn))
        elif not network.lanes_into(end):
            out.append(side_of(turn))
    return tuple(into), tuple(out)


def directions_of(network: Network, arms: Sequence[RoadEnd]) -> list[float]:
    """Returns the directions of arms out of their junctions, in degrees counter-clockwise from +x."""
    plans, stations = [], []
    for end in arms:
        plan = network.road(end.road).road.plan
        assert isinstance(plan, PieceCurve)
        far = min(OUT, plan.length)
        plans.append(plan)
        stations.append(np.array([0.0, far] if end.contact == "start" else [plan.length, plan.length - far]))
    points = along_all(plans, stations)[0] if plans else np.empty((0, 2))
    return [math.degrees(math.atan2(y, x)) for x, y in (points[1::2] - points[::2]).tolist()]


def kinds_of(gaps: list[float]) -> tuple[JunctionKind, ...]:
    """Returns the kinds of junction that fit the angles between neighbouring arms, degrees; may be empty."""
    found: list[JunctionKind] = []
    least, *_, most = sorted(gaps)
    if len(gaps) == 3:
        if least >= T_OTHERS and T_GAP[0] <= most <= T_GAP[1]:
            found.append("t_junction")
        if least >= Y_GAP[0] and most <= Y_GAP[1]:
            found.append("y_junction")
    elif len(gaps) == 4:
        if all(abs(gaps[n] + gaps[n + 1] - 180) <= LINE for n in range(2)):
            found.append("crossroads")
    elif len(gaps) > 4:
        found.append("star")
    return tuple(found)


@dataclass(frozen=True)
class MeasuredNode:
    """A junction or a roundabout of a map."""

    place: tuple[float, float]  # its middle (x, y) in metres
    kinds: tuple[JunctionKind, ...]
    """The kinds that the junction may be called; empty if its angles fit no kind."""
    gaps: tuple[float, ...]  # angles in degrees between neighbouring arms, in order around the junction
    controls: frozenset[Control]  # the signs and lights of its arms


@dataclass(frozen=True)
class MeasuredMap:
    """The measures of a whole network."""

    nodes: tuple[MeasuredNode, ...]
    """The junctions. A roundabout counts as one junction."""
    blocks: int  # the number of areas that roads enclose
    ends: int  # the number of road ends that meet no junction
    parts: int  # the number of separate parts, which no roads connect; 1 for a connected map
    distances: tuple[float, ...]
    """For each straight road between two junctions, the distance in metres between their middles."""
    length: float  # the length in metres of all roads outside junctions


def measured_map(network: Network) -> MeasuredMap:
    """Measures a network; a roundabout counts as one junction."""
    found = [_node(network, junctions) for _, junctions in network.nodes]
    number_of = {junction.id: n for n, (_, group) in enumerate(network.nodes) for junction in group}
    roads = network.roads_outside
    joined, distances, ends = list[tuple[int, int]](), list[float](), 0
    for member in roads:
        met = []
        for contact in (RoadEnd(member.id, "start"), RoadEnd(member.id, "end")):
            junction = network.junction_at.get(contact)
            if junction is None:
                ends += 1
                met.append(len(found) + ends - 1)
            else:
                met.append(number_of[junction])
        joined.append((met[0], met[1]))
        if max(met) < len(found) and _is_straight(network, member.id):
            distances.append(math.dist(found[met[0]].place, found[met[1]].place))
    count = len(found) + ends
    graph = scipy.sparse.coo_array((np.ones(len(joined)), np.reshape(joined, (-1, 2)).T), (count, count))
    parts, _ = scipy.sparse.csgraph.connected_components(graph, directed=False)
    length = sum(member.road.length for member in roads)
    return MeasuredMap(tuple(found), len(roads) - count + parts, ends, parts, tuple(distances), length)


def _node(network: Network, junctions: tuple[Junction, ...]) -> MeasuredNode:
    is_ring = junctions[0].id in network.roundabout_of
    # the first arm of each junction of a roundabout is the one that is no part of the ring
    arms = [each.arms[0] for each in junctions] if is_ring else list(junctions[0].arms)
    directions = directions_of(network, [arm.end for arm in arms])
    around = -1 if is_ring and network.left_hand else 1
    gaps = [around * (b - a) % 360 for a, b in pairwise([*directions, directions[0]])]
    kinds: tuple[JunctionKind, ...] = ("roundabout",) if is_ring else kinds_of(gaps)
    x, y, _ = junctions[0].node
    return MeasuredNode((x, y), kinds, tuple(gaps), frozenset(arm.control for arm in arms))


def _is_straight(network: Network, number: int) -> bool:
    road = network.road(number).road
    return abs(float(road.heading(road.length) - road.heading(0.0))) < STRAIGHT_ROAD and math.isclose(
        road.length, math.dist(road.at(0.0)[:2].tolist(), road.at(road.length)[:2].tolist()), rel_tol=0.01
    )


def tightest_radius(member: NetworkRoad, share: float, only_right: bool = False) -> float:
    """Returns the least radius in metres of a line along the right lane of a connecting road: 0 where the
    line folds, infinite without a bend. With ``only_right``, bends to the left are ignored.

    The line lies to the right of the centre line, at a distance of ``share`` times the width of the lane: 0.5
    for the middle of the lane, 1 for its right edge. Where the width varies, the line is not an arc even if
    the centre line is an arc. Source: the curvature of x(s) = c(s) + d(s) n(s), by Frenet's formulas."""
    plan, width = member.road.plan, member.profile.right[0].width
    assert isinstance(plan, PieceCurve)
    if isinstance(width, CubicProfile):
        k, slope, *widths = _frames(member)
        d, d1, d2 = (-share * each for each in widths)
        along = 1 - d * k
        with np.errstate(divide="ignore", invalid="ignore"):  # where the curve folds
            bends = (along * (d2 + along * k) + d1 * (2 * d1 * k + d * slope)) / np.hypot(along, d1) ** 3
    else:
        k = np.array([(piece.k0, piece.k1) for piece in plan.pieces])  # where curvature is extreme
        along = 1 + share * width * k
        with np.errstate(divide="ignore", invalid="ignore"):
            bends = k / along
    bends = np.where(along > 0, bends, np.copysign(np.inf, k))
    bend = float((-bends if only_right else np.abs(bends)).max())
    return 1 / bend if bend > 0 else math.inf


@lru_cache(maxsize=128)
def _frames(member: NetworkRoad) -> tuple[Array, Array, Array, Array, Array]:
    """Returns the curvature of a connecting road at many stations and its change per metre, and the width of
    the lane with the first and second derivative of this width."""
    plan, width = member.road.plan, member.profile.right[0].width
    assert isinstance(plan, PieceCurve)
    assert isinstance(width, CubicProfile)
    length, k0, k1 = np.array([(piece.length, piece.k0, piece.k1) for piece in plan.pieces]).T[..., None]
    k = (k0 + (k1 - k0) * GRID).ravel()
    s = (np.cumsum(length)[:, None] - length + length * GRID).ravel()
    slope = np.repeat((k1 - k0) / length, len(GRID), axis=1).ravel()
    at = np.minimum(s, plan.length - INSIDE)
    return k, slope, width.height(at), width.grade(at), width.vertical_curvature(at)
