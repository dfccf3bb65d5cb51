"""Lines of sight over land: whether hills, cuttings and walls of tunnels hide a point."""

import math
from typing import NamedTuple

import numpy as np

from roadgpt.compiled import inlined
from roadgpt.geometry.curve import Array
from roadgpt.ground import grading
from roadgpt.ground.ground import Ground

GRAZING = 0.05  # m of land above a line of sight that hide nothing: less than the grid tells


class Horizon(NamedTuple):
    """What may hide somebody: heights of the ground on a grid, of the road in tunnels and on bridges; without
    any rows, nothing does. Lengths are in metres."""

    heights: Array  # (rows, columns)
    x: float
    y: float
    cell: float


OPEN = Horizon(np.empty((0, 0)), 0.0, 0.0, 1.0)


def horizon_of(ground: Ground) -> Horizon:
    """Returns what hides somebody on a ground."""
    layers, shape = ground.layers, ground.heights.shape
    decks = np.ascontiguousarray(ground.pavement.decks.reshape(-1, 9))
    deck = grading.on_roads(decks, layers.x, layers.y, layers.cell, *shape)
    heights = np.ascontiguousarray(np.where(np.isnan(deck), ground.heights, deck))
    return Horizon(heights, layers.x, layers.y, layers.cell)


@inlined
def is_behind_land(
    horizon: Horizon, ax: float, ay: float, az: float, bx: float, by: float, bz: float
) -> bool:
    """Returns whether land lies between two points."""
    rows, columns = horizon.heights.shape
    if rows == 0:
        return False
    steps = int(math.hypot(bx - ax, by - ay) / horizon.cell)
    for n in range(1, steps):
        share = n / steps
        u = (ax + share * (bx - ax) - horizon.x) / horizon.cell
        v = (ay + share * (by - ay) - horizon.y) / horizon.cell
        i, j = int(u), int(v)
        if i < 0 or j < 0 or i >= columns - 1 or j >= rows - 1:
            continue
        u, v = u - i, v - j
        low = horizon.heights[j, i] * (1.0 - u) + horizon.heights[j, i + 1] * u
        high = horizon.heights[j + 1, i] * (1.0 - u) + horizon.heights[j + 1, i + 1] * u
        if low * (1.0 - v) + high * v > az + share * (bz - az) + GRAZING:
            return True
    return False
