"""Makes the ground around a road: the land that its World asks for, with all roads of its network in it."""

from functools import lru_cache

import numpy as np

from roadgpt.ground.ground import Ground, Pavement
from roadgpt.ground.relief import Kind, Relief, Way, level_land, made
from roadgpt.network.road_or_route import network_of
from roadgpt.network.surface import pavement_of
from roadgpt.road import Road, World

STEP = 2.0  # m between the points of roads that land is made around
USUAL: Kind = "rolling"  # the kind of land in pictures where nothing is asked for


@lru_cache(maxsize=4)
def ground_around(road: Road, world: World) -> Ground:
    """Returns the land with all roads of a road's network in it; always the same for the same arguments.

    Roads without shoulders float above flat land, as in the RoadGPT thesis, unless the World has ground of
    its own."""
    network = network_of(world.lay(road), world)
    lines = [each.road.centreline(STEP) for each in network.roads_outside]
    way = Way(road.centreline(STEP) if road.has_way else np.concatenate(lines), np.concatenate(lines))
    if not (world.has_ground or any(each.profile.has_shoulders for each in network.roads)):
        level = min(world.site.z_floor, float(way.others[:, 2].min()) - 1.0)
        return Ground.of(level_land(way, level), Pavement(np.empty((0, 3, 3)), ()))
    return Ground.of(_land(way, world), pavement_of(network))


def _land(way: Way, world: World) -> Relief:
    lands = world.scene.landscape
    hills: Kind = "hilly" if any(each.kind in ("valley", "ridge") for each in lands) else USUAL
    kind, seed = world.site.made_ground or (hills, 0)
    return made(way, kind, lands, seed)
