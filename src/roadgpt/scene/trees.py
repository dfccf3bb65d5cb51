"""Creates the pictures and the positions of trees beside the road. The trees are so far from the road that
cars cannot reach them."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from roadgpt.geometry.curve import Array
from roadgpt.road.land import Land
from roadgpt.scene.light import SUN

SEED = 11
SIDE = 128  # texels; width and height of a picture
BROAD, CONIFERS = 3, 2  # numbers of pictures of broad-leaved trees and of conifers
CLEAR = 9.0  # m from the outer edge of the shoulder to the nearest tree
EACH = 210.0  # m^2 of land per tree, before trees near roads are removed
MOST = 900  # trees
BORDER = 4  # outermost rows and columns of the land on each side, where no trees stand


@dataclass(frozen=True, eq=False)
class Trees:
    """The trees of a scene: upright pictures that face the camera."""

    places: Array
    """Position of the foot of each tree in metres, (n, 3)."""
    sizes: Array
    """Height and width of each tree in metres, (n, 2)."""
    looks: NDArray[np.int64]
    """Index of the picture of each tree, (n,)."""
    tints: Array
    """Factor by which the brightness of each tree's picture is multiplied, (n,)."""


def plant(line: Array, reach: float, land: Land) -> Trees:
    """Returns trees in loose groups on the terrain, none of them near a road.

    Args:
        line: Points ``(n, 2)`` in metres on the centre lines of the roads.
        reach: The greatest distance in metres from a centre line to the outer edge of a shoulder.
        land: The terrain.
    """
    rng = np.random.default_rng(SEED)
    x0, x1, y0, y1 = land.x[BORDER], land.x[-BORDER - 1], land.y[BORDER], land.y[-BORDER - 1]
    count = int(min(MOST, (x1 - x0) * (y1 - y0) / EACH))
    middles = rng.uniform((x0, y0), (x1, y1), (max(1, count // 7), 2))
    spots = middles[rng.integers(len(middles), size=count)] + rng.normal(0.0, 13.0, (count, 2))
    alone = rng.random(count) < 0.25
    spots[alone] = rng.uniform((x0, y0), (x1, y1), (int(alone.sum()), 2))
    looks = rng.integers(BROAD + CONIFERS, size=count)
    heights = np.where(looks < BROAD, rng.uniform(6.0, 11.0, count), rng.uniform(8.0, 14.0, count))
    widths = heights * np.where(looks < BROAD, rng.uniform(0.85, 1.1, count), rng.uniform(0.42, 0.5, count))
    tints = rng.uniform(0.8, 1.12, count)
    away = cKDTree(line).query(spots)[0]
    inside = (spots > (x0, y0)).all(axis=1) & (spots < (x1, y1)).all(axis=1)
    kept = inside & (away > reach + CLEAR + widths / 2)
    foot = np.column_stack([spots, land.height(spots[:, 0], spots[:, 1]) - 0.15])
    return Trees(foot[kept], np.column_stack([heights, widths])[kept], looks[kept], tints[kept])


@cache
def pictures() -> NDArray[np.float32]:
    """Returns the tree pictures, shape (pictures, n, 4). The n pixels of a picture include its mipmap levels.
    A pixel is RGBA with premultiplied alpha."""
    rng = np.random.default_rng(SEED)
    drawn = [_tree(*_crown(rng), rng, (0.085, 0.15, 0.035)) for _ in range(BROAD)]
    drawn += [_tree(*_cone(rng), rng, (0.035, 0.085, 0.035)) for _ in range(CONIFERS)]
    return np.stack([_halved(picture) for picture in drawn]).astype(np.float32)


def _halved(picture: Array) -> Array:
    levels = [picture.reshape(-1, 4)]
    while len(picture) > 1:
        n = len(picture) // 2
        picture = picture.reshape(n, 2, n, 2, 4).mean(axis=(1, 3))
        levels.append(picture.reshape(-1, 4))
    return np.concatenate(levels)


def _crown(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Returns the tufts of a broad-leaved tree: positions (x, y, z), normals, and radii. x and y are in
    -1..1, z is in 0..1 upwards."""
    boughs = rng.normal(size=(14, 3))
    boughs *= (0.62 * rng.random(14) ** 0.4 / np.linalg.norm(boughs, axis=1))[:, None]
    tufts = boughs[rng.integers(14, size=420)]
    way = rng.normal(size=(420, 3))
    tufts = tufts + 0.27 * way / np.linalg.norm(way, axis=1, keepdims=True)
    height = 0.60 + 0.37 * tufts[:, 2]
    return np.column_stack([tufts[:, :2], height]), tufts, rng.uniform(0.028, 0.06, 420)


def _cone(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Returns the twigs of a conifer, in tiers that are wider below: positions, normals, and radii."""
    up = 1.0 - rng.random(520) ** 0.62
    tier = 0.78 + 0.22 * (1.0 - (up * 9.0) % 1.0)
    turn = rng.uniform(0, 2 * np.pi, 520)
    wide = 0.92 * (1.0 - up) * tier * rng.uniform(0.72, 1.0, 520) + 0.02
    way = np.column_stack([wide * np.cos(turn), wide * np.sin(turn)])
    normal = np.column_stack([np.cos(turn), np.sin(turn), np.full(520, 0.45)])
    radius = rng.uniform(0.016, 0.034, 520) * (1.15 - 0.5 * up)
    core = 1.0 - np.sqrt((np.arange(120) + 0.5) / 120)
    inner = np.column_stack([np.zeros((120, 2)), 0.10 + 0.88 * core])
    inner[:, 0] = rng.uniform(-0.55, 0.55, 120) * (1.0 - core)
    places = np.concatenate([np.column_stack([way, 0.10 + 0.88 * up]), inner])
    return places, np.concatenate([0.62 * normal, 0.02 * inner]), np.r_[radius, 0.05 * (1.0 - core) + 0.012]


def _tree(
    places: Array, normals: Array, radii: Array, rng: np.random.Generator, leaf: tuple[float, ...]
) -> Array:
    """Returns a picture (SIDE, SIDE, 4) of tufts, the nearest drawn last, lit from above and from the sun."""
    picture = np.zeros((SIDE, SIDE, 4))
    rows, columns = np.mgrid[0:SIDE, 0:SIDE] + 0.5
    across, up = 2 * columns / SIDE - 1, 1 - rows / SIDE
    trunk = (np.abs(across) < 0.045 * (1.4 - up)) & (up < 0.55)
    picture[trunk] = [0.075, 0.058, 0.042, 1.0]
    size = np.maximum(np.linalg.norm(normals, axis=1), 1e-9)
    lit = normals @ np.array([0.35 * np.hypot(*SUN[:2]), -0.5, SUN[2]]) / size
    inner = 0.55 + 0.45 * np.clip(size / 0.62, 0.0, 1.0)
    for k in np.argsort(-places[:, 1]):
        x, _, z = places[k]
        inside = ((across - x) / 1.0) ** 2 + ((up - z) * 2) ** 2 < (2 * radii[k]) ** 2
        tone = (
            (0.62 + 0.55 * max(lit[k], -0.45))
            * inner[k]
            * (0.85 + 0.3 * places[k, 2])
            * rng.uniform(0.8, 1.2)
        )
        picture[inside] = [*(np.array(leaf) * tone * 1.35), 1.0]
    return picture
