"""The default designer: finds roads, routes through junctions, and maps by random drafts.

See ``design.road_search`` for roads, and ``design.network_search`` for routes and maps; the latter is loaded
only where it is used."""

from collections.abc import Sequence

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.design.road_search import DraftSearch
from roadgpt.design.variety import Shapes
from roadgpt.errors import DesignError
from roadgpt.ground.given import GivenGround
from roadgpt.road import Design, World

DRAFTS_ON_LAND = 5  # drafts for which a place on given land is sought


class Planner:
    """The default designer: tries random drafts until one is accepted."""

    makes_junctions = True

    def __init__(self) -> None:
        self._shapes = Shapes()

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> Design:
        """Returns a valid Design that meets the Brief; a road
        differs from the earlier designs as far as possible; for networks, these are ignored. Only the number
        of notes matters, because this number changes the seed. For errors see ``roadgpt.draft``."""
        rng = np.random.default_rng([seed, len(notes)])
        given = world.site.ground
        if brief.is_of_network:
            if isinstance(given, GivenGround):
                raise DesignError("networks are not laid on given land yet; leave --ground out")
            from roadgpt.design.network_search import draft_network

            return draft_network(brief, world, rng)
        for left in reversed(range(DRAFTS_ON_LAND if isinstance(given, GivenGround) else 1)):
            design, road = DraftSearch(brief, world, self._shapes.of(earlier), rng).run()
            if isinstance(given, GivenGround):
                from roadgpt.design.on_land import placed

                try:
                    design = placed(design, brief, world, given.relief)
                except DesignError:
                    if not left:
                        raise
                    continue
            break
        self._shapes.remember(design, road)
        return design
