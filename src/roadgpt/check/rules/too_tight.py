"""No turn is tighter than 14.326 m (47 ft): the SBFT competition's least radius.

Measured twice: on the curve itself, and as the competition does it, with circles through nodes of its own
spline, which cuts corners between control points.
"""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.check.sbft import smallest_radius
from roadgpt.geometry import interpolate
from roadgpt.road import Road, World

ROUNDING = 1e-9  # of the limit


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Says where the road is tightest, where that is too tight."""
    samples = road.sample()
    bend = np.abs(samples.curvature)
    tightest = int(bend.argmax())
    limit = f"tighter than {world.min_radius:.4g} m"
    if bend[tightest] * world.min_radius > 1 + ROUNDING:
        s, x, y = (float(v[tightest]) for v in (samples.s, samples.x, samples.y))
        sentence = f"at s = {s:.0f} m: radius {1 / bend[tightest]:.1f} m is {limit}"
        return (Finding("too_tight", sentence, s, x, y),)
    nodes = interpolate(road.control_points())
    radius, middle = smallest_radius(nodes)
    if radius >= world.min_radius:
        return ()
    x, y = (float(v) for v in nodes[middle])
    s = float(road.locate(x, y)[0])
    sentence = f"at s = {s:.0f} m: radius {radius:.1f} m, as SBFT measures it on its spline, is {limit}"
    return (Finding("too_tight", sentence, s, x, y),)
