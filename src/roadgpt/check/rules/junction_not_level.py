"""Requires the roads at a junction to lie in one plane.

At both ends of a connecting road, the heights of road and arm must agree within 1 mm. All ends of arms at the
junction and all points of the connecting roads must lie within 1 mm of one plane. The grade of each road
there must agree within 0.1 % with the slope of this plane in the direction of the road. Otherwise there would
be steps where roads overlap inside a junction."""

import math

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, junction_finding
from roadgpt.check.footprint import EndPose, footprint
from roadgpt.geometry import GradeProfile
from roadgpt.network import Junction, Network, RoadEnd
from roadgpt.road import Road, World

MOST = 1e-3  # m, largest step in height
MOST_GRADE = 1e-3  # ratio, largest difference between the grades of a road and of the plane


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports each junction at which heights differ or roads do not lie in one plane."""
    found = []
    for junction in network.junctions:
        what = _step(network, junction) or _unevenness(network, junction)
        if what is not None:
            found.append(junction_finding("junction_not_level", route, junction, what))
    return tuple(found)


def _step(network: Network, junction: Junction) -> str | None:
    ends = footprint(network).ends
    for each in junction.connections:
        pairs = ((each.incoming, RoadEnd(each.road, "start")), (each.outgoing, RoadEnd(each.road, "end")))
        for arm, own in pairs:
            step = abs(ends[arm].z - ends[own].z)
            if step > MOST:
                return (
                    f"the heights of roads {arm.road} and {own.road} differ by {step:.3f} m where they are "
                    "joined; give both the same height there"
                )
    return None


def _unevenness(network: Network, junction: Junction) -> str | None:
    poses = _poses(network, junction)
    if max(pose.z for pose in poses) - min(pose.z for pose in poses) <= MOST and not any(
        abs(pose.grade) > MOST_GRADE for pose in poses
    ):
        return None
    x, y, z, heading, grade = np.array(poses).T
    x, y, z = x - x.mean(), y - y.mean(), z - z.mean()
    plane = np.linalg.lstsq(np.stack((x, y), axis=1), z, rcond=None)[0]
    heights = np.abs(z - plane[0] * x - plane[1] * y)
    grades = np.abs(grade - plane[0] * np.cos(heading) - plane[1] * np.sin(heading))
    if heights.max() > MOST:
        return f"its roads are up to {heights.max():.3f} m above or below a plane; let them meet in one plane"
    if grades.max() > MOST_GRADE:
        steep = f"the grade of a road differs by {100 * float(grades.max()):.1f} % from that of the others"
        return f"{steep}; let them meet in one plane"
    return None


def _poses(network: Network, junction: Junction) -> list[EndPose]:
    """Returns the poses of all arms at the junction and of all connecting roads at their ends and, where a
    connecting road is not level, between them."""
    ends = footprint(network).ends
    found = [ends[arm.end] for arm in junction.arms]
    for each in junction.connections:
        found += [ends[RoadEnd(each.road, "start")], ends[RoadEnd(each.road, "end")]]
        road = network.road(each.road).road
        heights = road.elevation
        if isinstance(heights, GradeProfile) and not any(heights.grades):
            continue
        s = np.linspace(0.0, road.length, max(3, math.ceil(road.length)))[1:-1]
        rows = np.column_stack((road.at(s), road.heading(s), road.grade(s)))
        found += [EndPose(*row) for row in rows.tolist()]
    return found
