"""Defines the Finding: one violation of a rule by a road, and says where it is."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.brief.junctions import NAMES
from roadgpt.network import Junction, Network, NetworkRoad, is_route
from roadgpt.road import Road

if TYPE_CHECKING:
    from roadgpt.network import Route


@dataclass(frozen=True, slots=True)
class Finding:
    """One violation of a rule: the name of the rule and a sentence that describes the violation. ``s`` is the
    station and (x, y) the point of the violation, in metres. All three are None for a violation that concerns
    the whole road. If only the point is known, only ``s`` is None."""

    rule: str
    sentence: str
    s: float | None = None
    x: float | None = None
    y: float | None = None
    stops: bool = False
    """Whether the road cannot be driven at all, for example because it is too short for a car."""


def single_road(route: Road | None) -> Road | None:
    """Returns the road that is driven if it is a single one, which must also suit the SBFT competition; None
    for a Route, and for a map without a route."""
    return None if route_of(route) is not None else route


def route_of(route: Road | None) -> "Route | None":
    """Returns the Route that is driven through a network; None for a single road."""
    return route if route is not None and is_route(route) else None


def junction_finding(rule: str, route: Road | None, junction: Junction, what: str) -> Finding:
    """Returns the Finding that something, ``what``, is wrong at a junction. Its station is where the route
    enters the junction; None if no route passes it."""
    x, y, _ = junction.node
    passages = () if (driven := route_of(route)) is None else driven.passages
    s = next((each.start for each in passages if each.entered.node == junction.node), None)
    return Finding(rule, f"at {name_of(junction)}: {what}", s, x, y)


def road_finding(
    rule: str, route: Road | None, member: NetworkRoad, s: float, what: str, stops: bool = False
) -> Finding:
    """Returns the Finding that something, ``what``, is wrong at station ``s`` (m) of a road. Its station is
    measured along the route; None if the road is not on the route. The place of a single road is its station
    alone."""
    with np.errstate(invalid="ignore", over="ignore"):  # a number of the road may not be finite
        x, y, _ = member.road.at(s).tolist()
    along = station_on(route, member, s)
    where = f"on road {member.id}" if along is None else f"at s = {along:.0f} m"
    near = ""
    if single_road(route) is None and math.isfinite(x) and math.isfinite(y):
        near = f", near ({x:.0f}, {y:.0f})"
    return Finding(rule, f"{where}{near}: {what}", along, x, y, stops)


def station_on(route: Road | None, member: NetworkRoad, s: float) -> float | None:
    """Returns the distance in metres along a route to station ``s`` of a road, where the route first uses it;
    None if the road is not on the route."""
    if (driven := route_of(route)) is None:
        return None if route is None else s
    for start, leg in zip(driven.starts, driven.legs, strict=False):
        if leg.road == member.id:
            return start + (s if member.profile.leads_along(leg.lane) else member.road.length - s)
    return None


def name_of(junction: Junction) -> str:
    """Returns the name of a junction with its place, such as "the crossroads near (120, 125)"."""
    x, y, _ = junction.node
    return f"the {NAMES[junction.kind][0]} near ({x:.0f}, {y:.0f})"


def owner_of(network: Network, member: NetworkRoad) -> str:
    """Returns the name of the junction or roundabout that contains a road; otherwise that of the road."""
    if member.junction is not None:
        return name_of(network.junction(member.junction))
    ring = network.roundabout_of.get(member.id)
    return f"road {member.id}" if ring is None else name_of(network.junction(ring.junctions[0]))
