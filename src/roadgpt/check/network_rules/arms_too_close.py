"""Requires room for a kerb between neighbouring arms of a junction, and for a car between two junctions.

The kerb is the largest circular arc that is tangent to the edges of both arms at points no farther from the
junction than where the arms begin. Its radius must be at least 1 m, the smallest that a design may ask for.
Arms of different junctions must be at least a car's length (4.7 m) apart: along the road that joins them or,
if no road does, in a straight line.
"""

import math
from itertools import combinations

from roadgpt.brief.junctions import RAMPS
from roadgpt.check.finding import Finding
from roadgpt.check.footprint import EndPose, footprint
from roadgpt.check.network_places import junction_finding, name_of
from roadgpt.network import Arm, Network, RoadEnd, Route
from roadgpt.network.crossing import OPPOSITE
from roadgpt.road import World

KERB = 1.0  # m
CAR = 4.7  # m, length of the tested car
ROUNDING = 1e-9  # m


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each pair of neighbouring arms and each pair of junctions that are too close together."""
    found = []
    for junction in network.junctions:
        arms = junction.arms
        joined = {frozenset((each.incoming, each.outgoing)) for each in junction.connections}
        for one, other in zip(arms, [*arms[1:], *arms[:1]], strict=True):
            if junction.kind in RAMPS and frozenset((one.end, other.end)) not in joined:
                continue  # no traffic goes from the ramp to the main road beside it
            radius = _room(network, one, other)
            if radius < KERB - ROUNDING:
                degrees = [round(math.degrees(arm.direction)) % 360 for arm in (one, other)]
                what = (
                    f"the arms at {degrees[0]} and {degrees[1]} degrees are so close that "
                    + (f"only a kerb of {radius:.1f} m fits" if radius > 0 else "no kerb fits")
                    + f" between them, and {KERB:g} m is the least; turn the arms apart"
                )
                found.append(junction_finding("arms_too_close", route, junction, what))
    return (*found, *_between_junctions(network, route))


def _room(network: Network, one: Arm, other: Arm) -> float:
    """Returns the radius in metres of the largest kerb that fits between an arm and the next one
    counter-clockwise; zero or negative if the arms overlap, infinite if they need no kerb.
    """
    (here, width, heading), (there, other_width, other_heading) = (
        _outwards(network, arm.end) for arm in (one, other)
    )
    gap = (other_heading - heading) % (2 * math.pi)
    if gap >= math.pi - OPPOSITE or len({one.end, other.end}) < 2:
        return math.inf
    if gap < ROUNDING:
        return -math.inf
    (ax, ay), (bx, by) = here.beside(width[0]), there.beside(other_width[1])
    dx, dy = ax - bx, ay - by
    beyond = [
        (dx * math.sin(each) - dy * math.cos(each)) / math.sin(gap) for each in (other_heading, heading)
    ]
    return min(beyond) * math.tan(gap / 2)


def _outwards(network: Network, end: RoadEnd) -> tuple[EndPose, tuple[float, float], float]:
    """Returns the pose at the end of an arm, the offsets in metres of the edges that are on the left and on
    the right when leaving the junction, and the heading out of the junction in radians.
    """
    pose, member = footprint(network).ends[end], network.road(end.road)
    s = 0.0 if end.contact == "start" else member.road.length
    left, right = (float(t) for t in member.profile.edges(s))
    if end.contact == "start":
        return pose, (left, right), pose.heading
    return pose, (right, left), pose.heading + math.pi


def _between_junctions(network: Network, route: Route | None) -> list[Finding]:
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
