"""Draws maps of roads for tests: grids, and junctions of all kinds that are joined by roads."""

from functools import cache

import numpy as np

from roadgpt.brief.plan import read_plan
from roadgpt.design.network_search import MapSearch
from roadgpt.network import Route, build_route
from roadgpt.road import Design, Site, World

WORLD = World(site=Site(map_size=400))
PLANS = (
    "map columns=2 rows=1 stop",
    "map crossroads x2; roundabout lights",
    "map columns=3 rows=2",
    "map t_junction x2; y_junction priority",
    "map columns=1 rows=1",
    "map star; roundabout; t_junction yield",
    "map junction x4",
    "map columns=2 rows=2 len=70 lights",
)


@cache
def random_map(seed: int) -> Design:
    """Returns a map; the same seed gives the same map."""
    brief = read_plan(PLANS[seed % len(PLANS)])
    return MapSearch(brief, WORLD, np.random.default_rng(seed)).run()


@cache
def map_route(seed: int) -> Route:
    """Returns the route of a random map."""
    return build_route(random_map(seed), WORLD)
