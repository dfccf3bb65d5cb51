"""Creates seeded noise at several resolutions, and computes in compiled code its value at the resolution of a
pixel, and the fraction of a pixel that a marking covers."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from roadgpt.compiled import inlined
from roadgpt.geometry.curve import Array

SIDE = 256  # texels
SEED = 20
GRAIN, CLOUD, MEADOW = 0, 1, 2
COARSEST = 6.0  # halvings after which a tile is uniform


@cache
def noise() -> NDArray[np.float32]:
    """Returns three noise tiles ``(3, n)`` of mean 0 and standard deviation 1; each row holds one tile
    with all its mipmap levels, down to 1 texel.

    The three tiles look like the grain of stone, like clouds of all sizes, and like tufts of grass."""
    rng = np.random.default_rng(SEED)
    grain = _shaped(rng, lambda f: np.exp(-((f / 0.42) ** 2)) + 1.9 * np.exp(-((f / 0.13) ** 2)))
    cloud = _shaped(rng, lambda f: np.maximum(f, 1.0 / SIDE) ** -1.55)
    meadow = _shaped(rng, lambda f: np.exp(-((f / 0.4) ** 2)) + 0.035 * np.maximum(f, 2.0 / SIDE) ** -1.35)
    tiles = [mipmapped(tile) for tile in (grain, np.clip(cloud, -2.5, 2.5), meadow)]
    return np.stack(tiles).astype(np.float32)


def _shaped(rng: np.random.Generator, gain: Callable[[Array], Array]) -> Array:
    f = np.hypot(np.fft.fftfreq(SIDE)[:, None], np.fft.fftfreq(SIDE)[None, :])
    spectrum = np.fft.fft2(rng.standard_normal((SIDE, SIDE))) * gain(f)
    spectrum[0, 0] = 0.0
    field = np.fft.ifft2(spectrum).real
    return np.asarray(field / field.std())


def mipmapped(picture: Array) -> Array:
    """Returns the pixels of a picture ``(side, side, ...)``, followed by the pixels of smaller and smaller
    copies. Each copy has half the side of the copy before; the last copy is 1 pixel."""
    rest = picture.shape[2:]
    levels = [picture.reshape(-1, *rest)]
    while len(picture) > 1:
        n = len(picture) // 2
        picture = picture.reshape(n, 2, n, 2, *rest).mean(axis=(1, 3))
        levels.append(picture.reshape(-1, *rest))
    return np.concatenate(levels)


Tiles = NDArray[np.float32]


@inlined
def plain_noise(tiles: Tiles, tile: int, start: int, side: int, u: float, v: float) -> float:
    """Returns the bilinearly interpolated value of one resolution level of a noise tile at (u, v) in texels
    of this level. The level is ``side`` texels wide and begins at index ``start`` of the tile."""
    fu, fv = math.floor(u), math.floor(v)
    du, dv = u - fu, v - fv
    mask = side - 1
    i, j = fu & mask, fv & mask
    i1, j1 = (i + 1) & mask, (j + 1) & mask
    low, high = np.uint64(start + j * side), np.uint64(start + j1 * side)  # unsigned: never from the end
    a, b = tiles[tile, low + np.uint64(i)], tiles[tile, low + np.uint64(i1)]
    c, d = tiles[tile, high + np.uint64(i)], tiles[tile, high + np.uint64(i1)]
    return float((a + (b - a) * du) * (1.0 - dv) + (c + (d - c) * du) * dv)


@inlined
def fine_noise(tiles: Tiles, tile: int, u: float, v: float, level: float) -> float:
    """Returns the value of a noise tile at (u, v) in texels, filtered for a pixel that is 2**level texels
    wide."""
    if level <= 0.0:
        return plain_noise(tiles, tile, 0, SIDE, u, v)
    if not level < COARSEST:
        return 0.0
    k = int(level)
    side = SIDE >> k
    start = (SIDE * SIDE - side * side) * 4 // 3
    scale = 1.0 / (1 << k)
    fine = plain_noise(tiles, tile, start, side, u * scale - 0.5, v * scale - 0.5)
    scale *= 0.5
    coarse = plain_noise(tiles, tile, start + side * side, side >> 1, u * scale - 0.5, v * scale - 0.5)
    return fine + (coarse - fine) * (level - k)


@inlined
def share(x: float, low: float, high: float, wide: float) -> float:
    """Returns the fraction (0 to 1) of an interval that lies between ``low`` and ``high``. The interval has
    the width ``wide`` and the centre x."""
    return max(min(x + wide / 2, high) - max(x - wide / 2, low), 0.0) / wide


@inlined
def dashed(x: float, dash: float, period: float) -> float:
    """Returns the total length of all dashes from 0 to x. A dash of length ``dash`` begins at 0 and after
    every ``period``."""
    whole = math.floor(x / period)
    return whole * dash + min(x - whole * period, dash)


@inlined
def bump(x: float, wide: float) -> float:
    """Returns a value that falls smoothly from 1 at x = 0 to 0 at |x| = ``wide``, and is 0 beyond."""
    part = max(1.0 - x * x * (1.0 / (wide * wide)), 0.0)
    return part * part


@inlined
def length_of(x: float, y: float) -> float:
    """Returns the length of a vector, with an error of at most 4 percent."""
    x, y = abs(x), abs(y)
    return max(0.96 * max(x, y) + 0.40 * min(x, y), max(x, y))


@inlined
def smooth(low: float, high: float, x: float) -> float:
    """Returns 0 if x is at most ``low``, 1 if x is at least ``high``, and a smooth transition in between."""
    part = min(max((x - low) / (high - low), 0.0), 1.0)
    return part * part * (3.0 - 2.0 * part)
