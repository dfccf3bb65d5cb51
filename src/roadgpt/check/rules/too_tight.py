"""Requires all turns to have a radius of at least 14.326 m (47 ft), the limit of the SBFT competition.

The radius is measured twice: on the curve of the road, and as in the competition, where circles are drawn
through nodes of the competition's spline. That spline cuts corners between control points."""

from roadgpt.brief.model import Brief
from roadgpt.check.extremes import tightest
from roadgpt.check.finding import Finding, findings_at
from roadgpt.check.sbft import smallest_radius
from roadgpt.geometry import interpolate
from roadgpt.road import Road, World

ROUNDING = 1e-9  # of the limit


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the tightest place of the road if its radius is below the limit."""
    if found := findings_at("too_tight", road, tight_place(road, world)):
        return found
    nodes = interpolate(road.control_points())
    radius, middle = smallest_radius(nodes)
    if radius >= world.limits.min_radius:
        return ()
    x, y = (float(v) for v in nodes[middle])
    s = float(road.locate(x, y)[0])
    sentence = f"at s = {s:.0f} m: radius {radius:.1f} m, as SBFT measures it on its spline, is "
    sentence += f"tighter than {world.limits.min_radius:.4g} m"
    return (Finding("too_tight", sentence, s, x, y),)


def tight_place(road: Road, world: World) -> tuple[float, str] | None:
    """Returns the station in metres where the curve of the road is tightest, and what is wrong there, if it
    is."""
    s, bend = tightest(road)
    if abs(bend) * world.limits.min_radius <= 1 + ROUNDING:
        return None
    return s, f"radius {1 / abs(bend):.1f} m is tighter than {world.limits.min_radius:.4g} m"
