"""Computes the centre line of a draft, checks that it keeps clear of itself, and places it on the map.

The planner lays out hundreds of drafts for one road. The curve is therefore approximated in steps of about 1
m; points are off by a few centimetres at most. The road that is built from the chosen draft is exact, and
every rule checks it again."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy

from roadgpt.brief.element import Element
from roadgpt.brief.map_fit import EDGE
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex, meeting
from roadgpt.road import World

STEP = 1.0  # m between points of the walked line
COARSE = 3  # points of the walked line from one point of the test for overlap to the next
NEIGHBOURS = 26.0  # m along the road: closer places cannot meet (half a circle of 14 m radius is 44 m)
OF_WIDE = 1.2  # the same for wide roads, as a multiple of the distance that they keep
COARSENESS = 0.6  # m by which coarse points may overestimate a distance
SPARE = 0.7  # m between two carriageways, where there is no room for the shoulders
DIAGONALS = np.array([45.0, 135.0, 225.0, 315.0])  # degrees: headings at which a straight has most room
HEADINGS = 72  # number of headings that are tried if the first one does not fit on the map
TENTHS_OFF = 150  # of a degree by which a start may miss the heading that is required
MOST_POINTS = 700  # of a line with twice as many or more, only the convex hull is looked at
STARTS_AT = (0.0, 6.0)  # m, range of the height of the lowest place of a draft


class PlanLine(NamedTuple):
    """The approximate centre line of a draft; it starts at the origin and heads along +x."""

    s: Array  # stations in metres, about 1 m apart, ``(n,)``
    z: Complex  # points as x + iy in metres, ``(n,)``


class MapPose(NamedTuple):
    """The start of a road on the map: x and y in metres, heading ``theta`` in degrees."""

    x: float
    y: float
    theta: float


class PlacedPlan(NamedTuple):
    """The elements of a draft, their centre line, and the start of the road on the map."""

    elements: Sequence[Element]
    line: PlanLine
    place: MapPose


def walk(elements: Sequence[Element], steps: int | None = None) -> PlanLine:
    """Returns the centre line of elements, in ``steps`` equal steps; None: in steps of about 1 m."""
    knots, bends, length = bends_of(elements)
    s = np.linspace(0.0, length, (steps or max(2, round(length / STEP))) + 1)
    steps = np.exp(1j * _headings(s[:-1] + s[1] / 2, knots, bends)) * s[1]
    return PlanLine(s, np.concatenate([[0j], np.cumsum(steps)]))


def bends_of(elements: Sequence[Element]) -> tuple[Array, Array, float]:
    """Returns stations in metres, the curvature at each in 1/m, and the length of the elements in metres. The
    curvature is linear between two stations, and 0 after the last one."""
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
    spans = np.diff(knots)
    reached = np.concatenate([[0.0], np.cumsum(spans * (bends[1:] + bends[:-1]) / 2)])
    slopes = np.append(np.diff(bends) / np.maximum(spans, 1e-9), 0.0)
    i = np.searchsorted(knots, s, side="right") - 1
    u = s - knots[i]
    return np.asarray(reached[i] + u * (bends[i] + u * slopes[i] / 2))


def keeps_clear(line: PlanLine, world: World, with_shoulders: bool) -> bool:
    """Returns whether no two parts of the road overlap and, if ``with_shoulders``, carriageways keep off each
    other's shoulders."""
    apart = world.section.road_width + (world.section.shoulder if with_shoulders else SPARE) + COARSENESS
    s, z = line.s[::COARSE], line.z[::COARSE]
    return not meets(z, s, z, s, apart)


def meets(z: Complex, s: Array, earlier: Complex, earlier_s: Array, apart: float) -> bool:
    """Returns whether a part of a road comes closer than ``apart`` metres to an earlier part, or to itself;
    for the arguments see ``geometry.nearness.meeting``."""
    return bool(len(meeting(z, s, earlier, earlier_s, apart, neighbours(apart))[0]))


def neighbours(apart: float) -> float:
    """Returns the distance in metres along a road within which no two places can come closer to each other
    than ``apart`` metres because the road comes back."""
    return max(NEIGHBOURS, OF_WIDE * apart)


def drawn_headings(rng: np.random.Generator, heading: float | None) -> Array:
    """Returns the headings of a start to try, in degrees: all round or, if a heading is required, near it."""
    if heading is None:
        return rng.integers(3600) / 10 + np.arange(HEADINGS) * (360 / HEADINGS)
    return heading + rng.integers(-TENTHS_OFF, TENTHS_OFF + 1, HEADINGS) / 10


def place(
    line: PlanLine, world: World, rng: np.random.Generator, reach: float = 0.0, heading: float | None = None
) -> MapPose | None:
    """Returns a random start and heading at which the road lies on the map; None if none was found. ``reach``
    is the distance in metres from the line to the edge of the widest road, if wider than usual. ``heading``
    is the heading of the start in degrees, if one is required; it may be missed by 15 degrees."""
    half = max(world.section.road_width / 2, reach)
    room = world.site.map_size - 2 * half - 2 * EDGE
    turns = drawn_headings(rng, heading)
    z = outermost(line.z)
    chosen = first_that_fits(z, turns[:1], room)
    if chosen is None:
        rng.shuffle(turns)
        chosen = first_that_fits(line.z[::2] if z is line.z else z, turns, room - 0.2)
    if chosen is None and not line.z.imag.any() and (heading is None or heading in DIAGONALS):
        chosen = first_that_fits(line.z, rng.permutation(DIAGONALS if heading is None else [heading]), room)
    if chosen is None:
        return None
    theta, left, low, width, height = chosen
    border = half + EDGE
    x = border - left + rng.random() * max(room - width, 0.0)
    y = border - low + rng.random() * max(room - height, 0.0)
    return MapPose(round(x, 2), round(y, 2), round(theta % 360, 1) % 360)


def outermost(z: Complex) -> Complex:
    """Returns the points of a long line that can touch a box around it; all points of a shorter line."""
    if len(z) < 2 * MOST_POINTS or not z.imag.any():
        return z
    return np.asarray(z[scipy.spatial.ConvexHull(np.stack([z.real, z.imag], axis=1)).vertices])


def drawn_ground(world: World, rng: np.random.Generator) -> float:
    """Returns a random height in metres for the lowest place of a draft."""
    low, high = STARTS_AT
    return max(low, world.site.z_floor + 1) + float(rng.random()) * (high - low)


def boxes(z: Complex, thetas: Array) -> tuple[Array, Array, Array, Array]:
    """Returns the left edges, lower edges, widths and heights, ``(m,)`` each, of the bounding boxes of the
    points x + iy after each rotation about the origin, by ``thetas`` in degrees, ``(m,)``."""
    turned = np.exp(1j * np.radians(thetas))[:, None] * z
    left, low = turned.real.min(axis=1), turned.imag.min(axis=1)
    return left, low, turned.real.max(axis=1) - left, turned.imag.max(axis=1) - low


def first_that_fits(
    z: Complex, thetas: Array, room: float
) -> tuple[float, float, float, float, float] | None:
    """Returns the first rotation in degrees at which the box of the points is no larger than ``room`` metres,
    and the left edge, lower edge, width and height of that box; None if there is no such rotation."""
    found = boxes(z, thetas)
    fits = np.flatnonzero(np.maximum(found[2], found[3]) <= room)
    if not fits.size:
        return None
    i = int(fits[0])
    left, low, width, height = (float(edge[i]) for edge in found)
    return float(thetas[i]), left, low, width, height


def smallest_box(line: PlanLine) -> float:
    """Returns the side in metres of the smallest square around the line, over headings 5 degrees apart."""
    _, _, width, height = boxes(outermost(line.z), np.arange(0.0, 90.0, 5.0))
    return float(np.maximum(width, height).min())
