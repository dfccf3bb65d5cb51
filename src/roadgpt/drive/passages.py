"""Lists the junctions on a route, with what a driver has to know of each, and tells which lie ahead."""

from bisect import bisect_right
from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple

from roadgpt.brief.junctions import Control
from roadgpt.drive.view import JunctionAhead
from roadgpt.geometry import wrap_angle
from roadgpt.network import Junction, Leg, RoadEnd, Route

if TYPE_CHECKING:
    from roadgpt.road import Road, World

STOP_LINE = 0.5  # m, width of a stop line, which ends where the junction begins (Germany, RMS-1)


class Passage(NamedTuple):
    """The way of a route through one junction or one roundabout."""

    start: float
    """Station in metres at which the route enters the junction."""
    end: float
    """Station in metres at which the route leaves it."""
    kind: str
    turn: float
    """Change of heading in radians, left positive, in (-pi, pi]."""
    exit: int
    """Number of the road of departure, counted counter-clockwise from the road of arrival."""
    control: Control

    @property
    def stop_line(self) -> float | None:
        """Station in metres of the stop line of a stop sign; None if there is no stop sign."""
        return self.start - STOP_LINE if self.control == "stop" else None


def route_of(road: "Road") -> Route | None:
    """Returns the road if it is a route through a network, otherwise None."""
    return road if isinstance(road, Route) else None


def passages(road: "Road") -> tuple[Passage, ...]:
    """Returns the ways of a route through its junctions in driving order; nothing for a single road."""
    route = route_of(road)
    if route is None:
        return ()
    found = []
    indices = range(len(route.legs))
    for node, group in groupby(indices, key=lambda n: _node(route, route.legs[n])):
        inside = [n for n in group if node is not None]
        if any(route.network.road(route.legs[n].road).junction is not None for n in inside):
            found.append(_passage(route, inside))
    return tuple(found)


def _node(route: Route, leg: Leg) -> tuple[str, int] | None:
    """Returns what tells the junction or roundabout of a leg apart from others; None outside junctions."""
    ring = route.network.roundabout_of.get(leg.road)
    if ring is not None:
        return "roundabout", ring.junctions[0]
    junction = route.network.road(leg.road).junction
    return None if junction is None else ("junction", junction)


def _passage(route: Route, inside: list[int]) -> Passage:
    """Returns the way through a junction or roundabout, whose legs have the indices ``inside``."""
    start, end = route.starts[inside[0]], route.starts[inside[-1] + 1]
    connecting = [n for n in inside if route.network.road(route.legs[n].road).junction is not None]
    arrival, connection = route.network.connection_of[route.legs[connecting[0]].road]
    departure, leaving = route.network.connection_of[route.legs[connecting[-1]].road]
    turn = float(wrap_angle(route.heading(end) - route.heading(start)))
    ring = route.network.roundabout_of.get(arrival.id)
    if ring is None:
        ends = [arm.end for arm in arrival.arms]
        number = (ends.index(leaving.outgoing) - ends.index(connection.incoming)) % len(ends)
    else:
        way = [ring.junctions.index(each.id) for each in (arrival, departure)]
        number = (way[1] - way[0]) % len(ring.junctions) or len(ring.junctions)
    return Passage(start, end, arrival.kind, turn, number, _control(arrival, connection.incoming))


def _control(junction: Junction, end: RoadEnd) -> Control:
    return next(arm.control for arm in junction.arms if arm.end == end)


class Outlook:
    """What a driver sees of its route at each station: the junctions ahead, and the lanes beside its own."""

    def __init__(self, road: "Road", world: "World") -> None:
        """Prepares the junctions and the lanes of a road or a route."""
        self._route = route_of(road)
        self._passages = passages(road)
        self._ends = [each.end for each in self._passages]
        self._starts, self._beside = [0.0], [_beside_on_road(road, world)]
        if self._route is not None:
            self._starts = list(self._route.starts[:-1])
            self._beside = [_beside_on_leg(self._route, leg) for leg in self._route.legs]
        self._plain = (self._route, (), *self._beside[0])

    def at(self, s: float) -> tuple[Route | None, tuple[JunctionAhead, ...], int, int]:
        """Returns the last four fields of a View at station ``s``: route, junctions, lanes left and right."""
        if self._route is None:
            return self._plain
        ahead = tuple(
            JunctionAhead(
                max(each.start - s, 0.0),
                each.kind,
                each.turn,
                each.exit,
                each.control,
                each.end - max(each.start, s),
            )
            for each in self._passages[bisect_right(self._ends, s) :]
        )
        return self._route, ahead, *self._beside[max(bisect_right(self._starts, s) - 1, 0)]


def _beside_on_road(road: "Road", world: "World") -> tuple[int, int]:
    """Returns the number of driving lanes to the left and to the right of the driven lane."""
    profile = world.profile_of(road)
    forward, backward = profile.count
    return profile.driven + backward, forward - 1 - profile.driven


def _beside_on_leg(route: Route, leg: Leg) -> tuple[int, int]:
    forward, backward = route.network.road(leg.road).profile.count
    own, oncoming = (forward, backward) if leg.lane < 0 else (backward, forward)
    number = abs(leg.lane)
    return number - 1 + oncoming, own - number
