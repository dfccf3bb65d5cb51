"""Requires all coordinates, headings, curvatures and grades of the road to be finite."""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.road import Road, World


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the first station where a coordinate, heading, curvature or grade is not finite."""
    found = missing_number(road)
    if found is None:
        return ()
    s, what = found
    place = "" if s is None else f"at s = {s:.0f} m: "
    return (Finding("finite", place + what, s, stops=True),)


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
