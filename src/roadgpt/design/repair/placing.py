"""Moves a road inside the map, and turns it only where moving is not enough: the least turn, computed.

The ribbon fits at a heading when the box around its hull is no larger than the map. While the same corners
are outermost, the width of the box is c * cos(turn + angle), so the turns at which it is just as wide as the
map are computed; the least of them that fits is the least there is.
"""

import math

import numpy as np
from scipy.spatial import ConvexHull

from roadgpt.check.ribbon import sides
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, Road, World, build

EDGE = 0.1  # m kept free between ribbon and border: for rounding, and what edges bulge between samples
BEYOND = 1.05  # m that SBFT's spline may run on behind either end
ROUNDED = 0.02  # m by which a turn that was rounded may be too wide
QUARTER = math.pi / 2
ROUNDING = 1e-9  # radians
PORTION = 64  # turns that are tried at once
CENTIMETRE, HUNDREDTH = 100.0, 100.0  # per metre, per degree: how the start is written


def placed(design: Design, world: World) -> Design | None:
    """Returns the design moved, and if need be rotated, onto the map; None where the road is too large.

    It is moved no further than is needed, and turned about the middle of the road by the least angle.
    """
    corners = _corners(build(design), world)
    room = world.map_size - 2 * EDGE
    turn = _least_turn(corners, room)
    if turn is None:
        return None
    x, y, z = design.starting_point
    theta = design.theta
    pivot = (corners.min(axis=0) + corners.max(axis=0)) / 2
    if turn:
        theta = round((theta + math.degrees(turn)) * HUNDREDTH) / HUNDREDTH
        turn = math.radians(theta - design.theta)
        x, y = _turned(np.array([[x, y]]) - pivot, turn)[0] + pivot
        corners = _turned(corners - pivot, turn) + pivot
    low, high = corners.min(axis=0), corners.max(axis=0)
    least, most = EDGE - low, world.map_size - EDGE - high
    move = np.where(least > most, (least + most) / 2, np.clip(0.0, least, most))
    if turn or move.any():
        x, y = (round(float(v) * CENTIMETRE) / CENTIMETRE for v in (x + move[0], y + move[1]))
    return design.model_copy(update={"starting_point": (x, y, z), "theta": theta % 360})


def _corners(road: Road, world: World) -> Array:
    """Corners ``(n, 2)`` of the hull of the ribbon, with what a spline may run on behind its ends."""
    half = world.road_width / 2
    left, right = sides(road.sample(), world.profile.edges(road.sample().s))
    ends = np.array([-BEYOND, road.length + BEYOND])
    behind = np.concatenate([_straight_on(road, s, t) for s in ends for t in (-half, half)])
    points = np.concatenate([left, right, behind])
    return np.asarray(points[ConvexHull(points).vertices])


def _straight_on(road: Road, s: float, t: float) -> Array:
    """The edge's point at a station before the start or behind the end, straight on from there."""
    end = min(max(s, 0.0), road.length)
    heading = float(road.heading(end))
    along = np.array([math.cos(heading), math.sin(heading)])
    return np.asarray(road.at(end, t)[:2] + (s - end) * along)[None]


def _turned(points: Array, by: float) -> Array:
    c, s = math.cos(by), math.sin(by)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def _least_turn(corners: Array, room: float) -> float | None:
    """The turn of least size, radians, at which the box is no wider and no higher than ``room``."""
    if np.ptp(corners, axis=0).max() <= room:
        return 0.0
    if np.ptp(corners, axis=0).max() > math.sqrt(2) * room:  # longer than the map is from corner to corner
        return None
    # by a quarter turn the box is the same again; between two turns at which a side lies along an axis,
    # the same corners are outermost
    sides_of_hull = np.roll(corners, -1, axis=0) - corners
    along = -np.arctan2(sides_of_hull[:, 1], sides_of_hull[:, 0])
    ends = np.unique(np.append((along + QUARTER / 2) % QUARTER, [0.0, QUARTER])) - QUARTER / 2
    middles = (ends[:-1] + ends[1:]) / 2
    turns = [0.0]
    for quarter in (0.0, QUARTER):  # along x, along y
        c, s = np.cos(middles - quarter), np.sin(middles - quarter)
        projected = corners[:, :1] * c - corners[:, 1:] * s
        apart = corners[projected.argmax(axis=0)] - corners[projected.argmin(axis=0)]
        size, angle = np.hypot(apart[:, 0], apart[:, 1]), np.arctan2(apart[:, 1], apart[:, 0])
        swing = np.arccos(np.minimum(room / size, 1.0))
        for turn in (swing - angle + quarter, -swing - angle + quarter):
            turn = (turn + np.pi) % (2 * np.pi) - np.pi
            turns += turn[(turn >= ends[:-1] - ROUNDING) & (turn <= ends[1:] + ROUNDING)].tolist()
    return _least_fitting(corners, room, np.array(sorted(turns, key=abs)))


def _least_fitting(corners: Array, room: float, turns: Array) -> float | None:
    """The first of some turns at which the box fits."""
    for some in np.array_split(turns, max(1, len(turns) // PORTION)):
        c, s = np.cos(some), np.sin(some)
        width = np.ptp(corners[:, :1] * c - corners[:, 1:] * s, axis=0)
        height = np.ptp(corners[:, :1] * s + corners[:, 1:] * c, axis=0)
        fits = np.flatnonzero(np.maximum(width, height) <= room + ROUNDED)
        if fits.size:
            return float(some[fits[0]])
    return None
