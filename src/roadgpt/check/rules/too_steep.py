"""Requires grades of at most 15 % outside junctions, uphill and downhill, everywhere and over every 10 m.

The limit is that of the prompt in the RoadGPT thesis. The code of the thesis checked only uphill grades,
averaged over blocks of ten nodes, so it accepted a road with a downhill grade of 60 %."""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.extremes import steepest
from roadgpt.check.finding import Finding, road_finding
from roadgpt.geometry import GradeProfile
from roadgpt.network import Network
from roadgpt.road import Road, World

WINDOW = 10.0  # m
ROUNDING = 1e-6  # ratio


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports, of each road whose grade exceeds the limit, the middle of the steepest 10 m or, if their mean
    grade satisfies the limit, the steepest point."""
    found, limit = [], world.limits.max_grade
    for member in network.plain_roads:
        road = member.road
        if isinstance(road.elevation, GradeProfile) and max(map(abs, road.elevation.grades)) <= limit:
            continue  # the grade changes linearly between the stations of the profile
        for (s, grade), over in ((_over_a_window(road), f" over {WINDOW:.0f} m"), (steepest(road), "")):
            if abs(grade) > limit + ROUNDING:
                way = "uphill" if grade > 0 else "downhill"
                what = f"grade {100 * abs(grade):.1f} % {way}{over} is steeper than {100 * limit:g} %"
                found.append(road_finding("too_steep", route, member, s, what))
                break
    return tuple(found)


def _over_a_window(road: Road) -> tuple[float, float]:
    """Returns the middle and the mean grade of the steepest 10 m, or of the whole road if it is shorter."""
    samples = road.sample()
    step = max(float(samples.s[1] - samples.s[0]), ROUNDING)
    width = min(max(1, round(WINDOW / step)), len(samples.s) - 1)
    means = (samples.z[width:] - samples.z[:-width]) / (width * step)
    worst = int(np.abs(means).argmax())
    return float(samples.s[worst + width // 2]), float(means[worst])
