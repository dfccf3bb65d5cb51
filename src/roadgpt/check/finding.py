"""Defines the Finding: one violation of a rule by a road."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from roadgpt.brief.junctions import NAMES
from roadgpt.network import Junction, Network, NetworkRoad, Route
from roadgpt.road import Road


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


def findings_at(rule: str, road: Road, place: tuple[float, str] | None) -> tuple[Finding, ...]:
    """Returns the Finding for a station in metres and what is wrong there; no Finding for None."""
    if place is None:
        return ()
    s, what = place
    x, y, _ = (float(v) for v in road.at(s))
    return (Finding(rule, f"at s = {s:.0f} m: {what}", s, x, y),)


ROUNDING = 1e-9  # m


def junction_finding(rule: str, route: Route | None, junction: Junction, what: str) -> Finding:
    """Returns the Finding that something, ``what``, is wrong at a junction. Its station is where the route
    enters the junction; None if no route passes it."""
    x, y, _ = junction.node
    s = None
    if route is not None:
        s = next((each.start for each in route.passages if each.entered.node == junction.node), None)
    return Finding(rule, f"at {name_of(junction)}: {what}", s, x, y)


def road_finding(
    rule: str, route: Route | None, member: NetworkRoad, s: float, what: str, stops: bool = False
) -> Finding:
    """Returns the Finding that something, ``what``, is wrong at station ``s`` (m) of a road. Its station is
    measured along the route; None if the road is not on the route."""
    with np.errstate(invalid="ignore", over="ignore"):  # a number of the road may not be finite
        x, y, _ = member.road.at(s).tolist()
    along = station_on(route, member, s)
    where = f"on road {member.id}" if along is None else f"at s = {along:.0f} m"
    near = f", near ({x:.0f}, {y:.0f})" if math.isfinite(x) and math.isfinite(y) else ""
    return Finding(rule, f"{where}{near}: {what}", along, x, y, stops)


def bends_below(
    rule: str,
    network: Network,
    route: Route | None,
    least: float,
    what: str,
    radii_at: Callable[[Network, Junction], Iterable[float]],
) -> tuple[Finding, ...]:
    """Returns a Finding for each junction or roundabout with a bend below ``least`` metres. ``what`` names
    the line and has a ``{}`` for its radius. ``radii_at`` gives the radii at a junction, with traffic on the
    right."""
    found = []
    seen = network.right_hand
    for _, junctions in network.nodes:
        radii = (radius for each in junctions for radius in radii_at(seen, seen.junction(each.id)))
        radius = min(radii, default=least)
        if radius < least - ROUNDING:
            wanted = "give the island" if junctions[0].kind == "roundabout" else "ask for a kerb with"
            advice = f"{wanted} a larger radius or turn the arms apart"
            told = f"{what.format(radius)}, tighter than {least:g} m; {advice}"
            found.append(junction_finding(rule, route, junctions[0], told))
    return tuple(found)


def station_on(route: Route | None, member: NetworkRoad, s: float) -> float | None:
    """Returns the distance in metres along a route to station ``s`` of a road, where the route first uses it;
    None if the road is not on the route."""
    if route is None:
        return None
    for start, leg in zip(route.starts, route.legs, strict=False):
        if leg.road == member.id:
            return start + (s if member.profile.leads_along(leg.lane) else member.road.length - s)
    return None


def station_near(route: Route | None, member: NetworkRoad, x: float, y: float) -> float | None:
    """Returns the result of ``station_on`` for the place on a road that is nearest to (x, y)."""
    if station_on(route, member, 0.0) is None:
        return None
    return station_on(route, member, float(member.road.locate(x, y)[0]))


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
