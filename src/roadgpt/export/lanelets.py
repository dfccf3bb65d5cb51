"""Divides the two lanes of a road into lanelets, for formats that describe roads as chains of lanelets.

The two lanelets of a pair lie side by side and share the line between them. Consecutive pairs share their end
points.
"""

from dataclasses import dataclass

import numpy as np

from roadgpt.export.edges import lines, stations
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World

LENGTH = 50.0  # m, of a section, about
DECIMALS = 4  # of a metre


@dataclass(frozen=True, eq=False)
class LaneletPair:
    """The bounds of both lanes between two stations, as polylines ``(n, 3)`` in metres along the road."""

    start: float
    end: float
    right: Array
    middle: Array
    left: Array


def lanelet_pairs(road: Road, world: World) -> list[LaneletPair]:
    """Returns one or more pairs of lanelets, from the start of the road to its end.

    Raises:
        ExportError: The road has a number that is not finite.
    """
    fine = stations(road, world.profile_of(road).paved_reach)
    count = max(1, round(road.length / LENGTH))
    cuts = np.linspace(0.0, road.length, count + 1)
    out = []
    for start, end in zip(cuts.tolist(), cuts[1:].tolist(), strict=False):
        s = np.r_[start, fine[(fine > start + 1e-3) & (fine < end - 1e-3)], end]
        edges = world.profile_of(road).edges(s)
        made = lines(road, s, (edges.right, 0.0, edges.left))
        right, middle, left = (np.round(each, DECIMALS) + 0.0 for each in made)
        out.append(LaneletPair(start, end, right, middle, left))
    return out
