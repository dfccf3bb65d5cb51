"""Creates textures of surfaces from noise. The textures tile without a seam and are the same for every
road.
"""

import io
from functools import cache
from typing import NamedTuple

import numpy as np
from PIL import Image

from roadgpt.geometry.curve import Array

SIDE = 256  # pixels


class Grain(NamedTuple):
    """A texture that varies the brightness of a surface."""

    metres: float
    """Side length in metres of the square area that the texture covers."""
    seed: int
    octaves: tuple[tuple[int, float], ...]
    """Layers of noise: for each, the number of noise cells along a side of the texture, and the amplitude
    relative to the mean brightness."""


GRAINS = {
    "asphalt": Grain(5.0, 11, ((128, 0.34), (256, 0.30), (8, 0.10))),
    "gravel": Grain(4.0, 17, ((64, 0.30), (256, 0.40))),
    "grass": Grain(37.0, 23, ((24, 0.10), (64, 0.16), (256, 0.22))),
}
"""Textures by material. Their sizes and amplitudes are also used by the HTML page that replays a drive."""


@cache
def picture(name: str) -> bytes:
    """Returns the texture of a material as a grey PNG file."""
    grain = GRAINS[name]
    levels = np.clip(np.round(225 * _noise(grain)), 0, 255).astype(np.uint8)
    data = io.BytesIO()
    Image.fromarray(levels).save(data, format="PNG", optimize=True)
    return data.getvalue()


def _noise(grain: Grain) -> Array:
    """Returns the brightness of each pixel, 1 on average, as an array of shape (SIDE, SIDE)."""
    rng = np.random.default_rng(grain.seed)
    out = np.ones((SIDE, SIDE))
    for cells, strength in grain.octaves:
        knots = rng.random((cells, cells)) - 0.5
        place = np.arange(SIDE) * cells / SIDE
        low = place.astype(int)
        share = place - low
        rows = knots[low] * (1 - share[:, None]) + knots[(low + 1) % cells] * share[:, None]
        out += strength * (rows[:, low] * (1 - share) + rows[:, (low + 1) % cells] * share)
    return out
