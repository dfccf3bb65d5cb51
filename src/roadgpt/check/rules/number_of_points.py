"""The road has 2 to 500 control points, and no two in a row lie at one place in plan.

Source: the SBFT competition's limits on ``road_points``; its spline has no way through a point given twice.
"""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.road import Road, World

FEWEST, MOST = 2, 500  # SBFT validator


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Says how many control points there are, where too few or too many, or which two are one in plan."""
    points = road.control_points()
    if not FEWEST <= len(points) <= MOST:
        sentence = f"the road has {len(points)} points; give {FEWEST} to {MOST}"
        return (Finding("number_of_points", sentence, stops=len(points) < FEWEST),)
    same = np.flatnonzero((np.diff(points, axis=0) == 0).all(axis=1))
    if not same.size:
        return ()
    first = int(same[0])
    x, y = (float(v) for v in points[first])
    sentence = f"points {first + 1} and {first + 2} lie at one place ({x:.0f}, {y:.0f}); move or remove one"
    return (Finding("number_of_points", sentence, x=x, y=y, stops=True),)
