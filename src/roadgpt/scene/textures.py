"""Creates seeded noise at several resolutions, and the table that converts linear light to screen bytes."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array

SIDE = 256  # texels
SEED = 20
GRAIN, CLOUD, MEADOW = 0, 1, 2
STEPS = 4096  # of the table


@cache
def noise() -> NDArray[np.float32]:
    """Returns three noise tiles ``(3, n)`` of mean 0 and standard deviation 1; each row holds one tile
    with all its mipmap levels, down to 1 texel.

    The three tiles look like the grain of stone, like clouds of all sizes, and like tufts of grass.
    """
    rng = np.random.default_rng(SEED)
    grain = _shaped(rng, lambda f: np.exp(-((f / 0.42) ** 2)) + 1.9 * np.exp(-((f / 0.13) ** 2)))
    cloud = _shaped(rng, lambda f: np.maximum(f, 1.0 / SIDE) ** -1.55)
    meadow = _shaped(rng, lambda f: np.exp(-((f / 0.4) ** 2)) + 0.035 * np.maximum(f, 2.0 / SIDE) ** -1.35)
    tiles = [mipmapped(tile) for tile in (grain, np.clip(cloud, -2.5, 2.5), meadow)]
    return np.stack(tiles).astype(np.float32)


def _shaped(rng: np.random.Generator, gain: Callable[[Array], Array]) -> Array:
    """Returns white noise filtered by ``gain``, a function of frequency in cycles per texel."""
    f = np.hypot(np.fft.fftfreq(SIDE)[:, None], np.fft.fftfreq(SIDE)[None, :])
    spectrum = np.fft.fft2(rng.standard_normal((SIDE, SIDE))) * gain(f)
    spectrum[0, 0] = 0.0
    field = np.fft.ifft2(spectrum).real
    return np.asarray(field / field.std())


def mipmapped(picture: Array) -> Array:
    """Returns the pixels of a picture ``(side, side, ...)``, followed by the pixels of smaller and smaller
    copies. Each copy has half the side of the copy before; the last copy is 1 pixel.
    """
    rest = picture.shape[2:]
    levels = [picture.reshape(-1, *rest)]
    while len(picture) > 1:
        n = len(picture) // 2
        picture = picture.reshape(n, 2, n, 2, *rest).mean(axis=(1, 3))
        levels.append(picture.reshape(-1, *rest))
    return np.concatenate(levels)


@cache
def screen_table() -> NDArray[np.uint8]:
    """Returns the table ``(STEPS,)`` of screen bytes for linear light from 0 to 1, using the sRGB curve (IEC
    61966-2-1)."""
    light = np.arange(STEPS) / (STEPS - 1)
    curve = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.round(255 * curve).astype(np.uint8)


def linear(*colour: int) -> tuple[float, float, float]:
    """Returns the linear light of an sRGB screen colour with channels from 0 to 255."""
    c = np.array(colour) / 255
    light = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return float(light[0]), float(light[1]), float(light[2])
