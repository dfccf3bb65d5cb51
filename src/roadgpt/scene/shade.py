"""Computes the colour of each pixel: surface, light, the car's shadow, and haze.

Colours are computed from coordinates on the surface instead of texture images: the fraction of a pixel that
markings cover is computed exactly, and noise is filtered to the size of the pixel. Colours are linear until
`to_screen`.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.scene.compiled import compiled, inlined
from roadgpt.scene.light import SUN_X, SUN_Y, SUN_Z
from roadgpt.scene.mesh import PLAIN, POST, ROAD
from roadgpt.scene.patterns import Tiles, length_of, smooth
from roadgpt.scene.raster import OFFSETS, RenderBuffers
from roadgpt.scene.surfaces import Colour, LaneBoundaries, grass, road, sky
from roadgpt.scene.textures import STEPS

THINNEST = 0.008  # m: smallest pixel width for which markings are computed
HAZE = 1000.0  # m
AIR = 0.60, 0.71, 0.79  # linear colour of haze
AMBER = 0.69, 0.80  # m, of a post's reflector
DARK = 0.62, 0.86  # m, of its dark band
BLOCK = 4  # pixels side by side that share haze and resolution, which change slowly
LEAN = 0.6  # shift of the grass pattern with the height: else steep embankments would stretch it
ALIKE = 0.08  # relative difference of depths within one surface
RIDGES = 0.12  # upward part of a direction, below which the sky is drawn pixel by pixel
REACH = 20.0  # m^2: at a larger squared distance from the car's middle there is no shadow
HIGHEST = 1.6  # m: the longest shadow, given the elevation of the sun
SLICES = 5


@inlined
def _box(x: float, y: float, long: float, wide: float, soft: float) -> float:
    """Returns 1 inside a box around the origin and 0 outside, with soft edges."""
    return smooth(-0.5, 0.5, (long - abs(x)) / soft) * smooth(-0.5, 0.5, (wide - abs(y)) / soft)


@inlined
def _shadow(car: Array, x: float, y: float, z: float) -> float:
    """Returns the share of light that remains at a point on the ground. The car blocks the sun, and, for
    points under the car, also the sky."""
    dx, dy, dz = x - car[0], y - car[1], z - car[2]
    if dx * dx + dy * dy > REACH or abs(dz) > HIGHEST:
        return 1.0
    ahead, left = dx * car[3] + dy * car[4] - car[7], dy * car[3] - dx * car[4]
    long, wide = car[5] / 2, car[6] / 2
    if abs(ahead) > long + HIGHEST or abs(left) > wide + HIGHEST:
        return 1.0
    under = _box(ahead, left, long - 0.05, wide - 0.02, 0.5)
    along, across = (SUN_X * car[3] + SUN_Y * car[4]) / SUN_Z, (SUN_Y * car[3] - SUN_X * car[4]) / SUN_Z
    cast = 0.0
    for k in range(SLICES):  # of the car, the cabin being shorter and narrower
        up = 0.2 + 1.2 / (SLICES - 1) * k
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
def hazy(r: float, g: float, b: float, thin: float, warm: float) -> Colour:
    """Blends a colour with the colour of haze: ``thin`` (0 to 1) is the weight of the original colour;
    ``warm`` brightens the haze, most of all in the red channel."""
    thick = 1.0 - thin
    r, g = r * thin + (AIR[0] + warm) * thick, g * thin + (AIR[1] + 0.9 * warm) * thick
    return r, g, b * thin + (AIR[2] + 0.7 * warm) * thick


@inlined
def air(distance: float, toward: float) -> tuple[float, float]:
    """Returns ``thin`` and ``warm`` for `hazy` at a distance in metres; ``toward`` is the cosine of the angle
    between the line of sight and the sun.
    """
    d = distance * (1.0 / HAZE)
    toward = max(toward, 0.0)
    return 1.0 / (1.0 + d * (0.9 + 2.2 * d)), 0.10 * toward * toward


@inlined
def _ground(
    n: int, px: float, py: float, w: float, dx: float, dy: float, dz: float, level: float, planes: Array,
    is_road: bool, tiles: Tiles, eye: Array, lanes: LaneBoundaries, numbers: Array,
) -> Colour:  # fmt: skip
    """Returns the colour of road or terrain at depth w in the direction (dx, dy, dz), a vector whose own
    depth is 1."""
    light = (planes[n, 9] * px + planes[n, 10] * py + planes[n, 11]) * w
    x, y, z = eye[0] + dx * w, eye[1] + dy * w, eye[2] + dz * w
    if is_road:
        s = (planes[n, 3] * px + planes[n, 4] * py + planes[n, 5]) * w
        t = (planes[n, 6] * px + planes[n, 7] * py + planes[n, 8]) * w
        sx, sy = (planes[n, 3] - s * planes[n, 0]) * w, (planes[n, 4] - s * planes[n, 1]) * w
        tx, ty = (planes[n, 6] - t * planes[n, 0]) * w, (planes[n, 7] - t * planes[n, 1]) * w
        wide_s = max(length_of(sx, sy), THINNEST)
        wide_t = max(length_of(tx, ty), THINNEST)
        r, g, b = road(tiles, s, t, wide_s, wide_t, x, y, level, lanes)
    else:
        r, g, b = grass(tiles, x + LEAN * z, y - LEAN * z, level)
    if numbers[8] > 0.0:
        light *= _shadow(numbers, x, y, z)
    return r * light, g * light, b * light


@inlined
def _thing(n: int, px: float, py: float, w: float, planes: Array, kind: int, palette: Array) -> Colour:
    """Returns the colour of a post or of a surface without a pattern."""
    u = (planes[n, 3] * px + planes[n, 4] * py + planes[n, 5]) * w
    light = (planes[n, 9] * px + planes[n, 10] * py + planes[n, 11]) * w
    if kind == POST:
        return _post(u, (planes[n, 6] * px + planes[n, 7] * py + planes[n, 8]) * w, light)
    p = kind - PLAIN
    r = palette[p, 0] * light + u * 0.80 + palette[p, 3]
    g = palette[p, 1] * light + u * 0.90 + palette[p, 4]
    return r, g, palette[p, 2] * light + u + palette[p, 5]


@inlined
def _is_whole(ids: NDArray[np.int32], row: int, i: int) -> bool:
    """Returns whether all samples of a pixel see the same triangle."""
    n0, n1, n2, n3 = ids[4 * row, i], ids[4 * row + 1, i], ids[4 * row + 2, i], ids[4 * row + 3, i]
    return bool(n0 == n1 and n0 == n2 and n0 == n3)


@inlined
def _gather(
    ids: NDArray[np.int32], depth: NDArray[np.float32], kinds: NDArray[np.int64], row: int, i: int,
    shares: NDArray[np.int64],
) -> None:  # fmt: skip
    """Writes into ``shares`` how many of a pixel's four samples each sample represents; 0 if an earlier
    sample represents it.

    A sample represents a later one that shows the same triangle, or the same kind of ground at almost the
    same depth.
    """
    for k in range(4):
        shares[k] = 1
        n, near = ids[4 * row + k, i], depth[4 * row + k, i]
        for j in range(k):
            m, other = ids[4 * row + j, i], depth[4 * row + j, i]
            is_same = n == m
            if not is_same and n >= 0 and m >= 0 and kinds[n] < POST and kinds[n] == kinds[m]:
                is_same = abs(near - other) < ALIKE * near
            if shares[j] > 0 and is_same:
                shares[j] += 1
                shares[k] = 0
                break


@inlined
def _place(row: int, i: int, k: int, is_whole: bool) -> tuple[float, float]:
    """Returns the position in the image, in pixels, of the k-th sample of a pixel; if ``is_whole``, that of
    the pixel's middle."""
    if is_whole:
        return i + 0.5, row + 0.5
    return i + OFFSETS[k], row + (k + 0.5) * 0.25


@inlined
def _ray(eye: Array, px: float, py: float, rows: int, columns: int, pixel: float) -> Colour:
    """Returns the direction in which a point of the image is seen, as a vector in world coordinates with
    depth 1; ``pixel`` is the width of a pixel at depth 1."""
    rx, ry = (px - columns * 0.5) * pixel, (py - rows * 0.5) * pixel
    return (
        eye[3] * rx + eye[6] * ry + eye[9],
        eye[4] * rx + eye[7] * ry + eye[10],
        eye[5] * rx + eye[8] * ry + eye[11],
    )


@inlined
def _haze_and_level(w: float, dx: float, dy: float, dz: float, pixel: float) -> tuple[float, float, float]:
    """Returns three numbers for a point at depth w in the direction (dx, dy, dz): the arguments ``thin`` and
    ``warm`` of `hazy`, and the base-2 logarithm of the width in metres of a pixel on level ground there."""
    far = math.sqrt(dx * dx + dy * dy + dz * dz)
    thin, warm = air(w * far, (dx * SUN_X + dy * SUN_Y) / far)
    return thin, warm, 0.5 * math.log2(w * w * pixel * pixel * far / max(abs(dz), 0.02 * far))


@inlined
def _sky(tiles: Tiles, dx: float, dy: float, dz: float) -> Colour:
    short = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz)
    return sky(tiles, dx * short, dy * short, dz * short)


@compiled
def shade(
    buffers: RenderBuffers, palette: Array, tiles: Tiles, eye: Array, lanes: LaneBoundaries, numbers: Array
) -> None:
    """Colours all pixels of the picture from the four samples of each pixel.

    Haze and level of detail change slowly, so they are computed once for BLOCK neighbouring pixels.

    Args:
        buffers: the samples that `raster.draw` has filled, and the picture.
        palette: (n, 6): for each surface type without a pattern, its colour and the colour of the light that
            it emits.
        tiles: the noise tiles from `textures.noise`.
        eye: the camera, as in `raster.draw`.
        lanes: boundaries of the road's lanes.
        numbers: data for the car's shadow: the point on the ground below the car's centre of gravity (3
            numbers), the car's direction (2), its length, its width, how far its middle is ahead of that
            point, and 1 if there is a car, else 0.
    """
    ids, depth, planes = buffers.ids, buffers.depth, buffers.planes
    kinds, picture = buffers.kinds, buffers.picture
    rows, columns = picture.shape[0], picture.shape[1]
    pixel = 1.0 / eye[12]
    shares = np.zeros(4, np.int64)
    for row in range(rows):
        last = -2
        level = thin = warm = r = g = b = 0.0
        for i in range(columns):
            red = green = blue = 0.0
            is_whole = _is_whole(ids, row, i)
            if not is_whole:
                _gather(ids, depth, kinds, row, i, shares)
            for k in range(1 if is_whole else 4):
                if not is_whole and shares[k] == 0:
                    continue
                n = ids[4 * row + k, i]
                px, py = _place(row, i, k, is_whole)
                dx, dy, dz = _ray(eye, px, py, rows, columns, pixel)
                is_new = n != last or not is_whole or i % BLOCK == 0
                if n >= 0:
                    w = 1.0 / max(planes[n, 0] * px + planes[n, 1] * py + planes[n, 2], 1e-6)
                    if is_new:
                        thin, warm, level = _haze_and_level(w, dx, dy, dz, pixel)
                    if kinds[n] < POST:
                        r, g, b = _ground(
                            n, px, py, w, dx, dy, dz, level, planes, kinds[n] == ROAD, tiles, eye, lanes,
                            numbers,
                        )  # fmt: skip
                    else:
                        r, g, b = _thing(n, px, py, w, planes, kinds[n], palette)
                    r, g, b = hazy(r, g, b, thin, warm)
                elif is_new or i % 2 == 0 or dz < RIDGES:
                    r, g, b = _sky(tiles, dx, dy, dz)
                last = n if is_whole else -2
                part = 1.0 if is_whole else shares[k] * 0.25
                red, green, blue = red + r * part, green + g * part, blue + b * part
            picture[row, i, 0], picture[row, i, 1], picture[row, i, 2] = red, green, blue


@compiled
def panorama(tiles: Tiles, lowest: float, picture: NDArray[np.float32]) -> None:
    """Fills a picture of the whole sky. Its columns go around counter-clockwise from +x. With v from 0 below
    to 1 above, the elevation of a row is ``lowest`` + (pi / 2 - ``lowest``) v^2 radians."""
    rows, columns = picture.shape[0], picture.shape[1]
    for row in range(rows):
        up = lowest + (math.pi / 2 - lowest) * (1.0 - (row + 0.5) / rows) ** 2
        for i in range(columns):
            turn, level = 2 * math.pi * (i + 0.5) / columns, math.cos(up)
            r, g, b = sky(tiles, level * math.cos(turn), level * math.sin(turn), math.sin(up))
            picture[row, i, 0], picture[row, i, 1], picture[row, i, 2] = r, g, b


@compiled
def to_screen(picture: NDArray[np.float32], table: NDArray[np.uint8], out: NDArray[Any]) -> None:
    """Converts linear light to bytes; values above 0.7 are compressed first, so that highlights do not
    clip."""
    rows, columns = picture.shape[0], picture.shape[1]
    for row in range(rows):
        for i in range(columns):
            for k in range(3):
                c = picture[row, i, k]
                if c > 0.7:
                    c = 0.7 + 0.3 * (1.0 - 1.0 / (1.0 + (c - 0.7) / 0.3))
                out[row, i, k] = table[int(min(c, 1.0) * (STEPS - 1) + 0.5)] if c > 0.0 else table[0]
