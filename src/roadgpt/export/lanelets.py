"""The two lanes in sections end to end, for formats that know roads as chains of short lanes.

Both lanes of a section share the line between them, and neighbours share the points in which they meet.
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
    """Polylines ``(n, 3)`` of one section in the direction of the road, in metres."""

    start: float
    end: float
    right: Array
    middle: Array
    left: Array


def lanelet_pairs(road: Road, world: World) -> list[LaneletPair]:
    """The sections from the road's start to its end, at least one.

    Raises:
        ExportError: the road has a number that is not finite.
    """
    wide = world.lane_width
    fine = stations(road, wide)
    count = max(1, round(road.length / LENGTH))
    cuts = np.linspace(0.0, road.length, count + 1)
    out = []
    for start, end in zip(cuts.tolist(), cuts[1:].tolist(), strict=False):
        s = np.r_[start, fine[(fine > start + 1e-3) & (fine < end - 1e-3)], end]
        right, middle, left = (np.round(each, DECIMALS) + 0.0 for each in lines(road, s, (-wide, 0.0, wide)))
        out.append(LaneletPair(start, end, right, middle, left))
    return out
