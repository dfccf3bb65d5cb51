"""Requires grades of at most 15 % on all roads outside junctions, as the rule for single roads does."""

from roadgpt.check.finding import Finding, road_finding
from roadgpt.check.rules.too_steep import steep_place
from roadgpt.geometry import GradeProfile
from roadgpt.network import Network, Route
from roadgpt.road import World


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports the steepest place of each road whose grade exceeds the limit."""
    found = []
    for member in network.plain_roads:
        heights = member.road.elevation
        if isinstance(heights, GradeProfile) and max(map(abs, heights.grades)) <= world.limits.max_grade:
            continue  # the grade changes linearly between the stations of the profile
        if (steep := steep_place(member.road, world)) is not None:
            found.append(road_finding("too_steep", route, member, *steep))
    return tuple(found)
