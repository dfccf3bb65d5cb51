"""Defines the Route: a way through a network that is a Road itself.

Its centre line is the reference lines of its roads, one after another, so everything that can be done with a
Road can be done with a Route: check, drive, judge and draw it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Any, Self

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, Piece, PieceCurve
from roadgpt.network.ground import shoulders_on_ground
from roadgpt.network.network import Leg, Network, NetworkRoad, RoadEnd
from roadgpt.network.network_json import network_to_json
from roadgpt.network.passages import Passage, passages_of
from roadgpt.network.stretch import joined_grades
from roadgpt.road import Profile, Road
from roadgpt.road.profile import Lane, Width
from roadgpt.road.reversal import reversed_cubics, reversed_road


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Route(Road):
    """A way through a network. Its profile has the lanes of the roads that it follows.

    Inside junctions there are no oncoming lanes and no shoulders.
    """

    network: Network
    legs: tuple[Leg, ...]

    @classmethod
    def along(cls, network: Network, legs: Sequence[Leg]) -> Self:
        """Returns the route that follows roads of a network in this order.

        Raises:
            UsageError: There is no leg, a road or a lane does not exist, two roads that follow each other are
                not joined, or the route stays in a junction at an end.
        """
        if not legs:
            raise UsageError("a route has no road; give one or more [road, lane]")
        for leg in legs:
            _check_leg(network, leg)
        for one, two in pairwise(legs):
            _check_joint(network, one, two)
        if any(network.road(legs[n].road).junction is not None for n in (0, -1)):
            raise UsageError("a route begins and ends on a road outside junctions")
        roads = [_directed(network.road(leg.road), leg) for leg in legs]
        first = roads[0].plan
        assert isinstance(first, PieceCurve)
        pieces = tuple(p for road in roads for p in _pieces(road))
        plan = PieceCurve(first.x, first.y, first.heading0, pieces)
        return cls(
            plan,
            joined_grades(roads),
            profile=_profile(roads),
            network=network,
            legs=tuple(map(Leg._make, legs)),
        )

    def __repr__(self) -> str:
        kinds = ", ".join(each.entered.kind.replace("_", "-") for each in self.passages)
        return f"Route({self.length:.1f} m, junctions: {kinds or 'none'})"

    @cached_property
    def starts(self) -> tuple[float, ...]:
        """The station of the start of each leg, and of the end of the route, in metres."""
        return tuple(accumulate((self.network.road(leg.road).road.length for leg in self.legs), initial=0.0))

    @cached_property
    def passages(self) -> tuple[Passage, ...]:
        """The ways through the junctions, in driving order; each roundabout is one."""
        return passages_of(self)

    def on_ground(self) -> Self:
        """Returns the route with shoulders that reach to the edge of the ground.

        The ground is the paved area of the network, widened by its shoulders.
        """
        assert self.profile is not None
        left, right = shoulders_on_ground(self)
        profile = replace(
            self.profile,
            left=(self.profile.left[0], Lane("shoulder", left)),
            right=(self.profile.right[0], Lane("shoulder", right)),
        )
        return self.with_profile(profile)

    def to_json(self) -> dict[str, Any]:
        """Returns the route and its network as JSON data, for ``network.road_from_json``."""
        return {**self.to_route_json(), "network": network_to_json(self.network)}

    def to_route_json(self) -> dict[str, list[list[int]]]:
        """Returns the content of a route file: ``{"route": [[road, lane], ...]}`` in driving order."""
        return {"route": [list(leg) for leg in self.legs]}


def _check_leg(network: Network, leg: Leg) -> None:
    try:
        profile = network.road(leg.road).profile
    except KeyError as error:
        raise UsageError(f"the route names road {leg.road}, which is not in the network") from error
    forward, backward = profile.count
    if leg.lane == 0 or not -forward <= leg.lane <= backward:
        raise UsageError(f"the route names lane {leg.lane} of road {leg.road}, which has no such lane")


def _check_joint(network: Network, one: Leg, two: Leg) -> None:
    """Raises UsageError unless the second leg follows the first one."""
    if (found := network.connection_of.get(two.road)) is not None:
        end = RoadEnd(one.road, "end" if one.lane < 0 else "start")
        is_joined = found[1].incoming == end and (one.lane, two.lane) in found[1].lanes
    elif (found := network.connection_of.get(one.road)) is not None:
        is_joined = found[1].outgoing == RoadEnd(two.road, "start" if two.lane < 0 else "end")
    else:
        is_joined = False
    if not is_joined:
        raise UsageError(f"no way leads from road {one.road} to road {two.road}, as the route asks")


def _directed(member: NetworkRoad, leg: Leg) -> Road:
    """Returns the road in the direction in which the route follows it."""
    if leg.lane < 0:
        return member.road
    profile = member.profile
    turned = Profile(
        tuple(_turned(lane, member.road.length) for lane in profile.right),
        tuple(_turned(lane, member.road.length) for lane in profile.left),
        leg.lane - 1,
        profile.centre_marking,
    )
    return reversed_road(member.road).with_profile(turned)


def _turned(lane: Lane, length: float) -> Lane:
    if not isinstance(lane.width, CubicProfile):
        return lane
    return Lane(lane.kind, reversed_cubics(lane.width, length), lane.marking)


def _pieces(road: Road) -> tuple[Piece, ...]:
    assert isinstance(road.plan, PieceCurve)
    return road.plan.pieces


def _profile(roads: Sequence[Road]) -> Profile:
    """Returns the lanes along roads that follow each other: one along, one against, and the shoulders."""
    starts = [0.0, *accumulate(road.length for road in roads)]
    own = [_lanes(road) for road in roads]

    def lane(index: int) -> Width:
        return _joined_widths([each[index] for each in own], roads, starts)

    marking = next(road.profile.centre_marking for road in roads if road.profile is not None)
    return Profile(
        (Lane("driving", lane(0), "solid"), Lane("shoulder", lane(1))),
        (Lane("driving", lane(2), "solid"), Lane("shoulder", lane(3))),
        0,
        marking,
    )


def _lanes(road: Road) -> tuple[Width, Width, Width, Width]:
    """Returns the widths of the oncoming lane, its shoulder, the lane of the route, and its shoulder."""
    profile = road.profile
    assert profile is not None

    def width(side: Sequence[Lane], kind: str) -> Width:
        return next((lane.width for lane in side if lane.kind == kind), 0.0)

    return (
        width(profile.left, "driving"),
        width(profile.left, "shoulder"),
        width(profile.right, "driving"),
        width(profile.right, "shoulder"),
    )


def _joined_widths(widths: Sequence[Width], roads: Sequence[Road], starts: Sequence[float]) -> Width:
    if all(width == widths[0] and not isinstance(width, CubicProfile) for width in widths):
        return widths[0]
    stations: list[float] = []
    rows: list[tuple[float, float, float, float]] = []
    for width, road, start in zip(widths, roads, starts, strict=False):
        if not isinstance(width, CubicProfile):
            stations.append(start)
            rows.append((width, 0.0, 0.0, 0.0))
            continue
        inside = np.array([0.0, *(s for s in width.stations if 0 < s < road.length - 1e-9)])
        table = width.cubics(inside)
        stations += (start + inside).tolist()
        rows += [(a, b, c, d) for a, b, c, d in table.tolist()]
    return CubicProfile(tuple(stations), tuple(rows))
