"""Requires 2 to 500 control points of a single road; consecutive ones must not coincide in plan.

Source: the SBFT competition's limits on ``road_points``. Its spline cannot pass through the same point twice
in a row."""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, single_road
from roadgpt.network import Network
from roadgpt.road import Road, World

FEWEST, MOST = 2, 500  # SBFT validator


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports too few or too many control points, or the first two neighbours that coincide in plan."""
    road = single_road(route)
    if road is None:
        return ()
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
