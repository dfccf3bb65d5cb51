"""Lines of sight over land: whether hills, cuttings and walls of tunnels hide a point, and how far along a
road its driver sees."""

import math
from typing import NamedTuple

import numpy as np

from roadgpt.compiled import compiled, inlined
from roadgpt.geometry.curve import Array
from roadgpt.ground import grading
from roadgpt.ground.ground import Ground

EYE, OBJECT = 1.08, 0.60  # m above the road (AASHTO Green Book 3.2.6: eye of a car's driver, tail lights)
GRAZING = 0.05  # m of land above a line of sight that hide nothing: less than the grid tells
FARTHEST = 400.0  # m, along the road


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


@compiled
def sight_distances(horizon: Horizon, points: Array, step: float) -> Array:
    """Returns how far in metres a driver sees an object on the road from each of its points ``(n, 3)``, which
    lie ``step`` metres apart in the middle of the lane; infinite where it is seen to the end, and FARTHEST
    at most otherwise."""
    found = np.full(len(points), np.inf)
    for n in range(len(points)):
        for m in range(n + 1, len(points)):
            far = (m - n) * step
            if far > FARTHEST:
                found[n] = FARTHEST
                break
            if is_behind_land(
                horizon, points[n, 0], points[n, 1], points[n, 2] + EYE,
                points[m, 0], points[m, 1], points[m, 2] + OBJECT,
            ):  # fmt: skip
                found[n] = far - step
                break
    return found
