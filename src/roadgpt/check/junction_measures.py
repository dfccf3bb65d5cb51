"""Measures the junctions that a route passes: kind, directions, exits and signs, on the finished geometry.

The direction of an arm is that of the line from its contact to the point 15 m farther out, so a bend there
counts as well.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

from roadgpt.brief.junctions import Control, JunctionKind, Way, side_of
from roadgpt.network import Arm, Junction, Network, RoadEnd, Route

OUT = 15.0  # m, from a contact to the point that gives the direction of its arm
T_GAP = (145.0, 215.0)  # degrees, the largest gap between the arms of a T-junction
T_OTHERS = 55.0  # degrees, least other gap
Y_GAP = (85.0, 155.0)  # degrees, every gap between the arms of a fork
LINE = 35.0  # degrees, that opposite arms of crossroads may be off one line
SKEW = 70.0  # degrees; a smaller gap makes crossroads skew


@dataclass(frozen=True)
class MeasuredJunction:
    """A junction as a route passes it. Angles are in degrees, lengths in metres."""

    s: float
    """Station at which the route enters it."""
    kinds: tuple[JunctionKind, ...]
    """The kinds that it may be called; empty for none."""
    gaps: tuple[float, ...]
    """Angles between neighbouring arms, counter-clockwise from the arm of arrival."""
    turn: float
    """Change of direction of the route, left positive; 180 for a way back."""
    exit: int
    """Number of the arm on which the route leaves, counted counter-clockwise from the arm of arrival."""
    ways: tuple[float, ...]
    """Changes of direction to all arms but the one of arrival, counter-clockwise."""
    control: Control
    outer: float | None
    """Outer diameter of a roundabout; None for other junctions."""
    island: float | None
    """Radius of the central island of a roundabout; None for other junctions."""

    @property
    def arms(self) -> int:
        """The number of arms."""
        return len(self.gaps)

    @property
    def sides(self) -> tuple[Way, ...]:
        """The side of each way."""
        return tuple(side_of(turn) for turn in self.ways)


def measured_junctions(route: Route) -> list[MeasuredJunction]:
    """Returns the junctions that a route passes, in driving order; each roundabout is one."""
    return [_measured(route, s, junction) for s, junction in route.passed]


def _measured(route: Route, s: float, junction: Junction) -> MeasuredJunction:
    network = route.network
    ring = network.roundabout_of.get(junction.id)
    arms = [junction.arms[0]] if ring is not None else list(junction.arms)
    if ring is not None:  # the first arm of each of its junctions is no part of the ring
        arms = [network.junction(number).arms[0] for number in ring.junctions]
    start = next(n for n, at in enumerate(route.starts) if at == s)
    here = [arm.end for arm in arms]
    first = here.index(network.connection_of[route.legs[start].road][1].incoming)
    last = here.index(_leaving(route, start, {arm.end for arm in arms}))
    arms = arms[first:] + arms[:first]
    directions = [_direction(network, arm) for arm in arms]
    gaps = [(b - a) % 360 for a, b in pairwise([*directions, directions[0]])]
    ways = tuple(_wrapped(each - directions[0] - 180) for each in directions[1:])
    exit_ = (last - first) % len(arms) or len(arms)
    return MeasuredJunction(
        s,
        ("roundabout",) if ring is not None else _kinds(gaps),
        tuple(gaps),
        180.0 if exit_ == len(arms) else ways[exit_ - 1],
        exit_,
        ways,
        arms[0].control,
        None if ring is None else 2 * (ring.radius + ring.width),
        None if ring is None else ring.radius,
    )


def _leaving(route: Route, start: int, ends: set[RoadEnd]) -> RoadEnd:
    """Returns the end of the road on which the route leaves a junction that it enters with leg ``start``."""
    for leg in route.legs[start:]:
        found = route.network.connection_of.get(leg.road)
        if found is not None and found[1].outgoing in ends:
            return found[1].outgoing
    raise ValueError("a route ends on a road outside junctions")


def _direction(network: Network, arm: Arm) -> float:
    """Returns the direction of an arm out of its junction in degrees."""
    road = network.road(arm.end.road).road
    far = min(OUT, road.length)
    near, away = (0.0, far) if arm.end.contact == "start" else (road.length, road.length - far)
    x, y = (road.at(away) - road.at(near))[:2].tolist()
    return math.degrees(math.atan2(y, x))


def _wrapped(angle: float) -> float:
    return (angle + 180) % 360 - 180


def _kinds(gaps: list[float]) -> tuple[JunctionKind, ...]:
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
