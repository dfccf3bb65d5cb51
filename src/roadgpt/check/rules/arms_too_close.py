"""Requires room for a kerb between neighbouring arms of a junction, and for a car between two junctions.

The kerb is the largest circular arc that is tangent to the facing edges of both arms and lies inside the
junction, before the arms begin. Its radius must be at least 1 m, the smallest that a design may ask for. Arms
of different junctions must be at least a car's length (4.7 m) apart: along the road that joins them or, if no
road does, in a straight line."""

import math
from itertools import combinations

from roadgpt.brief.junctions import RAMPS
from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, junction_finding, name_of
from roadgpt.check.footprint import footprint
from roadgpt.network import Network, RoadEnd
from roadgpt.network.building import OPPOSITE, edges_at
from roadgpt.road import Road, World

KERB = 1.0  # m
CAR = 4.7  # m, length of the tested car
ROUNDING = 1e-9  # m


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports each pair of neighbouring arms and each pair of junctions that are too close together."""
    found = []
    for junction in network.junctions:
        arms = junction.arms
        joined = {frozenset((each.incoming, each.outgoing)) for each in junction.connections}
        ways_out = [_outwards(network, arm.end) for arm in arms]
        for n, one in enumerate(arms):
            after = (n + 1) % len(arms)
            other = arms[after]
            if junction.kind in RAMPS and frozenset((one.end, other.end)) not in joined:
                continue  # no traffic goes from the ramp to the main road beside it
            radius = math.inf if other.end == one.end else _room(ways_out[n], ways_out[after])
            if radius < KERB - ROUNDING:
                degrees = [round(math.degrees(arm.direction)) % 360 for arm in (one, other)]
                what = (
                    f"the arms at {degrees[0]} and {degrees[1]} degrees are so close that "
                    + (f"only a kerb of {radius:.1f} m fits" if radius > 0 else "no kerb fits")
                    + f" between them, and {KERB:g} m is the least; turn the arms apart"
                )
                found.append(junction_finding("arms_too_close", route, junction, what))
    return (*found, *_between_junctions(network, route))


Outwards = tuple[float, tuple[float, float], tuple[float, float]]
"""An arm seen from its junction: the heading out in radians, and the points (x, y) at which its left and its
right edge begin."""


def _room(one: Outwards, other: Outwards) -> float:
    """Returns the radius in metres of the largest kerb that fits between an arm and the next one
    counter-clockwise; zero or negative if the arms overlap, infinite if they need no kerb."""
    (heading, (ax, ay), _), (other_heading, _, (bx, by)) = one, other
    gap = (other_heading - heading) % (2 * math.pi)
    if gap >= math.pi - OPPOSITE:
        return math.inf
    if gap < ROUNDING:
        return -math.inf
    dx, dy = ax - bx, ay - by
    beyond = [
        (dx * math.sin(each) - dy * math.cos(each)) / math.sin(gap) for each in (other_heading, heading)
    ]
    return min(beyond) * math.tan(gap / 2)


def _outwards(network: Network, end: RoadEnd) -> Outwards:
    pose, member = footprint(network).ends[end], network.road(end.road)
    if end.contact == "start":
        left, right = edges_at(member.profile, 0.0)
        return pose.heading, pose.beside(left), pose.beside(right)
    right, left = edges_at(member.profile, member.road.length)
    return pose.heading + math.pi, pose.beside(left), pose.beside(right)


def _between_junctions(network: Network, route: Road | None) -> list[Finding]:
    poses, found = footprint(network).ends, []
    ends = [
        (number, junction, arm.end, poses[arm.end])
        for number, (_, junctions) in enumerate(network.nodes)
        for junction in junctions
        for arm in junction.arms
        if arm.end.road not in network.roundabout_of
    ]
    for (one, junction, end, pose), (another, other, far_end, far) in combinations(ends, 2):
        if one == another:
            continue
        is_road = end.road == far_end.road
        length = network.road(end.road).road.length if is_road else math.dist(pose[:2], far[:2])
        if length < CAR - ROUNDING:
            what = f"{name_of(other)} is only {length:.1f} m away"
            if is_road:
                what += " along the road between them"
            what += f", less than the {CAR:g} m of a car; move the junctions apart"
            found.append(junction_finding("arms_too_close", route, junction, what))
    return found
