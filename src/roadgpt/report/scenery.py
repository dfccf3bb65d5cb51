"""The road seen from above, to scale: verge, carriageway, edge lines, centre dashes."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from roadgpt.road import Road, World

Array = NDArray[np.float64]

GROUND, VERGE, ASPHALT, PAINT = "#eef1ea", "#dcd9c3", "#b9bdc3", "#ffffff"
MOST_STATIONS = 1500
FINEST = 0.5  # m
DASH, GAP = 3.0, 6.0  # m, of the centre line


@dataclass(frozen=True)
class Frame:
    """What a picture shows of the plane, metres."""

    x0: float
    x1: float
    y0: float
    y1: float

    @classmethod
    def around(cls, points: Array, margin: float, shape: float, least: float) -> "Frame":
        """The smallest frame of a shape (width over height) around points ``(n, 2)`` and a margin."""
        low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
        width, height = np.maximum(high - low, least)
        width, height = max(width, height * shape), max(height, width / shape)
        x, y = (low + high) / 2
        return cls(x - width / 2, x + width / 2, y - height / 2, y + height / 2)

    @property
    def width(self) -> float:
        """Metres."""
        return self.x1 - self.x0


def stations_of(road: Road) -> Array:
    """Stations close enough for smooth edges, both ends included."""
    count = int(np.clip(road.length / FINEST, 2, MOST_STATIONS))
    return np.linspace(0.0, road.length, count + 1)


def draw_road(axes: Axes, road: Road, world: World) -> None:
    """Verge, carriageway and paint of a road."""
    s = stations_of(road)
    half = world.lane_width
    if world.verge:
        _ribbon(axes, road, s, half + world.verge, VERGE, 1)
    _ribbon(axes, road, s, half, ASPHALT, 2)
    for side in (-half, half):
        edge = road.at(s, side)
        axes.plot(edge[:, 0], edge[:, 1], color=PAINT, lw=1.1, zorder=3, solid_capstyle="butt")
    starts = np.arange(0.0, road.length, DASH + GAP)
    ends = np.minimum(starts + DASH, road.length)
    dashes = np.stack([road.at(v)[:, :2] for v in np.linspace(starts, ends, 4)], axis=1)
    axes.add_collection(LineCollection(list(dashes), colors=PAINT, linewidths=1.1, zorder=3))


def _ribbon(axes: Axes, road: Road, s: Array, half: float, colour: str, layer: int) -> None:
    outline = np.concatenate([road.at(s, half), road.at(s[::-1], -half)])[:, :2]
    axes.add_patch(Polygon(outline, closed=True, fc=colour, ec="none", zorder=layer))


def draw_ends(axes: Axes, road: Road, world: World) -> None:
    """A green bar where the road starts and a chequered one where it ends."""
    half = world.lane_width
    for s, colours in ((0.0, ("#1b1e23",)), (road.length, ("#1b1e23", "white"))):
        across = road.at(np.full(9, s), np.linspace(-half, half, 9))[:, :2]
        pairs = np.stack([across[:-1], across[1:]], axis=1)
        shades = [colours[i % len(colours)] for i in range(len(pairs))]
        axes.add_collection(LineCollection(list(pairs), colors=shades, linewidths=3.2, zorder=5))
