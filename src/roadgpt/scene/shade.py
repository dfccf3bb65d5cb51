"""What colour each pixel has: what is seen there, the light on it, the car's shadow, and the haze before it.

A surface is coloured from its coordinates, not from a picture: markings are averaged over the pixel exactly,
noise is read at the fineness that the pixel has. Colours are linear until `to_screen`.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.scene.compiled import compiled, inlined
from roadgpt.scene.light import SUN_X, SUN_Y, SUN_Z
from roadgpt.scene.mesh import PLAIN, POST, ROAD
from roadgpt.scene.patterns import Tiles, smooth
from roadgpt.scene.surfaces import Colour, grass, road, sky
from roadgpt.scene.textures import STEPS

THINNEST = 0.008  # m: a pixel that sees less than this sees no finer marking
HAZE = 1000.0  # m
AMBER = 0.69, 0.80  # m, of a post's reflector
DARK = 0.62, 0.86  # m, of its dark band
REACH = 36.0  # m^2: farther from the car there is no shadow


@inlined
def _box(x: float, y: float, long: float, wide: float, soft: float) -> float:
    """1 inside of a box around the origin, 0 outside, soft in between."""
    return smooth(-0.5, 0.5, (long - abs(x)) / soft) * smooth(-0.5, 0.5, (wide - abs(y)) / soft)


@inlined
def _shadow(car: Array, x: float, y: float, z: float) -> float:
    """How much light is left at a place on the ground: the car hides the sun, and the sky under it."""
    dx, dy, dz = x - car[0], y - car[1], z - car[2]
    if dx * dx + dy * dy > REACH or abs(dz) > 1.6:
        return 1.0
    ahead, left = dx * car[3] + dy * car[4] - car[7], dy * car[3] - dx * car[4]
    long, wide = car[5] / 2, car[6] / 2
    under = _box(ahead, left, long - 0.05, wide - 0.02, 0.5)
    along, across = (SUN_X * car[3] + SUN_Y * car[4]) / SUN_Z, (SUN_Y * car[3] - SUN_X * car[4]) / SUN_Z
    cast = 0.0
    for k in range(7):  # slices of the car, the cabin being shorter and narrower
        up = 0.18 + 0.2 * k
        cabin = max(up - 0.85, 0.0)
        back = 0.35 * min(cabin * 4.0, 1.0)
        slice_long = long - 2.0 * cabin - 0.25 * min(cabin * 20.0, 1.0)
        a, b = ahead + up * along + back, left + up * across
        cast = max(cast, _box(a, b, slice_long, wide - 0.45 * cabin, 0.12 + 0.1 * up))
    return (1.0 - 0.55 * cast) * (1.0 - 0.62 * under)


@inlined
def _post(side: float, height: float, light: float) -> Colour:
    slanted = height + 0.06 * (side - 1.5)
    if not DARK[0] < slanted < DARK[1]:
        return 0.74 * light, 0.74 * light, 0.74 * light
    if AMBER[0] < height < AMBER[1]:
        return 0.75, 0.62, 0.42
    return 0.03 * light, 0.03 * light, 0.03 * light


@inlined
def _triangle(
    n: int, px: float, py: float, dx: float, dy: float, dz: float, planes: Array, kind: int, palette: Array,
    tiles: Tiles, eye: Array, numbers: Array,
) -> Colour:  # fmt: skip
    """Colour of a triangle at a place of the picture, in the direction (dx, dy, dz) whose depth is 1."""
    w = 1.0 / max(planes[n, 0] * px + planes[n, 1] * py + planes[n, 2], 1e-6)
    u = (planes[n, 3] * px + planes[n, 4] * py + planes[n, 5]) * w
    v = (planes[n, 6] * px + planes[n, 7] * py + planes[n, 8]) * w
    light = (planes[n, 9] * px + planes[n, 10] * py + planes[n, 11]) * w
    far = math.sqrt(dx * dx + dy * dy + dz * dz)
    if kind < POST:
        x, y, z = eye[0] + dx * w, eye[1] + dy * w, eye[2] + dz * w
        wide = w / eye[12]
        level = 0.5 * math.log2(wide * wide * far / max(abs(dz), 0.02 * far))
        if kind == ROAD:
            ux, uy = (planes[n, 3] - u * planes[n, 0]) * w, (planes[n, 4] - u * planes[n, 1]) * w
            vx, vy = (planes[n, 6] - v * planes[n, 0]) * w, (planes[n, 7] - v * planes[n, 1]) * w
            wide_u = max(math.sqrt(ux * ux + uy * uy), THINNEST)
            wide_v = max(math.sqrt(vx * vx + vy * vy), THINNEST)
            r, g, b = road(tiles, u, v, wide_u, wide_v, x, y, level, numbers[0], numbers[1])
        else:
            r, g, b = grass(tiles, x, y, level)
        if numbers[10] > 0.0:
            light *= _shadow(numbers[2:], x, y, z)
        r, g, b = r * light, g * light, b * light
    elif kind == POST:
        r, g, b = _post(u, v, light)
    else:
        p = kind - PLAIN
        r = palette[p, 0] * light + u * 0.80 + palette[p, 3]
        g = palette[p, 1] * light + u * 0.90 + palette[p, 4]
        b = palette[p, 2] * light + u + palette[p, 5]
    return hazy(r, g, b, w * far, (dx * SUN_X + dy * SUN_Y) / far)


@inlined
def hazy(r: float, g: float, b: float, distance: float, toward: float) -> Colour:
    """A colour seen through so many metres of air; warmer towards the sun, whose cosine is ``toward``."""
    d = distance / HAZE
    thin = 1.0 / (1.0 + 0.9 * d + 2.2 * d * d)
    warm = 0.10 * max(toward, 0.0) ** 2
    r = r * thin + (0.60 + warm) * (1.0 - thin)
    g = g * thin + (0.71 + 0.9 * warm) * (1.0 - thin)
    return r, g, b * thin + (0.79 + 0.7 * warm) * (1.0 - thin)


@compiled
def shade(
    ids: NDArray[np.int32], planes: Array, kinds: NDArray[np.int64], palette: Array, tiles: Tiles, eye: Array,
    numbers: Array, picture: NDArray[np.float32],
) -> None:  # fmt: skip
    """Colour all pixels of ``picture`` (height, width, 3) from the four samples of each.

    Args:
        ids, planes, kinds: what `raster.draw` has seen, and of which kind.
        palette: (n, 6) colours, and what they shine of their own.
        tiles: `textures.noise`.
        eye: as for `raster.draw`.
        numbers: lane width and length of the road; ground under the car (3), where it heads to (2), length,
            width, how far its middle is ahead, and 1 if it throws a shadow.
        picture: linear light, written.
    """
    rows, columns = picture.shape[0], picture.shape[1]
    for row in range(rows):
        for i in range(columns):
            red = green = blue = 0.0
            k = 0
            while k < 4:
                n = ids[4 * row + k, i]
                same, is_first = 0, True
                for other in range(4):
                    if ids[4 * row + other, i] == n:
                        same += 1
                        is_first = is_first and other >= k
                if is_first:
                    px = i + 0.5 if same == 4 else i + (0.375, 0.875, 0.125, 0.625)[k]
                    py = row + 0.5 if same == 4 else row + (k + 0.5) / 4
                    rx, ry = (px - columns / 2.0) / eye[12], (py - rows / 2.0) / eye[12]
                    dx = eye[3] * rx + eye[6] * ry + eye[9]
                    dy = eye[4] * rx + eye[7] * ry + eye[10]
                    dz = eye[5] * rx + eye[8] * ry + eye[11]
                    if n >= 0:
                        r, g, b = _triangle(
                            n, px, py, dx, dy, dz, planes, kinds[n], palette, tiles, eye, numbers
                        )
                    else:
                        short = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
                        r, g, b = sky(tiles, dx * short, dy * short, dz * short)
                    part = same / 4.0
                    red, green, blue = red + r * part, green + g * part, blue + b * part
                k = 4 if same == 4 else k + 1
            picture[row, i, 0], picture[row, i, 1], picture[row, i, 2] = red, green, blue


@compiled
def to_screen(picture: NDArray[np.float32], table: NDArray[np.uint8], out: NDArray[Any]) -> None:
    """Linear light to bytes; what is nearly white or brighter is bent back a little first."""
    rows, columns = picture.shape[0], picture.shape[1]
    for row in range(rows):
        for i in range(columns):
            for k in range(3):
                c = picture[row, i, k]
                if c > 0.7:
                    c = 0.7 + 0.3 * (1.0 - 1.0 / (1.0 + (c - 0.7) / 0.3))
                out[row, i, k] = table[int(min(max(c, 0.0), 1.0) * (STEPS - 1) + 0.5)]
