"""How far along a road its driver sees: over crests, and past cuttings, walls and hills."""

import numpy as np

from roadgpt.compiled import compiled
from roadgpt.geometry.curve import Array
from roadgpt.ground.sight import Horizon, horizon_of, is_behind_land
from roadgpt.network.landscape import ground_around
from roadgpt.road import Road, World

EYE, OBJECT = 1.08, 0.60  # m above the road (AASHTO Green Book 3.2.6: eye of a car's driver, tail lights)
FARTHEST = 400.0  # m, along the road


def sight_along(road: Road, world: World, step: float = 5.0) -> tuple[Array, Array]:
    """Returns stations about every ``step`` metres, and how far in metres the driver of the tested car sees
    an object on the road from each of them: infinite where it is seen to the end."""
    road = world.lay(road)
    s = np.linspace(0.0, road.length, max(2, round(road.length / step) + 1))
    points = road.at(s, world.profile_of(road).middle(s))
    horizon = horizon_of(ground_around(road, world))
    return s, sight_distances(horizon, np.ascontiguousarray(points), road.length / (len(s) - 1))


@compiled
def sight_distances(horizon: Horizon, points: Array, step: float) -> Array:
    """Returns how far in metres a driver sees an object on the road from each of its points ``(n, 3)``, which
    lie ``step`` metres apart in the middle of the lane; infinite where it is seen to the end, and FARTHEST
    at most otherwise."""
    found = np.full(len(points), np.inf)
    for n in range(len(points)):
        for m in range(n + 1, len(points)):
            far = (m - n) * step
            if far > FARTHEST:
                found[n] = FARTHEST
                break
            if is_behind_land(
                horizon, points[n, 0], points[n, 1], points[n, 2] + EYE,
                points[m, 0], points[m, 1], points[m, 2] + OBJECT,
            ):  # fmt: skip
                found[n] = far - step
                break
    return found
