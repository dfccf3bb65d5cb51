"""Requires grades of at most 15 %, uphill and downhill, at every place and over every 10 m.

The limit is that of the prompt in the RoadGPT thesis. The code of the thesis checked only uphill grades,
averaged over blocks of ten nodes, so it accepted a road with a downhill grade of 60 %."""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.extremes import steepest
from roadgpt.check.finding import Finding, findings_at
from roadgpt.road import Road, World

WINDOW = 10.0  # m
ROUNDING = 1e-6  # ratio


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the steepest place of the road if its grade exceeds the limit."""
    return findings_at("too_steep", road, steep_place(road, world))


def steep_place(road: Road, world: World) -> tuple[float, str] | None:
    """Returns the middle of the steepest 10 m or, if their mean grade satisfies the limit, the station of the
    steepest point, and what is wrong there; None if the rule is met."""
    for (s, grade), over in ((_over_a_window(road), f" over {WINDOW:.0f} m"), (steepest(road), "")):
        if abs(grade) > world.limits.max_grade + ROUNDING:
            way = "uphill" if grade > 0 else "downhill"
            limit = f"steeper than {100 * world.limits.max_grade:g} %"
            return s, f"grade {100 * abs(grade):.1f} % {way}{over} is {limit}"
    return None


def _over_a_window(road: Road) -> tuple[float, float]:
    """Returns the middle and the mean grade of the steepest 10 m, or of the whole road if it is shorter."""
    samples = road.sample()
    step = max(float(samples.s[1] - samples.s[0]), ROUNDING)
    width = min(max(1, round(WINDOW / step)), len(samples.s) - 1)
    means = (samples.z[width:] - samples.z[:-width]) / (width * step)
    worst = int(np.abs(means).argmax())
    return float(samples.s[worst + width // 2]), float(means[worst])
