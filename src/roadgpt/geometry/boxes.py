"""Boxes seen from above: their corners, how far two are apart, whether they touch, and where a line is in
one. Everything is in metres and radians; a box is its middle, its heading, its length and its width.

Two boxes are apart if a line along a side of one of them separates them (the separating axis theorem:
Gottschalk, Lin and Manocha 1996). The same lines say so for numbers, in machine code, and for arrays."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.compiled import compiled, inlined

Floats = NDArray[np.float64]
OUTLINE = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
"""Counter-clockwise from the rear right, in lengths and widths."""
CORNER = 0.02  # m, within which a corner belongs to the place of contact
PARALLEL = np.radians(20.0)  # two sides at a smaller angle meet flat; else a corner meets a side


def turned(points: Floats, angle: Floats | float) -> Floats:
    """Returns points (..., 2) turned about the origin by angles that broadcast with their coordinates."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([x * c - y * s, x * s + y * c], axis=-1)


def corners(middle: Floats, heading: Floats | float, size: Floats) -> Floats:
    """Returns the corners (..., 4, 2) of boxes, counter-clockwise from the rear right, from their middles
    (..., 2), headings (...) and sizes, whose first two columns are lengths and widths."""
    angle = np.asarray(heading, float)[..., None]
    return np.asarray(middle)[..., None, :] + turned(OUTLINE * np.asarray(size)[..., None, :2], angle)


def along(vector: Any, heading: Any, heading_2: Any) -> tuple[Any, ...]:
    """Returns how far a vector, x and y, leads along and across a first box and along and across a second."""
    dx, dy, c, s = vector[0], vector[1], np.cos(heading), np.sin(heading)
    c_2, s_2 = np.cos(heading_2), np.sin(heading_2)
    return dx * c + dy * s, dy * c - dx * s, dx * c_2 + dy * s_2, dy * c_2 - dx * s_2


def reach(heading: Any, size: Any, heading_2: Any, size_2: Any) -> tuple[Any, ...]:
    """Returns how far two boxes with one middle reach together, in the order of ``along``; a size is length
    and width."""
    c, s = np.abs(np.cos(heading_2 - heading)), np.abs(np.sin(heading_2 - heading))
    return (
        (size[0] + size_2[0] * c + size_2[1] * s) / 2,
        (size[1] + size_2[0] * s + size_2[1] * c) / 2,
        (size_2[0] + size[0] * c + size[1] * s) / 2,
        (size_2[1] + size[0] * s + size[1] * c) / 2,
    )


def separation(away: Floats, heading: Floats, size: Floats, heading_2: Floats, size_2: Floats) -> Floats:
    """Returns by how many metres pairs of boxes are apart along the normals of their sides, shape (..., 4),
    see ``along``. The largest of the four is negative exactly if they overlap, and never larger than their
    distance. ``away`` (..., 2) leads from the middle of the first to that of the second."""
    far, near = along(away.T, heading, heading_2), reach(heading, size.T, heading_2, size_2.T)
    return np.stack([np.abs(one) - two for one, two in zip(far, near, strict=True)], axis=-1)


def distance(away: Floats, heading: Floats, size: Floats, heading_2: Floats, size_2: Floats) -> Floats:
    """Returns the distance between boxes, from a corner of one to the other one, or 0; see ``separation``."""
    least = np.full(len(away), np.inf)
    for middle, mine, own, its, other in (
        (away, heading, size, heading_2, size_2),
        (-away, heading_2, size_2, heading, size),
    ):
        beyond = np.abs(turned(corners(middle, its, other), -mine[:, None])) - own[:, None] / 2
        least = np.minimum(least, np.hypot(*np.moveaxis(np.maximum(beyond, 0.0), -1, 0)).min(axis=1))
    apart = separation(away, heading, size, heading_2, size_2).max(axis=-1)
    return np.where(apart < 0, 0.0, least)


class Touch(NamedTuple):
    """How two boxes touch."""

    spot: Floats
    """The middle of the place (x, y)."""
    faces: tuple[str, ...]
    """The side of each that is touched: front, rear, left or right."""
    place: float
    """Where on the face of the first one that is, as a share: of front and rear from the left, of the sides
    from the front."""


def touching(place: Floats, heading: Floats, size: Floats) -> Touch:
    """Returns how two boxes touch, from their middles (2, 2), headings (2,) and sizes (2, 2)."""
    outlines = corners(place, heading, size)
    inside = [
        point
        for mine in (0, 1)
        for point in outlines[mine]
        if (np.abs(turned(point - place[1 - mine], -heading[1 - mine])) <= size[1 - mine] / 2 + CORNER).all()
    ]
    spot = np.mean(inside, axis=0) if inside else place.mean(axis=0)
    away = place[1] - place[0]
    apart = separation(away, heading[0], size[0], heading[1], size[1])
    faces = tuple(
        _face(n, away * (1 - 2 * n), heading, apart, turned(spot - place[n], -heading[n])) for n in (0, 1)
    )
    ahead, left = turned(spot - place[0], -heading[0]) / size[0]
    share = 0.5 - (left if faces[0] in ("front", "rear") else ahead)
    return Touch(spot, faces, float(np.clip(share, 0.0, 1.0)))


def _face(mine: int, away: Floats, heading: Floats, apart: Floats, spot: Floats) -> str:
    """Returns with which side box ``mine``, 0 or 1, met the other, which is ``away`` from it: that along the
    line on which both are ``apart`` the most. A corner that meets a side is one of the front or the rear, as
    with nuPlan; ``spot`` is where it is."""
    flat, is_across = divmod(int(apart.argmax()), 2)
    ahead, left = turned(away, -heading[mine])
    turn = (heading[mine] - heading[flat] + np.pi / 4) % np.pi - np.pi / 4  # -45 to 135 degrees
    is_crossed = turn > np.pi / 4
    if abs(turn - is_crossed * np.pi / 2) > PARALLEL:
        return "front" if spot[0] > 0 else "rear"
    if is_across != is_crossed:
        return "left" if left > 0 else "right"
    return "front" if ahead > 0 else "rear"


_along, _reach = inlined(along), inlined(reach)


@compiled
def touch(
    dx: float, dy: float, heading: float, length: float, width: float, heading_2: float, length_2: float,
    width_2: float,
) -> bool:  # fmt: skip
    """Returns whether two boxes touch; ``dx`` and ``dy`` lead from the middle of the first to that of the
    second."""
    if 2.0 * math.hypot(dx, dy) > math.hypot(length, width) + math.hypot(length_2, width_2):
        return False
    far = _along((dx, dy), heading, heading_2)
    near = _reach(heading, (length, width), heading_2, (length_2, width_2))
    return bool(
        abs(far[0]) <= near[0]
        and abs(far[1]) <= near[1]
        and abs(far[2]) <= near[2]
        and abs(far[3]) <= near[3]
    )


@inlined
def part_inside(
    dx: float, dy: float, forward: float, left: float, heading: float, length: float, width: float,
    low: float, high: float,
) -> tuple[float, float]:  # fmt: skip
    """Returns between which multiples of its direction, from ``low`` to ``high``, a line is in a box; the
    first is the larger one if it is not. ``(dx, dy)`` leads from the middle of the box to a place on the line
    and ``(forward, left)`` is the line's direction, both in the plane's axes."""
    c, s = math.cos(heading), math.sin(heading)
    for axis in range(2):
        here, slope = dx * c + dy * s, forward * c + left * s
        if axis == 1:
            here, slope = dy * c - dx * s, left * c - forward * s
        room = (length if axis == 0 else width) / 2.0
        if abs(slope) < 1e-9:
            if abs(here) > room:
                return 1.0, 0.0
        else:
            one, two = (-room - here) / slope, (room - here) / slope
            low, high = max(low, min(one, two)), min(high, max(one, two))
    return low, high
