"""Plants trees beside the road, creates their pictures, and draws them upright over the image, from the
farthest to the nearest. The trees are so far from the road that cars cannot reach them."""

import math
from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from roadgpt.brief.scene import Land
from roadgpt.compiled import compiled, inlined
from roadgpt.geometry.curve import Array
from roadgpt.ground.ground import Ground
from roadgpt.scene.light import SUN, SUN_X, SUN_Y
from roadgpt.scene.patterns import mipmapped
from roadgpt.scene.raster import RenderBuffers
from roadgpt.scene.shade import Colour, air, hazy

SEED = 11
SIDE = 128  # texels; width and height of a picture
AVENUE, ROW = 9.0, 15.5  # m between the trees of an avenue, and from the rim to their row
BROAD, CONIFERS = 3, 2  # numbers of pictures of broad-leaved trees and of conifers
CLEAR = 9.0  # m from the outer edge of the shoulder to the nearest tree
EACH = 210.0  # m^2 of land per tree, before trees near roads are removed
MOST = 900  # trees
SMALLEST = 0.7  # pixels high, of a tree that is drawn
NEAREST = 2.0  # m from the camera
USUAL_SHARE = 0.1  # of the trees of a forest that also stand on its other side
STEEPEST = 0.9  # metres up for each metre aside, where trees still stand


class Trees(NamedTuple):
    """The trees of a scene: upright pictures that face the camera."""

    places: Array  # position of the foot of each tree in metres, (n, 3)
    sizes: Array  # height and width of each tree in metres, (n, 2)
    looks: NDArray[np.int64]  # index of the picture of each tree, (n,)
    tints: Array  # factor by which the brightness of each tree's picture is multiplied, (n,)


def plant(ground: Ground, lands: Sequence[Land], way: Array) -> Trees:
    """Returns trees in loose groups on dry ground that is not too steep, none of them near a road.

    A forest among ``lands`` has many more, on both sides or on one of ``way``, points ``(n, 2)``; an avenue
    has rows beside the road."""
    rng = np.random.default_rng(SEED)
    (x0, x1), (y0, y1) = ground.x[[0, -1]], ground.y[[0, -1]]
    is_forest = any(land.kind == "forest" for land in lands)
    count = int(min(MOST * (3 if is_forest else 1), (x1 - x0) * (y1 - y0) / (EACH / (5 if is_forest else 1))))
    middles = rng.uniform((x0, y0), (x1, y1), (max(1, count // 7), 2))
    spots = middles[rng.integers(len(middles), size=count)] + rng.normal(0.0, 13.0, (count, 2))
    alone = rng.random(count) < (0.8 if is_forest else 0.25)
    spots[alone] = rng.uniform((x0, y0), (x1, y1), (int(alone.sum()), 2))
    spots, lined = _with_avenue(spots, ground, any(land.kind == "tree_lined" for land in lands))
    count = len(spots)
    looks = np.where(np.arange(count) < lined, 0, rng.integers(BROAD + CONIFERS, size=count))
    heights = np.where(looks < BROAD, rng.uniform(6.0, 11.0, count), rng.uniform(8.0, 14.0, count))
    widths = heights * np.where(looks < BROAD, rng.uniform(0.85, 1.1, count), rng.uniform(0.42, 0.5, count))
    tints = rng.uniform(0.8, 1.12, count)
    rims = np.concatenate([*ground.pavement.rims, np.empty((0, 3))])
    away = cKDTree(rims[:, :2]).query(spots)[0] if len(rims) else np.full(count, np.inf)
    inside = (spots > (x0, y0)).all(axis=1) & (spots < (x1, y1)).all(axis=1)
    x, y = spots.T
    z = ground.height(x, y)
    steep = np.hypot(ground.height(x + 1.0, y) - z, ground.height(x, y + 1.0) - z)
    dry = np.isnan(ground.water(x, y)) & (steep < STEEPEST) & np.isnan(ground.road(x, y))
    kept = inside & dry & (away > CLEAR + widths / 2)
    sides = {land.side for land in lands if land.kind == "forest"}
    if len(sides) == 1 and (side := sides.pop()):
        nearest = cKDTree(way).query(spots)[1]
        ahead, off = np.gradient(way, axis=0)[nearest], spots - way[nearest]
        is_left = ahead[:, 0] * off[:, 1] - ahead[:, 1] * off[:, 0] > 0
        kept &= (is_left == (side == "left")) | (rng.random(count) < USUAL_SHARE)
    foot = np.column_stack([spots, z - 0.15])
    return Trees(foot[kept], np.column_stack([heights, widths])[kept], looks[kept], tints[kept])


def _with_avenue(spots: Array, ground: Ground, is_lined: bool) -> tuple[Array, int]:
    """Returns spots with rows of trees along the rims of the roads before them, and the number of these."""
    if not is_lined:
        return spots, 0
    rows = []
    for ring in ground.pavement.rims:
        along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(ring[:, :2], axis=0).T))]
        at = np.arange(AVENUE / 2, along[-1], AVENUE)
        line = np.column_stack([np.interp(at, along, ring[:, k]) for k in (0, 1)])
        ahead = np.gradient(line, axis=0)
        ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
        rows.append(line + ROW * np.column_stack([ahead[:, 1], -ahead[:, 0]]))
    return np.concatenate([*rows, spots]), sum(map(len, rows))


@cache
def pictures() -> NDArray[np.float32]:
    """Returns the tree pictures, shape (pictures, n, 4). The n pixels of a picture include its mipmap levels.
    A pixel is RGBA with premultiplied alpha."""
    rng = np.random.default_rng(SEED)
    drawn = [_tree(*_crown(rng), rng, (0.085, 0.15, 0.035)) for _ in range(BROAD)]
    drawn += [_tree(*_cone(rng), rng, (0.035, 0.085, 0.035)) for _ in range(CONIFERS)]
    return np.stack([mipmapped(picture) for picture in drawn]).astype(np.float32)


def _crown(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    boughs = rng.normal(size=(14, 3))
    boughs *= (0.62 * rng.random(14) ** 0.4 / np.linalg.norm(boughs, axis=1))[:, None]
    tufts = boughs[rng.integers(14, size=420)]
    way = rng.normal(size=(420, 3))
    tufts = tufts + 0.27 * way / np.linalg.norm(way, axis=1, keepdims=True)
    height = 0.60 + 0.37 * tufts[:, 2]
    return np.column_stack([tufts[:, :2], height]), tufts, rng.uniform(0.028, 0.06, 420)


def _cone(rng: np.random.Generator) -> tuple[Array, Array, Array]:
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
        inside = (across - x) ** 2 + ((up - z) * 2) ** 2 < (2 * radii[k]) ** 2
        tone = (0.62 + 0.55 * max(lit[k], -0.45)) * inner[k] * (0.85 + 0.3 * z) * rng.uniform(0.8, 1.2)
        picture[inside] = [*(np.array(leaf) * tone * 1.35), 1.0]
    return picture


@inlined
def _texel(
    pictures: NDArray[np.float32], look: int, start: int, side: int, u: float, v: float, k: int
) -> float:
    """Returns channel k at (u, v) in texels, interpolated between four of them; 0 outside the picture."""
    fu, fv = math.floor(u - 0.5), math.floor(v - 0.5)
    du, dv = u - 0.5 - fu, v - 0.5 - fv
    out = 0.0
    for j in range(2):
        for i in range(2):
            if 0 <= fu + i < side and 0 <= fv + j < side:
                part = (du if i else 1.0 - du) * (dv if j else 1.0 - dv)
                out += part * pictures[look, start + (fv + j) * side + fu + i, k]
    return out


@inlined
def _mip_level(high: float) -> tuple[int, int]:
    side, start = SIDE, 0
    while side > 1 and side > 1.4 * high:
        start += side * side
        side >>= 1
    return start, side


@inlined
def _range(a: float, b: float, reach: float, size: int) -> tuple[int, int]:
    return max(0, int(min(a, b) - reach)), min(size, int(max(a, b) + reach) + 1)


@inlined
def _blend(
    picture: NDArray[np.float32], row: int, i: int, pictures: NDArray[np.float32], look: int, start: int,
    side: int, u: float, v: float, cover: float, light: float, haze: Colour, part: float,
) -> None:  # fmt: skip
    """Blends a tree into one pixel; ``part`` is the share of the pixel where nothing hides the tree."""
    cover *= part
    for k in range(3):
        colour = _texel(pictures, look, start, side, u, v, k) * light * part
        picture[row, i, k] = picture[row, i, k] * (1.0 - cover) + colour + haze[k] * cover


@compiled
def overlay(
    order: NDArray[np.int64], trees: Trees, pictures: NDArray[np.float32], eye: Array, buffers: RenderBuffers,
    keeps_depth: bool,
) -> None:  # fmt: skip
    """Draws trees over the image, except where nearer surfaces hide them.

    ``order`` has the indices of the trees, the farthest first; ``eye`` is the camera, as in `raster.draw`.
    With ``keeps_depth``, the samples that they cover get their depth."""
    places, sizes, looks, tints = trees
    depth, picture = buffers.depth, buffers.picture
    rows, columns = picture.shape[0], picture.shape[1]
    foot, top = np.empty(3), np.empty(3)
    for n in order:
        dx, dy, dz = places[n, 0] - eye[0], places[n, 1] - eye[1], places[n, 2] - eye[2]
        for k in range(3):
            a, b, c = eye[3 + 3 * k], eye[4 + 3 * k], eye[5 + 3 * k]
            foot[k] = dx * a + dy * b + dz * c
            top[k] = foot[k] + sizes[n, 0] * c
        if foot[2] < NEAREST or top[2] < NEAREST:
            continue
        x0, y0 = columns / 2.0 + eye[12] * foot[0] / foot[2], rows / 2.0 + eye[12] * foot[1] / foot[2]
        ux, uy = columns / 2.0 + eye[12] * top[0] / top[2] - x0, rows / 2.0 + eye[12] * top[1] / top[2] - y0
        high = math.sqrt(ux * ux + uy * uy)
        if high < SMALLEST:
            continue
        wide = high * sizes[n, 1] / sizes[n, 0]
        left, right = _range(x0, x0 + ux, abs(uy) / high * wide / 2 + 1, columns)
        above, below = _range(y0, y0 + uy, abs(ux) / high * wide / 2 + 1, rows)
        if left >= right or above >= below:
            continue
        start, side = _mip_level(high)
        near = 1.0 / foot[2]
        far = math.sqrt(dx * dx + dy * dy + dz * dz)
        thin, warm = air(far, (dx * SUN_X + dy * SUN_Y) / far)
        haze = hazy(0.0, 0.0, 0.0, thin, warm)
        for row in range(above, below):
            for i in range(left, right):
                px, py = i + 0.5 - x0, row + 0.5 - y0
                v = 1.0 - (px * ux + py * uy) / (high * high)
                u = 0.5 + (py * ux - px * uy) / (high * wide)
                if not (-0.1 < u < 1.1 and -0.1 < v < 1.1):
                    continue
                cover = _texel(pictures, looks[n], start, side, u * side, v * side, 3)
                if cover <= 0.003:
                    continue
                free = 0
                for k in range(4):
                    is_free = depth[4 * row + k, i] < near
                    free += is_free
                    if keeps_depth and is_free and cover > 0.5:
                        depth[4 * row + k, i] = near
                if free > 0:
                    _blend(
                        picture, row, i, pictures, looks[n], start, side, u * side, v * side, cover,
                        tints[n] * thin, haze, free / 4.0,
                    )  # fmt: skip
