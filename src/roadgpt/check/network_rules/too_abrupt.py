"""Requires crests and dips to cause a vertical acceleration of the car of at most 3 m/s^2.

The limit and the expected speed are those of the rule for single roads. The route is checked as one road, so
the turns at its junctions limit the speed. On every other road the car starts from rest."""

from roadgpt.check.finding import Finding, road_finding
from roadgpt.check.rules.too_abrupt import abrupt_place
from roadgpt.check.rules.too_abrupt import inspect as inspect_road
from roadgpt.geometry import GradeProfile
from roadgpt.network import Network, Route
from roadgpt.road import World


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports the crest or dip that exceeds its limit most, on the route and on each other road."""
    found = [] if route is None else [*inspect_road(route, None, world)]
    driven = set() if route is None else {leg.road for leg in route.legs}
    for member in network.plain_roads:
        heights = member.road.elevation
        if member.id in driven or (isinstance(heights, GradeProfile) and not any(heights.grades)):
            continue
        if (abrupt := abrupt_place(member.road, None, world)) is not None:
            found.append(road_finding("too_abrupt", route, member, *abrupt))
    return tuple(found)
