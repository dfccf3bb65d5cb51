"""Draws upright pictures (trees) over the image, from the farthest to the nearest."""

import math

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.scene.compiled import compiled, inlined
from roadgpt.scene.light import SUN_X, SUN_Y
from roadgpt.scene.shade import air, hazy
from roadgpt.scene.surfaces import Colour
from roadgpt.scene.trees import SIDE

SMALLEST = 0.7  # pixels high
NEAREST = 2.0  # m


@inlined
def _texel(
    pictures: NDArray[np.float32], look: int, start: int, side: int, u: float, v: float, k: int
) -> float:
    """Returns channel k of a picture at (u, v) in its texels, interpolated between four of them; 0
    outside."""
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
    """Returns the first texel and the side of the smallest copy of a picture that is sharp enough for a tree
    of this height in pixels."""
    side, start = SIDE, 0
    while side > 1 and side > 1.4 * high:
        start += side * side
        side >>= 1
    return start, side


@inlined
def _range(a: float, b: float, reach: float, size: int) -> tuple[int, int]:
    """Returns the first pixel, and the end, of the range between two places in the image, extended by
    ``reach`` pixels on both sides and limited to 0 and ``size``."""
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
    order: NDArray[np.int64], places: Array, sizes: Array, looks: NDArray[np.int64], tints: Array,
    pictures: NDArray[np.float32], eye: Array, depth: NDArray[np.float32], picture: NDArray[np.float32],
) -> None:  # fmt: skip
    """Draws trees over an image in linear light, in the given order, except where nearer surfaces hide them.

    Args:
        order: indices of trees, the farthest first.
        places: positions of the trees, as in `Trees`.
        sizes: heights and widths of the trees, as in `Trees`.
        looks: indices of the pictures of the trees, as in `Trees`.
        tints: brightness factors of the trees, as in `Trees`.
        pictures: the tree pictures from `trees.pictures`.
        eye: the camera, as in `raster.draw`.
        depth: inverse depth of each sample, as in `raster.draw`.
        picture: the image (height, width, 3); the trees are drawn into it.
    """
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
                    free += depth[4 * row + k, i] < near
                if free > 0:
                    _blend(
                        picture, row, i, pictures, looks[n], start, side, u * side, v * side, cover,
                        tints[n] * thin, haze, free / 4.0,
                    )  # fmt: skip
