"""The default designer: finds roads, routes through junctions, and maps by random drafts.

See ``design.road_search`` for roads, and ``design.network_draft`` for routes and maps; the latter is imported
only where it is used.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.design.road_search import DraftSearch
from roadgpt.design.variety import Shapes
from roadgpt.road import Design, World

if TYPE_CHECKING:
    from roadgpt.network import AnyDesign


class Planner:
    """The default designer: tries random drafts until one is accepted."""

    makes_junctions = True

    def __init__(self) -> None:
        self._shapes = Shapes()

    def draft(
        self, brief: Brief, world: World, notes: tuple[str, ...], earlier: Sequence[Design], seed: int
    ) -> "AnyDesign":
        """Returns a valid Design that meets the Brief; a NetworkDesign or a MapDesign for a network.

        Args:
            brief: the requirements for the road.
            world: size of the map, and limits that the rules check, such as the steepest grade.
            notes: sentences about an earlier draft; only their number matters, as it changes the seed.
            earlier: designs of the campaign so far; the new one differs from them as far as possible. For
                networks, they are ignored.
            seed: seed of the random number generator.

        Raises:
            DesignError: no draft was accepted; the message says which requirement failed, and what to do.
            BriefError: a junction cannot meet its requirements.
            UsageError: the World has lanes or banked bends that a map of roads cannot have.
        """
        rng = np.random.default_rng([seed, len(notes)])
        if brief.is_of_network:
            from roadgpt.design.network_draft import draft_network

            return draft_network(brief, world, rng)
        design, road = DraftSearch(brief, world, self._shapes.of(earlier), rng).run()
        self._shapes.remember(design, road)
        return design
