"""The default designer: finds roads and routes through junctions by random drafts.

See ``design.road_search`` for roads, and ``design.network_search`` for routes.
"""

from collections.abc import Sequence

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.design.network_search import NetworkSearch
from roadgpt.design.road_search import DraftSearch
from roadgpt.design.variety import Shapes
from roadgpt.network import NetworkDesign
from roadgpt.road import Design, World


class Planner:
    """The default designer: tries random drafts until one is accepted."""

    makes_junctions = True

    def __init__(self) -> None:
        self._shapes = Shapes()

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> Design | NetworkDesign:
        """Returns a Design that meets the Brief and is valid; with junctions if the Brief has some.

        Args:
            brief: the requirements for the road.
            world: size of the map, and limits that the rules check, such as the steepest grade.
            notes: sentences about an earlier draft; only their number matters, as it changes the seed.
            earlier: designs of the campaign so far; the new one differs from them as far as possible.
            seed: seed of the random number generator.

        Raises:
            DesignError: no draft was accepted; the message says which requirement failed, and what to do.
        """
        rng = np.random.default_rng([seed, len(notes)])
        if brief.junctions:
            return NetworkSearch(brief, world, rng).run()
        design, road = DraftSearch(brief, world, self._shapes.of(earlier), rng).run()
        self._shapes.remember(design, road)
        return design
