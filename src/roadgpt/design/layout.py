"""The plan of a draft, fast and to a centimetre, and its place on the map.

Hundreds of drafts may have to be laid out for one road, so the curve is walked in short steps instead of
being solved; the road that is built in the end is exact, and is judged again.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from roadgpt.brief.element import Element
from roadgpt.brief.map_fit import EDGE
from roadgpt.geometry.curve import Array
from roadgpt.road import World

STEP = 1.0  # m between points of the walked line
COARSE = 3  # points of the walked line from one point of the test for overlap to the next
NEIGHBOURS = (
    26.0  # m along the road: places nearer than this cannot meet (half a circle of 14 m radius is 44 m)
)
MANY = 700  # points from which on near ones are looked up in a tree: all pairs of them would take long
SOME = 300  # points of a long line that are laid on the map before all are
COARSENESS = 0.6  # m that the coarse points may see legs further apart than they are
SPARE = 0.7  # m that carriageways are kept apart at least, where there is no room for the shoulders
DIAGONALS = np.array([45.0, 135.0, 225.0, 315.0])  # headings at which a straight road has most room
HEADINGS = 72  # that are tried on a map where the first one does not fit

Complex = NDArray[np.complex128]


class PlanLine(NamedTuple):
    """An approximate centre line that starts at the origin along +x: stations, and points as x + iy."""

    s: Array
    z: Complex


class MapPose(NamedTuple):
    """The position of a line on the map: start in metres, heading in degrees."""

    x: float
    y: float
    theta: float


class PlacedPlan(NamedTuple):
    """The elements of a draft, their centre line, and where it lies on the map."""

    elements: Sequence[Element]
    line: PlanLine
    place: MapPose


def walk(elements: Sequence[Element]) -> PlanLine:
    """Returns the centre line of elements, in steps of about a metre."""
    knots, bends, length = bends_of(elements)
    s = np.linspace(0.0, length, max(2, round(length / STEP)) + 1)
    steps = np.exp(1j * _headings(s[:-1] + s[1] / 2, knots, bends)) * s[1]
    return PlanLine(s, np.concatenate([[0j], np.cumsum(steps)]))


def bends_of(elements: Sequence[Element]) -> tuple[Array, Array, float]:
    """Returns stations (m), curvatures there (1/m, linear in between, 0 after the last) and the length."""
    knots, bends, at = [0.0], [0.0], 0.0
    for element in elements:
        length = element.length
        if element.turn:
            k, transition = element.curvature, element.transition
            knots += [at, at + transition, at + length - transition, at + length]
            bends += [0.0, k, k, 0.0]
        at += length
    return np.array(knots), np.array(bends), at


def _headings(s: Array, knots: Array, bends: Array) -> Array:
    """Radians at stations, where the curvature runs linearly from knot to knot, and is 0 after the last."""
    spans = np.diff(knots)
    reached = np.concatenate([[0.0], np.cumsum(spans * (bends[1:] + bends[:-1]) / 2)])
    slopes = np.append(np.diff(bends) / np.maximum(spans, 1e-9), 0.0)
    i = np.searchsorted(knots, s, side="right") - 1
    u = s - knots[i]
    return np.asarray(reached[i] + u * (bends[i] + u * slopes[i] / 2))


def keeps_clear(line: PlanLine, world: World, with_shoulders: bool) -> bool:
    """Returns whether no two parts of the road overlap: carriageways, and with the shoulders if asked for."""
    z = line.z[::COARSE]
    spacing = COARSE * (line.s[1] - line.s[0])
    apart = world.road_width + (world.verge if with_shoulders else SPARE) + COARSENESS
    first = int(NEIGHBOURS / spacing) + 1
    if len(z) <= first:
        return True
    if len(z) > MANY:
        near_pairs = cKDTree(np.stack([z.real, z.imag], axis=1)).query_pairs(apart, output_type="ndarray")
        return not (np.abs(near_pairs[:, 1] - near_pairs[:, 0]) >= first).any()
    dx, dy = z.real[:, None] - z.real, z.imag[:, None] - z.imag
    near = dx * dx + dy * dy < apart * apart
    return not np.triu(near, first).any()


def place(line: PlanLine, world: World, rng: np.random.Generator) -> MapPose | None:
    """Draws a place and a heading at which the road fits on the map; None where there is none."""
    room = world.map_size - world.road_width - 2 * EDGE
    turns = rng.integers(3600) / 10 + np.arange(HEADINGS) * (360 / HEADINGS)
    chosen = _extent(line.z, turns[:1], room)
    if chosen is None:
        rng.shuffle(turns)
        if _may_fit(line.z, turns, room):
            chosen = _extent(line.z[::2], turns, room - 0.2)
    if chosen is None and _is_straight(line):
        chosen = _extent(line.z, rng.permutation(DIAGONALS), room)
    if chosen is None:
        return None
    theta, left, low, width, height = chosen
    border = world.road_width / 2 + EDGE
    x = border - left + rng.random() * max(room - width, 0.0)
    y = border - low + rng.random() * max(room - height, 0.0)
    return MapPose(round(x, 2), round(y, 2), round(theta % 360, 1) % 360)


def _may_fit(z: Complex, thetas: Array, room: float) -> bool:
    """Do some points of a long line fit at some heading? If they do not, the line does not either."""
    every = 2 * (len(z) // (2 * SOME))
    return every < 2 or _extent(z[::every], thetas, room) is not None


def _is_straight(line: PlanLine) -> bool:
    return not line.z.imag.any()


def _extent(z: Complex, thetas: Array, room: float) -> tuple[float, float, float, float, float] | None:
    """The first heading at which the line is no wider and no higher than ``room``; its box from the start."""
    turned = np.exp(1j * np.radians(thetas))[:, None] * z
    left, low = turned.real.min(axis=1), turned.imag.min(axis=1)
    width, height = turned.real.max(axis=1) - left, turned.imag.max(axis=1) - low
    fits = np.flatnonzero((width <= room) & (height <= room))
    if not fits.size:
        return None
    i = int(fits[0])
    return float(thetas[i]), float(left[i]), float(low[i]), float(width[i]), float(height[i])


def smallest_box(line: PlanLine) -> float:
    """Returns the side in metres of the smallest square that holds the line at some heading."""
    turned = np.exp(1j * np.radians(np.arange(0, 90, 5)))[:, None] * line.z[:: max(1, len(line.z) // MANY)]
    return float(np.maximum(np.ptp(turned.real, axis=1), np.ptp(turned.imag, axis=1)).min())
