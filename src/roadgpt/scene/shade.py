"""Computes the colour of each pixel: surface, light, the shadow of the car, and haze.

Colours are computed from coordinates on the surface instead of texture images: the fraction of a pixel that
markings cover is computed exactly, and noise is filtered to the size of the pixel. Colours are linear until
`to_screen`."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.compiled import compiled, inlined
from roadgpt.geometry.curve import Array
from roadgpt.road import Profile
from roadgpt.road.profile import DASH, GAP
from roadgpt.scene.light import STEPS, SUN_X, SUN_Y, SUN_Z
from roadgpt.scene.mesh import PLAIN, POST, ROAD
from roadgpt.scene.patterns import (
    CLOUD,
    GRAIN,
    MEADOW,
    SIDE,
    Tiles,
    bump,
    dashed,
    fine_noise,
    length_of,
    plain_noise,
    share,
    smooth,
)
from roadgpt.scene.raster import OFFSETS, RenderBuffers

NONE, SOLID, BROKEN = 0, 1, 2  # kinds of markings
# Wider than the judged line (road.profile.LINE), and not at the very edge of the lane: the network of
# examples/vision was trained on such images, and with judged lines drives 0.24 m farther to the right.
LINE, INSET = 0.15, 0.10  # m: width of a line, and width of the asphalt outside an edge line
PAINT = {"none": NONE, "solid": SOLID, "broken": BROKEN, "double": SOLID}
"""How a boundary is drawn, by its marking; a double line is drawn as one line."""
PERIOD = DASH + GAP  # m from one dash to the next
WHEEL, TRACK, OIL = 0.79, 0.55, 0.60  # m: from mid-lane to a wheel track; half widths of track, oil
GRAVEL = 0.45  # m, width of the gravel between asphalt and grass
STONE = 90.0  # texels of asphalt's grain to a metre
HILLS = SIDE / (2.0 * math.pi)  # texels of the far hills to a radian
ASPHALT, PAINTED, STONES = 0.142, (0.80, 0.80, 0.77), (0.235, 0.215, 0.175)
"""Linear colours: the brightness of asphalt, road paint, and the gravel beside the asphalt."""
LUSH, DRIER = (0.078, 0.150, 0.026), (0.115, 0.075, 0.024)
"""Linear colour of lush grass, and what is added to it where the grass is dry."""
ROCKS = (0.21, 0.20, 0.19)
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
Colour = tuple[float, float, float]


class LaneBoundaries(NamedTuple):
    """The boundaries of all lanes, from left to right, at equally spaced stations."""

    offsets: Array  # offsets of the k boundaries in metres at each of n stations, (n, k)
    marks: NDArray[np.int64]  # type of lane marking on each boundary: NONE, SOLID or BROKEN, (k,)
    driven: int  # index of the left boundary of the lane in which the car drives
    spacing: float  # distance between the stations, metres
    length: float  # length of the road, metres

    @classmethod
    def of(cls, profile: Profile, length: float) -> "LaneBoundaries":
        """Returns the boundaries of the lanes of a road of this length in metres."""
        s = np.linspace(0.0, length, max(1, math.ceil(length)) + 1)
        rows = profile.boundaries(s)
        marks = np.array([PAINT[mark] for mark, _ in rows])
        offsets = np.ascontiguousarray(np.stack([t for _, t in rows], axis=1))
        return cls(offsets, marks, profile.boundaries_to_left, float(s[1]), length)


@inlined
def sky(tiles: Tiles, dx: float, dy: float, dz: float) -> Colour:
    """Returns the colour of the sky in a unit direction: blue above, bright and hazy at the horizon and
    around the sun, with thin clouds."""
    h = max(dz, 0.0)
    pale = 1.0 / (1.0 + 5.5 * h)
    r, g, b = 0.115 + 0.505 * pale, 0.29 + 0.445 * pale, 0.62 + 0.21 * pale
    if h > 0.015:
        reach = 1.0 / (h + 0.09)
        cover = fine_noise(tiles, CLOUD, 33.0 * dx * reach, 33.0 * dy * reach, 0.35 * reach - 1.0)
        thick = smooth(0.1, 2.2, cover) * smooth(0.015, 0.16, h) * 0.85
        r, g, b = r + (0.93 - r) * thick, g + (0.945 - g) * thick, b + (0.96 - b) * thick
    glow = max(dx * SUN_X + dy * SUN_Y + dz * SUN_Z, 0.0) ** 4
    haze = 0.16 * glow + 0.6 * glow**16
    r, g, b = r + haze, g + 0.92 * haze, b + 0.74 * haze
    if -0.01 < dz < 0.075:  # hills far away
        turn = math.atan2(dy, dx) * HILLS
        for ridge in range(2):
            top = 0.034 - 0.017 * ridge
            top += (0.0105 - 0.003 * ridge) * plain_noise(tiles, CLOUD, 0, SIDE, turn, 40.0 + 90.0 * ridge)
            top += 0.0011 * plain_noise(tiles, CLOUD, 0, SIDE, turn * 9.0, 10.0 + 50.0 * ridge)
            inside = smooth(-0.0011, 0.0011, top - dz) * (0.42 + 0.28 * ridge)
            r, g, b = r + (0.25 - r) * inside, g + (0.37 - g) * inside, b + (0.43 - b) * inside
    return r, g, b


@inlined
def grass(tiles: Tiles, x: float, y: float, level: float) -> Colour:
    """Returns the colour of grass at (x, y) in metres. ``level`` is the base-2 logarithm of the pixel's width
    in metres."""
    wide = plain_noise(tiles, CLOUD, 0, SIDE, x * 0.83, y * 0.83)
    blades = fine_noise(tiles, MEADOW, x * 31.0, y * 31.0, level + 4.95)
    dry = min(max(0.42 + 0.27 * wide + 0.06 * blades, 0.0), 1.0)
    tone = max(1.0 + 0.12 * wide + 0.20 * blades, 0.25)
    r, g, b = LUSH[0] + DRIER[0] * dry, LUSH[1] + DRIER[1] * dry, LUSH[2] + DRIER[2] * dry
    return r * tone, g * tone, b * tone


@inlined
def _bound(lanes: LaneBoundaries, s: float, j: int) -> float:
    last = lanes.offsets.shape[0] - 2
    at = min(max(s / lanes.spacing, 0.0), last + 1.0)
    i = min(int(at), last)
    found: float = lanes.offsets[i, j] + (lanes.offsets[i + 1, j] - lanes.offsets[i, j]) * (at - i)
    return found


@inlined
def asphalt(tiles: Tiles, s: float, t: float, lanes: LaneBoundaries, level: float) -> float:
    """Returns the brightness of asphalt at station s and offset t in metres, with grain and patches.

    The wheel tracks and the oily middle of a lane are darker. ``level`` is as in ``grass``."""
    grain = fine_noise(tiles, GRAIN, s * STONE, t * STONE, level + 6.5)
    patches = plain_noise(tiles, CLOUD, 0, SIDE, s * 1.3, t * 5.1)
    lane = WHEEL + TRACK  # m to the middle of the nearest lane
    for j in range(lanes.offsets.shape[1] - 1):
        from_middle = t - (_bound(lanes, s, j) + _bound(lanes, s, j + 1)) / 2
        if abs(from_middle) < abs(lane):
            lane = from_middle
    worn = bump(lane - WHEEL, TRACK) + bump(lane + WHEEL, TRACK)
    tone = 1.0 + 0.20 * grain + 0.06 * patches - (0.17 + 0.04 * patches) * worn - 0.10 * bump(lane, OIL)
    return ASPHALT * max(tone, 0.2)


@inlined
def _painted(mark: int, covered: float, s: float, wide_s: float, length: float) -> float:
    """Returns the share of a pixel that is paint, if a line covers ``covered`` of its width; ``wide_s`` is
    the pixel's length along the road in metres."""
    if mark == BROKEN and covered > 0.0:
        last, first = min(s + wide_s / 2, length), s - wide_s / 2
        covered *= max(dashed(last, DASH, PERIOD) - dashed(first, DASH, PERIOD), 0.0) / wide_s
    return 0.0 if mark == NONE else covered


@inlined
def paved(
    tiles: Tiles, s: float, t: float, wide_s: float, wide_t: float, level: float, lanes: LaneBoundaries
) -> Colour:
    """Returns the colour of the carriageway with its markings at station s and offset t in metres.

    The pixel is ``wide_s`` metres long and ``wide_t`` metres wide. ``level`` is as in ``grass``."""
    tone, length = asphalt(tiles, s, t, lanes, level), lanes.length
    r, g, b = tone, tone * 1.005, tone * 1.03
    paint, last = 0.0, lanes.offsets.shape[1] - 1
    left, right = _bound(lanes, s, 0), _bound(lanes, s, last)
    side, edge, at = (1.0, left, 0) if t > (left + right) / 2 else (-1.0, right, last)
    outer = side * edge - INSET
    if side * t > outer - LINE - wide_t:
        paint = _painted(lanes.marks[at], share(side * t, outer - LINE, outer, wide_t), s, wide_s, length)
    else:
        for j in range(1, last):
            t_line = t - _bound(lanes, s, j)
            if abs(t_line) < LINE + wide_t:
                covered = share(t_line, -LINE / 2, LINE / 2, wide_t)
                paint += _painted(lanes.marks[j], covered, s, wide_s, length)
    if paint > 0.0:
        worn = 0.93 + 0.06 * fine_noise(tiles, GRAIN, s * 40.0, t * 40.0, level + 5.3)
        paint = min(paint, 1.0) * min(max(worn, 0.0), 1.0)
        r, g, b = r + (PAINTED[0] - r) * paint, g + (PAINTED[1] - g) * paint, b + (PAINTED[2] - b) * paint
    if 1.5 < s < length - 1.5:
        return r, g, b
    # a white line where the driven lane begins, a chequered band where it ends
    left, right = _bound(lanes, s, lanes.driven), _bound(lanes, s, lanes.driven + 1)
    inside = share(t, 0.25 + right, left - 0.08, wide_t)
    white = inside * share(s, 0.25, 0.75, wide_s)
    goal = inside * share(s, length - 1.0, length, wide_s)
    square = (math.floor((t - left) * 8.0 / (left - right)) + math.floor((length - s) * 2.0)) & 1
    shade = 0.78 * square + 0.02
    r, g, b = r + (0.8 - r) * white, g + (0.8 - g) * white, b + (0.8 - b) * white
    return r + (shade - r) * goal, g + (shade - g) * goal, b + (shade - b) * goal


@inlined
def shoulder(tiles: Tiles, x: float, y: float, beside: float, ragged: float, level: float) -> Colour:
    """Returns the colour of the shoulder at (x, y), ``beside`` metres from the carriageway: gravel that turns
    into grass. ``ragged`` shifts this transition, and ``level`` is as in ``grass``."""
    r, g, b = grass(tiles, x, y, level)
    bare = 1.0 - smooth(0.1, 0.9, beside / GRAVEL + 3.5 * ragged)
    if bare > 0.0:
        tone = 1.0 + 0.22 * fine_noise(tiles, GRAIN, x * 26.0, y * 26.0, level + 4.7)
        r, g = r + (STONES[0] * tone - r) * bare, g + (STONES[1] * tone - g) * bare
        b += (STONES[2] * tone - b) * bare
    return r, g, b


@inlined
def road(
    tiles: Tiles,
    s: float,
    t: float,
    wide_s: float,
    wide_t: float,
    x: float,
    y: float,
    level: float,
    lanes: LaneBoundaries,
) -> Colour:
    """Returns the colour of the carriageway or the shoulder at station s and offset t in metres.

    (x, y) is the same point in world coordinates. The other arguments are as in ``paved``."""
    beside = max(t - _bound(lanes, s, 0), _bound(lanes, s, lanes.offsets.shape[1] - 1) - t)
    if beside < -0.3 - wide_t:
        return paved(tiles, s, t, wide_s, wide_t, level, lanes)
    ragged = 0.05 * fine_noise(tiles, CLOUD, s * 7.0, t * 7.0 + 90.0, level + 2.8)
    part = min(max((ragged * 0.5 - beside) / wide_t + 0.5, 0.0), 1.0)
    r, g, b = shoulder(tiles, x, y, beside, ragged, level)
    if part > 0.0:
        pr, pg, pb = paved(tiles, s, t, wide_s, wide_t, level, lanes)
        r, g, b = r + (pr - r) * part, g + (pg - g) * part, b + (pb - b) * part
    return r, g, b


@inlined
def _box(x: float, y: float, long: float, wide: float, soft: float) -> float:
    return smooth(-0.5, 0.5, (long - abs(x)) / soft) * smooth(-0.5, 0.5, (wide - abs(y)) / soft)


@inlined
def _shadow(car: Array, x: float, y: float, z: float) -> float:
    """Returns the share of light that remains at a point on the ground, without sun, and under the car
    without sky."""
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
    between the line of sight and the sun."""
    d = distance * (1.0 / HAZE)
    toward = max(toward, 0.0)
    return 1.0 / (1.0 + d * (0.9 + 2.2 * d)), 0.10 * toward * toward


@inlined
def _ground(
    n: int, px: float, py: float, w: float, dx: float, dy: float, dz: float, level: float, planes: Array,
    is_road: bool, tiles: Tiles, eye: Array, lanes: LaneBoundaries, numbers: Array,
) -> Colour:  # fmt: skip
    """Returns the colour at depth w in the direction (dx, dy, dz), a vector whose own depth is 1."""
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
        bare = (planes[n, 3] * px + planes[n, 4] * py + planes[n, 5]) * w
        if bare > 0.0:
            r, g, b = _rock(tiles, x, y, z, level, bare, r, g, b)
    if numbers[8] > 0.0:
        light *= _shadow(numbers, x, y, z)
    return r * light, g * light, b * light


@inlined
def _rock(
    tiles: Tiles, x: float, y: float, z: float, level: float, bare: float, r: float, g: float, b: float
) -> Colour:
    """Returns a colour in layers of rock, of which a share ``bare`` is seen through grass."""
    tone = 1.0 + 0.5 * fine_noise(tiles, CLOUD, x * 1.5 + y * 0.7, z * 14.0, level - 1.0)
    tone *= 1.0 + 0.3 * fine_noise(tiles, GRAIN, (x + y) * 9.0, z * 9.0, level + 3.2)
    r, g = r + (tone * ROCKS[0] - r) * bare, g + (tone * ROCKS[1] - g) * bare
    return r, g, b + (tone * ROCKS[2] - b) * bare


@inlined
def _thing(n: int, px: float, py: float, w: float, planes: Array, kind: int, palette: Array) -> Colour:
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
    n0, n1, n2, n3 = ids[4 * row, i], ids[4 * row + 1, i], ids[4 * row + 2, i], ids[4 * row + 3, i]
    return bool(n0 == n1 and n0 == n2 and n0 == n3)


@inlined
def _gather(
    ids: NDArray[np.int32], depth: NDArray[np.float32], kinds: NDArray[np.int64], row: int, i: int,
    shares: NDArray[np.int64],
) -> None:  # fmt: skip
    """Writes into ``shares`` how many of a pixel's four samples each represents; 0 if an earlier one
    represents it.

    A sample represents a later one that shows the same triangle, or the same kind of ground at almost the
    same depth."""
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
    """Returns where the k-th sample of a pixel, or its middle if ``is_whole``, is in the image, in pixels."""
    if is_whole:
        return i + 0.5, row + 0.5
    return i + OFFSETS[k], row + (k + 0.5) * 0.25


@inlined
def ray(eye: Array, px: float, py: float, rows: int, columns: int, pixel: float) -> Colour:
    """Returns the direction of a point of the image, with depth 1; a pixel there is ``pixel`` wide."""
    rx, ry = (px - columns * 0.5) * pixel, (py - rows * 0.5) * pixel
    return (
        eye[3] * rx + eye[6] * ry + eye[9],
        eye[4] * rx + eye[7] * ry + eye[10],
        eye[5] * rx + eye[8] * ry + eye[11],
    )


@inlined
def _haze_and_level(w: float, dx: float, dy: float, dz: float, pixel: float) -> tuple[float, float, float]:
    """Returns ``thin`` and ``warm`` of `hazy` for a point at depth w, and the base-2 logarithm of the width
    in metres of a pixel on level ground there."""
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
        palette: (n, 6), as `light.PALETTE`.
        tiles: the noise tiles from `patterns.noise`.
        eye: the camera, as in `raster.draw`.
        lanes: boundaries of the road's lanes.
        numbers: the car's shadow: the point on the ground below its centre of gravity (3 numbers), its
            direction (2), length and width, how far its middle is ahead of that point, and 1 if there is one.
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
                dx, dy, dz = ray(eye, px, py, rows, columns, pixel)
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
