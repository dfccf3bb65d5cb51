"""Requires all coordinates, headings, curvatures and grades of the road to be finite."""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.road import Road, World


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the first station where a coordinate, heading, curvature or grade is not finite."""
    if not np.isfinite(road.length):
        return (Finding("finite", "the length of the road is not a number", stops=True),)
    with np.errstate(invalid="ignore", over="ignore"):  # such values are found below
        samples = road.sample()
    for name in ("x", "y", "z", "heading", "curvature", "grade"):
        bad = np.flatnonzero(~np.isfinite(getattr(samples, name)))
        if bad.size:
            s = float(samples.s[bad[0]])
            return (Finding("finite", f"at s = {s:.0f} m: {name} is not a number", s, stops=True),)
    return ()
