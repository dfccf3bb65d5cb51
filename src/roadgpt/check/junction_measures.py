"""Measures the junctions that a route passes: kind, directions, exits and signs, on the finished geometry.

The direction of an arm is the direction of the straight line from the junction to the point 15 m along the
arm. On a shorter road, the line leads to the far end. So a bend within these 15 m changes the direction.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise

import numpy as np

from roadgpt.brief.junction_ranges import side_of
from roadgpt.brief.junctions import RAMPS, Control, JunctionKind, LaneKind, Side, Way
from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.pieces import along_all
from roadgpt.network import Connection, Junction, Network, NetworkRoad, Passage, RoadEnd, Route
from roadgpt.network.lane_design import LEAST_WIDTH

FULL = 0.9  # of the width of a lane, above which it is not yet in its taper
OUT = 15.0  # m, from a contact to the point that gives the direction of its arm
T_GAP = (145.0, 215.0)  # degrees, the largest gap between the arms of a T-junction
T_OTHERS = 55.0  # degrees, least other gap
Y_GAP = (85.0, 155.0)  # degrees, every gap between the arms of a fork
LINE = 35.0  # degrees, that opposite arms of crossroads may be off one line
STEP = 0.5  # m, between stations at which the width of a lane is measured


@dataclass(frozen=True)
class MeasuredJunction:
    """A junction as a route passes it. Angles are in degrees, lengths in metres."""

    s: float
    """Station at which the route enters the junction."""
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
    control: Control
    """The sign or the light that the route meets."""
    outer: float | None
    """Outer diameter of a roundabout; None for other junctions."""
    island: float | None
    """Radius of the central island of a roundabout; None for other junctions."""
    is_ramp: bool | None = None
    """Whether the route comes from the ramp (merge) or goes to it (diverge); None for other junctions."""
    ramp_side: Side | None = None
    """The side of the main road on which the ramp of a merge or exit lies; None for other junctions."""
    beside: float | None = None
    """Length of the lane for acceleration or deceleration of a merge or exit, without the taper; None for
    other junctions."""
    taper: float | None = None
    """Length of the taper of this lane; None for other junctions."""
    ring_lanes: int = 0
    """The number of lanes of the ring of a roundabout; 0 for other junctions."""
    all_controls: tuple[Control, ...] = ()
    """The sign or the light of each arm that has lanes into the junction."""
    only_in: tuple[Way, ...] = ()
    """The sides of one-way arms that lead to the junction; the arm of arrival is left out."""
    only_out: tuple[Way, ...] = ()
    """The sides of one-way arms that lead away from the junction."""

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

    s: float
    """Station in metres."""
    kind: LaneKind
    side: Side | None
    """The side of the lane that ends or begins, or to which the route changes."""
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
    """Returns the length in metres at one end of a road in which a lane is too narrow for a car."""
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
    and has the lane for acceleration, or the second ends at an exit and has the lane for deceleration.
    """
    ends = (RoadEnd(one.id, "start"), "merge"), (RoadEnd(two.id, "end"), "diverge")
    return any(
        (number := network.junction_at.get(end)) is not None and network.junction(number).kind == kind
        for end, kind in ends
    )


def _is_by_ramp(network: Network, passage: Passage) -> bool | None:
    """Returns whether the route uses the ramp of a merge or exit; None if there is no ramp."""
    junction = passage.entered
    if junction.kind not in RAMPS:
        return None
    way = _way_of_ramp(network, junction)
    return way.incoming == passage.arrival and way.outgoing == passage.departure


def _way_of_ramp(network: Network, junction: Junction) -> Connection:
    """Returns the way of a merge or exit that turns most: that from or to the ramp."""
    return max(junction.connections, key=lambda each: abs(_turn_of(network, each)))


def _turn_of(network: Network, way: Connection) -> float:
    """Returns the change of heading in radians along a way through a junction, left positive."""
    road = network.road(way.road).road
    return float(road.heading(road.length) - road.heading(0.0))


def side_of_ramp(network: Network, junction: Junction) -> Side:
    """Returns the side of the main road on which the ramp of a merge or exit lies."""
    return "left" if _turn_of(network, _way_of_ramp(network, junction)) > 0 else "right"


def lengths_beside_ramp(network: Network, junction: Junction) -> tuple[float, float]:
    """Returns the lengths in metres of the lane for acceleration or deceleration and of its taper.

    The taper is the part in which the lane is at most 0.9 of its full width; the first length does not
    include the taper. Both lengths are 0 if there is no lane for acceleration or deceleration.
    """
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


def _wrapped(angle: float) -> float:
    return (angle + 180) % 360 - 180


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
