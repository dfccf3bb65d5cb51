"""Drafts networks (routes through junctions, and maps of roads) and finds how large their maps have to be.
Single roads do not need this module."""

from functools import lru_cache
from math import inf

import numpy as np

from roadgpt.brief.amount import span
from roadgpt.brief.junctions import LANE_KINDS, RAMPS
from roadgpt.brief.model import Brief, mirrored
from roadgpt.design.advice import larger_map
from roadgpt.design.lane_draft import drawn_ramp
from roadgpt.design.map_search import MapSearch, likely_room_of_map
from roadgpt.design.network_search import NetworkSearch
from roadgpt.errors import DesignError, RoadGPTError
from roadgpt.network import MapDesign, NetworkDesign
from roadgpt.network.design import ACCELERATION
from roadgpt.network.ramps import length_at_ramp
from roadgpt.road import World

TRIALS = (1, 2)  # seeds of the short searches that test whether a map is large enough
USUAL_ROAD = 90.0  # m, assumed length of a road whose length is not required
DIAGONAL = 1.25  # greatest length of a straight route, as a multiple of the side of the map
WINDING = 3.5  # greatest length of a route with turns, as a multiple of the side of the map
EDGES = 40.0  # m, kept free at the edges of the map


def draft_network(brief: Brief, world: World, rng: np.random.Generator) -> NetworkDesign | MapDesign:
    """Returns a valid route that meets the Brief, or a valid map of roads if the Brief asks for a map. Raises
    DesignError if no draft was accepted, BriefError if a junction cannot meet its requirements, and
    UsageError if the World has lanes or banked bends that a map of roads cannot have."""
    if not brief.left_hand:
        return _search(brief, world, rng).run()
    # traffic on the left is the mirror image of traffic on the right
    return _search(mirrored(brief), world, rng).run().mirrored(world.site.map_size / 2)


def _search(brief: Brief, world: World, rng: np.random.Generator) -> NetworkSearch | MapSearch:
    return (NetworkSearch if brief.map is None else MapSearch)(brief, world, rng)


@lru_cache(maxsize=256)
def room_for_network(brief: Brief, world: World) -> float | None:
    """Returns the side in metres of a map that is large enough for a network; None if the World's map is
    large enough, or if no larger map would help."""
    if brief.map is not None:
        likely = likely_room_of_map(brief)
    else:
        brief = mirrored(brief) if brief.left_hand else brief  # drafts are made with traffic on the right
        likely = _likely_room_of_route(brief)
    try:
        failed = _failed(brief, world) if likely <= world.site.map_size else None
        if likely <= world.site.map_size and (failed is None or not failed.lacks_room):
            return None
        return larger_map(brief, world, _failed, likely)
    except RoadGPTError:  # the design itself refuses what cannot be built, with its reason
        return None


def _failed(brief: Brief, world: World) -> NetworkSearch | MapSearch | None:
    """Returns the first short search that finds no network; None if all find one."""
    for seed in TRIALS:
        search = _search(brief, world, np.random.default_rng(seed))
        try:
            search.run(search.tried)
        except DesignError:
            return search
    return None


def _likely_room_of_route(brief: Brief) -> float:
    """Returns the side in metres of a square that a route may just fit into."""
    total = sum(map(_least, (brief, *brief.roads)))
    return max(_straightest(brief) / DIAGONAL + EDGES, total / WINDING)


def _straightest(brief: Brief) -> float:
    """Returns the length in metres of the longest part of a route that must be nearly straight: straights of
    required length, and roads joined by ramps or by places where lanes change."""
    longest, run = 0.0, 0.0
    for place, road in zip((None, *brief.junctions), brief.roads, strict=True):
        is_beside = place is not None and place.kind in (*RAMPS, *LANE_KINDS)
        if not is_beside:
            run = 0.0
        elif place is not None and place.kind in RAMPS:
            run += length_at_ramp(drawn_ramp(place, ACCELERATION))
        run += _least(road) or USUAL_ROAD
        straights = [span(each.length).lo for each in road.clauses if each.kind == "straight"]
        straights += [_least(road)] if road.turns is not None and span(road.turns).hi == 0 else []
        longest = max(longest, run if is_beside else 0.0, *(s for s in straights if s < inf), 0.0)
    return longest


def _least(brief: Brief) -> float:
    """Returns the length in metres that is required at least; 0 if none is."""
    low = span(brief.length).lo
    return low if 0 < low < inf else 0.0
