"""Measures the junctions that a route passes: kind, directions, exits and signs, on the finished geometry.

The direction of an arm is that of the line from its contact to the point 15 m farther out, so a bend there
counts as well.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

from roadgpt.brief.junctions import Control, JunctionKind, Way, side_of
from roadgpt.network import Network, Passage, RoadEnd, Route

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
    return [_measured(route.network, passage) for passage in route.passages]


def _measured(network: Network, passage: Passage) -> MeasuredJunction:
    ring = network.roundabout_of.get(passage.entered.id)
    directions = [_direction(network, end) for end in passage.arms]
    gaps = [(b - a) % 360 for a, b in pairwise([*directions, directions[0]])]
    ways = tuple(_wrapped(each - directions[0] - 180) for each in directions[1:])
    return MeasuredJunction(
        passage.start,
        ("roundabout",) if ring is not None else _kinds(gaps),
        tuple(gaps),
        180.0 if passage.exit == len(passage.arms) else ways[passage.exit - 1],
        passage.exit,
        ways,
        passage.control,
        None if ring is None else 2 * (ring.radius + ring.width),
        None if ring is None else ring.radius,
    )


def _direction(network: Network, end: RoadEnd) -> float:
    """Returns the direction of an arm out of its junction in degrees."""
    road = network.road(end.road).road
    far = min(OUT, road.length)
    near, away = (0.0, far) if end.contact == "start" else (road.length, road.length - far)
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
