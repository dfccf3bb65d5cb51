"""Drafts networks: routes through junctions, and maps of roads. Single roads do not need these rooms."""

import numpy as np

from roadgpt.brief.mirror import mirrored
from roadgpt.brief.model import Brief
from roadgpt.design.map_search import MapSearch, room_for_map
from roadgpt.design.network_search import NetworkSearch
from roadgpt.design.route_room import room_for_route
from roadgpt.network import MapDesign, NetworkDesign
from roadgpt.road import World


def draft_network(brief: Brief, world: World, rng: np.random.Generator) -> NetworkDesign | MapDesign:
    """Returns a valid route, or a valid map if the Brief has one, that meets the Brief.

    Args:
        brief: the requirements.
        world: size of the map, and limits that the rules check.
        rng: random number generator.

    Raises:
        DesignError: no draft was accepted; the message says which requirement failed, and what to do.
        BriefError: a junction cannot meet its requirements.
        UsageError: the World has lanes or banked bends that a map of roads cannot have.
    """
    search = NetworkSearch if brief.map is None else MapSearch
    if not brief.left_hand:
        return search(brief, world, rng).run()
    # traffic on the left is the mirror image of traffic on the right
    return search(mirrored(brief), world, rng).run().mirrored(world.site.map_size / 2)


def room_for_network(brief: Brief, world: World) -> float | None:
    """Returns the side in metres of a map that is large enough for a network; None if the World's map is."""
    return room_for_route(brief, world) if brief.map is None else room_for_map(brief, world)
