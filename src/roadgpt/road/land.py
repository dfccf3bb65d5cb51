"""Creates the terrain around a road: below the road surface near it, and with gentle hills farther away."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import scipy

from roadgpt.geometry.curve import Array
from roadgpt.road.road import Road

MARGIN = 130.0  # m around the road
FINEST, CELLS = 4.0, 160  # m, smallest cell; number of cells along the longer side at most
FAR = (300.0, 900.0, 2500.0, 7000.0)  # m beyond the margin: further rows and columns up to the horizon
BELOW = 0.35  # m; the land near the road is at least this far below it
LEAST = 40.0  # m, least side of the area without the margin
LONGEST_STEP = 2.0  # m along the road


@dataclass(frozen=True, eq=False)
class Land:
    """Heights of the terrain on a rectangular grid with columns at ``x`` and rows at ``y``, in metres. Rows
    and columns are ``cell`` metres apart, except near the border of the grid, where they are farther apart.
    """

    x: Array
    y: Array
    heights: Array  # heights in metres, of shape (rows, columns)
    away: Array
    """Distance in metres from each grid point to the strip along the road, of shape (rows, columns). In this
    strip, the land follows the height of the road."""
    cell: float

    @classmethod
    def around(
        cls,
        roads: Sequence[Road],
        reach: float | None,
        floor: float,
        wide: Mapping[float, Sequence[Road]] = MappingProxyType({}),
    ) -> "Land":
        """Returns the terrain around roads. Up to ``reach`` metres from their centre lines, the terrain lies
        below the roads; ``wide`` are those of the roads that have a greater reach, by this reach. With
        ``reach`` None, the terrain is flat, below all centre lines and at most at height ``floor``, and the
        roads float above it."""
        lines = [road.centreline(LONGEST_STEP) for road in roads]
        if reach is not None:
            lines = [_lowest(road, line) for road, line in zip(roads, lines, strict=True)]
        line = np.concatenate(lines)
        low, high = line[:, :2].min(axis=0), line[:, :2].max(axis=0)
        low, high = np.minimum(low, (low + high - LEAST) / 2), np.maximum(high, (low + high + LEAST) / 2)
        span = float((high - low).max()) + 2 * MARGIN
        cell = max(FINEST, span / CELLS)
        x, y = (np.arange(low[i] - MARGIN, high[i] + MARGIN + cell, cell) for i in (0, 1))
        if reach is None:
            level = min(floor, float(line[:, 2].min()) - 1.0)
            away = np.full((len(y), len(x)), np.inf)
            return cls(*_widened(x, y, np.full((len(y), len(x)), level), away), cell)
        parts = [(line, reach)]
        for own, some in wide.items():
            beside = [_lowest(road, road.centreline(LONGEST_STEP)) for road in some]
            parts.append((np.concatenate(beside), own))
        heights, away = _relief(parts, x, y, cell)
        return cls(*_widened(x, y, heights, away), cell)

    def height(self, x: Array, y: Array) -> Array:
        """Returns interpolated heights ``(n,)`` in metres at points ``x``, ``y``, ``(n,)`` each. Beyond the
        grid, the height is that of the nearest point on its border."""
        return self.between(self.heights, x, y)

    def between(self, values: Array, x: Array, y: Array) -> Array:
        """Interpolates a grid of values ``(rows, columns)`` at n points ``x``, ``y``; returns n values."""
        i = np.clip(np.searchsorted(self.x, x) - 1, 0, len(self.x) - 2)
        j = np.clip(np.searchsorted(self.y, y) - 1, 0, len(self.y) - 2)
        u = np.clip((x - self.x[i]) / (self.x[i + 1] - self.x[i]), 0.0, 1.0)
        v = np.clip((y - self.y[j]) / (self.y[j + 1] - self.y[j]), 0.0, 1.0)
        low = values[j, i] * (1 - u) + values[j, i + 1] * u
        return np.asarray(low * (1 - v) + (values[j + 1, i] * (1 - u) + values[j + 1, i + 1] * u) * v)


def _lowest(road: Road, line: Array) -> Array:
    if road.profile is None or road.profile.superelevation_angle is None:
        return line
    s = np.linspace(0.0, road.length, len(line))
    rims = road.profile.rims(s)
    sides = [road.at(s, t)[:, 2] for t in rims]
    return np.column_stack([line[:, :2], np.minimum(line[:, 2], np.minimum(*sides))])


def _relief(parts: Sequence[tuple[Array, float]], x: Array, y: Array, cell: float) -> tuple[Array, Array]:
    """Returns the heights, and the distances ``away`` as in ``Land``, each of shape (rows, columns).
    ``parts`` are points on centre lines, and how far from them the land lies below the road."""
    lowest = np.full((len(y), len(x)), np.inf)
    for line, reach in parts:
        own = np.full_like(lowest, np.inf)
        i = np.rint((line[:, 0] - x[0]) / cell).astype(int)
        j = np.rint((line[:, 1] - y[0]) / cell).astype(int)
        np.minimum.at(own, (j, i), line[:, 2])
        far = reach + 1.45 * cell
        cells = int(np.ceil(far / cell + 0.71))
        around = np.hypot(*np.mgrid[-cells : cells + 1, -cells : cells + 1]) * cell <= far + 0.71 * cell
        own = scipy.ndimage.minimum_filter(own, footprint=around, mode="constant", cval=np.inf)
        lowest = np.minimum(lowest, own)
    fixed = np.isfinite(lowest)
    away, nearest = scipy.ndimage.distance_transform_edt(~fixed, return_indices=True)
    heights = np.asarray(lowest[tuple(nearest)] - BELOW)
    for _ in range(3):  # smooths terraces without raising the land
        heights = np.minimum(heights, scipy.ndimage.uniform_filter(heights, 3))
    kept = heights.copy()
    for _ in range(80):
        padded = np.pad(heights, 1, mode="edge")
        mean = (padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:]) / 4
        heights = np.where(fixed, kept, mean)
    away = away * cell
    return heights + _hills(*np.meshgrid(x, y), cell) * np.clip((away - 4) / 90, 0.0, 1.0), away


def _hills(x: Array, y: Array, cell: float) -> Array:
    swell = np.sin(x / 37 + 1.3) * np.sin(y / 43 + 0.4) * (cell < 44)
    swell = swell + 0.5 * np.sin(x / 17 - y / 21) * (cell < 20)
    return np.asarray(3.4 * (swell - 0.3) + 5.5 * np.sin(x / 71 + 2.0) * np.sin(y / 83 + 0.9))


def _widened(x: Array, y: Array, heights: Array, away: Array) -> tuple[Array, Array, Array, Array]:
    far = np.array(FAR)
    pad = len(far)
    mean = float(heights.mean())
    wide, wide_away = np.pad(heights, pad, mode="edge"), np.pad(away, pad, mode="edge")
    rows, columns = (np.r_[pad:0:-1, np.zeros(n, int), 1 : pad + 1] for n in heights.shape)
    ring = np.maximum.outer(rows, columns)
    share = np.array([0.0, 0.5, 0.9, 1.0, 1.0])[ring]
    wide = wide * (1 - share) + (mean - 4.0) * share
    return _stretched(x, far), _stretched(y, far), wide, wide_away


def _stretched(v: Array, far: Array) -> Array:
    return np.concatenate([v[0] - far[::-1], v, v[-1] + far])
