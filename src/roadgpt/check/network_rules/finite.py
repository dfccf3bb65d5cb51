"""Requires all coordinates, headings, curvatures, grades and widths of a network to be finite."""

import math

from roadgpt.check.finding import Finding, road_finding
from roadgpt.check.rules.finite import missing_number
from roadgpt.geometry import CubicProfile, GradeProfile, PieceCurve
from roadgpt.network import Network, NetworkRoad, Route
from roadgpt.road import World


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports the first road that has a number which is not finite."""
    for member in network.roads:
        if math.isfinite(_sum(member)):
            continue
        s, what = missing_number(member.road) or (0.0, "the width of a lane is not a number")
        if s is None:
            return (Finding("finite", f"on road {member.id}: {what}", stops=True),)
        return (road_finding("finite", route, member, s, what, stops=True),)
    return ()


def _sum(member: NetworkRoad) -> float:
    plan, heights, profile = member.road.plan, member.road.elevation, member.profile
    assert isinstance(plan, PieceCurve)
    found = plan.x + plan.y + plan.heading0
    found += sum(piece.length + piece.k0 + piece.k1 for piece in plan.pieces)
    if isinstance(heights, GradeProfile):
        found += heights.z0 + sum(heights.stations) + sum(heights.grades)
    for lane in (*profile.left, *profile.right):
        if isinstance(lane.width, CubicProfile):
            found += sum(map(sum, lane.width.coefficients))
        else:
            found += lane.width
    return found
