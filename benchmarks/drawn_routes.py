"""Routes and maps drawn from the grammars that readers are trained with: mixed kinds, lanes, ramps, signs,
grades and lengths, every tenth with traffic on the left."""

import sys
from collections import Counter
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.design.room import world_for
from roadgpt.errors import BriefError, DesignError
from roadgpt.network import Route, made_from
from roadgpt.road import World

sys.path.insert(0, str(Path(__file__).parents[1] / "training"))
from roadgpt_training.routes import draw_route

LANGUAGES = ("en", "de", "fr", "es", "it")
LEFT_HAND = 10  # of so many routes, one keeps to the left


class DrawnRoute(NamedTuple):
    """A route through a network, its plan, and the world with a map that holds it."""

    plan: str
    route: Route
    world: World


def drawn_routes(number: int, seed: int, refused: Counter[str] | None = None) -> Iterator[DrawnRoute]:
    """Yields this many routes, always the same for a seed; counts in ``refused`` the reasons of others."""
    rng = np.random.default_rng(seed)
    made = 0
    for n in count():
        pair = draw_route(LANGUAGES[n % len(LANGUAGES)], rng)
        if pair is None or pair.plan.startswith("!"):
            continue
        brief = read_plan(pair.plan)
        is_left = made % LEFT_HAND == LEFT_HAND - 1
        brief = brief.model_copy(update={"left_hand": True}) if is_left else brief
        try:
            world = world_for(brief, World())
            route = made_from(draft(brief, world, seed=n), world)
        except (BriefError, DesignError) as error:
            if refused is not None:
                refused[str(error)] += 1
            continue
        if not isinstance(route, Route):
            continue
        yield DrawnRoute(pair.plan, route, world)
        made += 1
        if made == number:
            return
