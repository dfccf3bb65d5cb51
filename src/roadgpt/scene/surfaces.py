"""Computes linear colours in compiled code: colours of the sky, and colours of terrain and road before light
and shadow are applied.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.road import Profile
from roadgpt.road.profile import DASH, GAP
from roadgpt.scene.compiled import inlined
from roadgpt.scene.light import SUN_X, SUN_Y, SUN_Z
from roadgpt.scene.patterns import Tiles, bump, dashed, fine_noise, plain_noise, share, smooth
from roadgpt.scene.textures import CLOUD, GRAIN, MEADOW, SIDE

Colour = tuple[float, float, float]
NONE, SOLID, BROKEN = 0, 1, 2  # kinds of markings


class LaneBoundaries(NamedTuple):
    """The boundaries of all lanes, from left to right, at equally spaced stations."""

    offsets: Array
    """Offsets of the k boundaries in metres at each of n stations, (n, k)."""
    marks: NDArray[np.int64]
    """Type of lane marking on each boundary: NONE, SOLID or BROKEN, (k,)."""
    driven: int
    """Index of the left boundary of the lane in which the car drives."""
    spacing: float
    """Distance between the stations, metres."""
    length: float
    """Length of the road, metres."""

    @classmethod
    def of(cls, profile: Profile, length: float) -> "LaneBoundaries":
        """Returns the boundaries of the lanes of a road of this length in metres."""
        s = np.linspace(0.0, length, max(1, math.ceil(length)) + 1)
        rows = profile.boundaries(s)
        marks = np.array([PAINT[mark] for mark, _ in rows])
        offsets = np.ascontiguousarray(np.stack([t for _, t in rows], axis=1))
        return cls(offsets, marks, profile.boundaries_to_left, float(s[1]), length)


# Wider than the judged line (road.profile.LINE), and not at the very edge of the lane: the network of
# examples/vision was trained on such images, and with judged lines drives 0.24 m farther to the right.
LINE, INSET = 0.15, 0.10  # m: width of a line, and width of the asphalt outside an edge line
PAINT = {"none": NONE, "solid": SOLID, "broken": BROKEN, "double": SOLID}
"""How a boundary is drawn, by its marking; a double line is drawn as one line."""
PERIOD = DASH + GAP  # m from one dash to the next
WHEEL, TRACK, OIL = 0.79, 0.55, 0.60  # m: from mid-lane to a wheel track; half widths of track, oil
GRAVEL = 0.45  # m, width of the gravel between asphalt and grass
STONE = 90.0  # texels of asphalt's grain to a metre
RIDGES = SIDE / (2.0 * math.pi)  # texels of the far hills to a radian
ASPHALT, PAINTED, STONES = 0.142, (0.80, 0.80, 0.77), (0.235, 0.215, 0.175)
"""Linear colours: the brightness of asphalt, road paint, and the gravel beside the asphalt."""
LUSH, DRIER = (0.078, 0.150, 0.026), (0.115, 0.075, 0.024)
"""Linear colour of lush grass, and what is added to it where the grass is dry."""


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
        turn = math.atan2(dy, dx) * RIDGES
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
    """Returns the offset of the j-th boundary of lanes at station s."""
    last = lanes.offsets.shape[0] - 2
    at = min(max(s / lanes.spacing, 0.0), last + 1.0)
    i = min(int(at), last)
    found: float = lanes.offsets[i, j] + (lanes.offsets[i + 1, j] - lanes.offsets[i, j]) * (at - i)
    return found


@inlined
def asphalt(tiles: Tiles, s: float, t: float, lanes: LaneBoundaries, level: float) -> float:
    """Returns the brightness of asphalt at station s and offset t in metres, with grain and patches.

    The wheel tracks and the oily middle of a lane are darker. ``level`` is as in ``grass``.
    """
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
    """Returns the share of a pixel that is paint, for a line that covers the share ``covered`` of the pixel's
    width across the road; ``wide_s`` is the length of the pixel along the road in metres."""
    if mark == BROKEN and covered > 0.0:
        last, first = min(s + wide_s / 2, length), s - wide_s / 2
        covered *= max(dashed(last, DASH, PERIOD) - dashed(first, DASH, PERIOD), 0.0) / wide_s
    return 0.0 if mark == NONE else covered


@inlined
def paved(
    tiles: Tiles, s: float, t: float, wide_s: float, wide_t: float, level: float, lanes: LaneBoundaries
) -> Colour:
    """Returns the colour of the carriageway with its markings at station s and offset t in metres.

    The pixel is ``wide_s`` metres long and ``wide_t`` metres wide. ``level`` is as in ``grass``.
    """
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

    (x, y) is the same point in world coordinates. The other arguments are as in ``paved``.
    """
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
