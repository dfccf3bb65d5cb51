"""The default designer: finds roads, routes through junctions, and maps by random drafts.

See ``design.road_search`` for roads, ``design.network_search`` for routes, and ``design.map_search`` for
maps.
"""

from collections.abc import Sequence

import numpy as np

from roadgpt.brief.mirror import mirrored
from roadgpt.brief.model import Brief
from roadgpt.design.map_search import MapSearch
from roadgpt.design.network_search import NetworkSearch
from roadgpt.design.road_search import DraftSearch
from roadgpt.design.variety import Shapes
from roadgpt.errors import DesignError
from roadgpt.network import AnyDesign
from roadgpt.road import Design, World
from roadgpt.road.profile_json import ONLY_NETWORKS


class Planner:
    """The default designer: tries random drafts until one is accepted."""

    makes_junctions = True

    def __init__(self) -> None:
        self._shapes = Shapes()

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> AnyDesign:
        """Returns a Design that meets the Brief and is valid; with junctions or of a map if the Brief asks.

        Args:
            brief: the requirements for the road.
            world: size of the map, and limits that the rules check, such as the steepest grade.
            notes: sentences about an earlier draft; only their number matters, as it changes the seed.
            earlier: designs of the campaign so far; the new one differs from them as far as possible.
            seed: seed of the random number generator.

        Raises:
            DesignError: no draft was accepted; the message says which requirement failed, and what to do.
        """
        if brief.left_hand:  # traffic on the left is the mirror image of traffic on the right
            found = self.draft(mirrored(brief), world, notes, earlier, seed)
            if isinstance(found, Design):
                raise DesignError(ONLY_NETWORKS)
            return found.mirrored(world.site.map_size / 2)
        rng = np.random.default_rng([seed, len(notes)])
        if brief.map is not None:
            return MapSearch(brief, world, rng).run()
        if brief.junctions:
            return NetworkSearch(brief, world, rng).run()
        design, road = DraftSearch(brief, world, self._shapes.of(earlier), rng).run()
        self._shapes.remember(design, road)
        return design
