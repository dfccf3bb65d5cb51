"""Requires all coordinates, headings, curvatures, grades and widths of the roads to be finite."""

import math
from dataclasses import replace

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, road_finding, single_road
from roadgpt.geometry import CubicProfile, GradeProfile, PieceCurve
from roadgpt.network import Network
from roadgpt.road import Road, World


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the first place where a number of a road is not finite."""
    is_single = single_road(route) is not None
    for member in network.roads:
        found = None if math.isfinite(_sum(member.road)) else missing_number(member.road)
        if found is None:
            widths = [lane.width for lane in (*member.profile.left, *member.profile.right)]
            numbers = (sum(map(sum, w.coefficients)) if isinstance(w, CubicProfile) else w for w in widths)
            if math.isfinite(sum(numbers)):
                continue
            found = 0.0, "the width of a lane is not a number"
        s, what = found
        if s is None:
            where = "" if is_single else f"on road {member.id}: "
            return (Finding("finite", where + what, stops=True),)
        told = road_finding("finite", route, member, s, what, stops=True)
        return (replace(told, x=None, y=None) if is_single else told,)
    return ()


def _sum(road: Road) -> float:
    """Returns a number that is finite if all numbers of the road are; NaN for a spline."""
    plan, heights = road.plan, road.elevation
    if not isinstance(plan, PieceCurve):
        return math.nan
    found = plan.x + plan.y + plan.heading0
    found += sum(piece.length + piece.k0 + piece.k1 for piece in plan.pieces)
    if isinstance(heights, GradeProfile):
        found += heights.z0 + sum(heights.stations) + sum(heights.grades)
    return found


def missing_number(road: Road) -> tuple[float | None, str] | None:
    """Returns the first station in metres where a quantity is not finite, and a text that names the first
    such quantity; None if all are finite. The station is None if the length of the road is not finite."""
    if not np.isfinite(road.length):
        return None, "the length of the road is not a number"
    with np.errstate(invalid="ignore", over="ignore"):  # such values are found below
        samples = road.sample()
    for name in ("x", "y", "z", "heading", "curvature", "grade"):
        bad = np.flatnonzero(~np.isfinite(getattr(samples, name)))
        if bad.size:
            return float(samples.s[bad[0]]), f"{name} is not a number"
    return None
