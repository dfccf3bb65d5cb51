"""Computes how large a map has to be for the route of a description."""

from collections import Counter
from functools import lru_cache
from math import inf

import numpy as np

from roadgpt.brief.amount import span
from roadgpt.brief.junctions import LANE_KINDS, RAMPS
from roadgpt.brief.mirror import mirrored
from roadgpt.brief.model import Brief
from roadgpt.design.advice import larger_map, main_reason
from roadgpt.design.lane_draft import drawn_ramp
from roadgpt.design.network_search import FOR_ROOM, NetworkSearch
from roadgpt.errors import DesignError, RoadGPTError
from roadgpt.network.lane_design import ACCELERATION
from roadgpt.network.ramps import length_at_ramp
from roadgpt.road import World

TRIED = 40  # drafts in each search that tests whether a map is large enough
TRIALS = (1, 2)  # seeds of these searches
USUAL_ROAD = 90.0  # m, assumed length of a road whose length is not required
DIAGONAL = 1.25  # greatest length of a straight route, as a multiple of the side of the map
WINDING = 3.5  # greatest length of a route with turns, as a multiple of the side of the map
EDGES = 40.0  # m, kept free at the edges of the map


@lru_cache(maxsize=256)
def room_for_route(brief: Brief, world: World) -> float | None:
    """Returns the side in metres of a map that is large enough for the required route.

    Returns None if the World's map is large enough, or if no larger map would help.
    """
    brief = mirrored(brief) if brief.left_hand else brief  # drafts are made with traffic on the right
    likely = _likely_room(brief)
    try:
        failed = _failed(brief, world) if likely <= world.site.map_size else None
        if likely <= world.site.map_size and (failed is None or main_reason(failed) not in FOR_ROOM):
            return None
        return larger_map(brief, world, route_fits, likely)
    except RoadGPTError:  # the design itself refuses what cannot be built, with its reason
        return None


def route_fits(brief: Brief, world: World) -> bool:
    """Returns whether each of two short searches with different seeds finds a route."""
    return _failed(brief, world) is None


def _failed(brief: Brief, world: World) -> Counter[str] | None:
    """Returns why the drafts of the first short search that finds no route failed; None if all find one."""
    for seed in TRIALS:
        search = NetworkSearch(brief, world, np.random.default_rng(seed))
        try:
            search.run(TRIED)
        except DesignError:
            return search.failed
    return None


def _likely_room(brief: Brief) -> float:
    """Returns the side in metres of a square that a route may just fit into."""
    total = _least(brief)
    for road in brief.roads:
        total += _least(road)
    return max(_straightest(brief) / DIAGONAL + EDGES, total / WINDING)


def _straightest(brief: Brief) -> float:
    """Returns the length in metres of the longest part of a route that must be nearly straight.

    Such parts are straights of required length, and roads joined by ramps or by places where lanes change.
    """
    longest, run = 0.0, 0.0
    for n, road in enumerate(brief.roads):
        place = brief.junctions[n - 1] if n else None
        if place is None or place.kind not in (*RAMPS, *LANE_KINDS):
            run = 0.0
        elif place.kind in RAMPS:
            run += length_at_ramp(drawn_ramp(place, ACCELERATION))
        run += _least(road) or USUAL_ROAD
        straights = [span(each.length).lo for each in road.clauses if each.kind == "straight"]
        straights += [_least(road)] if road.turns is not None and span(road.turns).hi == 0 else []
        is_beside = place is not None and place.kind in (*RAMPS, *LANE_KINDS)
        longest = max(longest, run if is_beside else 0.0, *(s for s in straights if s < inf), 0.0)
    return longest


def _least(brief: Brief) -> float:
    """Returns the length in metres that is required at least; 0 if none is."""
    low = span(brief.length).lo
    return low if 0 < low < inf else 0.0
