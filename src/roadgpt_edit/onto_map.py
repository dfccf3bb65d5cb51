"""Moves the road of a design onto the map."""

from math import cos, radians, sin

import numpy as np
import scipy

from roadgpt.check.ribbon import sides
from roadgpt.design.layout import boxes, first_that_fits
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex
from roadgpt.road import Design, Road, World, build

LEAST_EDGE = 0.1  # m between ribbon and border of a moved road, for rounding and the bulge between samples
BEYOND = 1.05  # m by which SBFT's spline may run on behind either end
CENTIMETRE, HUNDREDTH = 100.0, 100.0  # per metre, per degree: starts are rounded to these units
TURNS = np.array(sorted(range(-4500, 4501), key=abs)) / HUNDREDTH  # degrees, the smallest first
PORTIONS = 60  # parts into which these turns are divided, tried one after another


def moved_onto_map(design: Design, world: World) -> Design | None:
    """Returns the design moved onto the map; None if its road is too large. The road is moved no further than
    necessary. If moving is not enough, the road is also rotated about its middle by the smallest angle, up to
    45 degrees, at which it fits; its ``theta`` is then a multiple of 0.01 degrees."""
    corners = _corners(world.lay(build(design)), world)
    room = world.site.map_size - 2 * LEAST_EDGE
    written = round(design.theta * HUNDREDTH) / HUNDREDTH - design.theta
    turn = _least_turn(corners, np.append(0.0, TURNS + written), room)
    if turn is None:
        return None
    x, y, z = design.starting_point
    left, low, width, height = (float(edge[0]) for edge in boxes(corners, np.zeros(1)))
    pivot, spin = complex(left + width / 2, low + height / 2), np.exp(1j * radians(turn))
    start, turned = ((p - pivot) * spin + pivot for p in (complex(x, y), corners))
    most = world.site.map_size - LEAST_EDGE
    edges = ((each.min(), each.max()) for each in (turned.real, turned.imag))
    dx, dy = (float(np.clip(0.0, LEAST_EDGE - least, most - largest)) for least, largest in edges)
    if turn or dx or dy:
        x, y = (round(v * CENTIMETRE) / CENTIMETRE for v in (start.real + dx, start.imag + dy))
    theta = round((design.theta + turn) * HUNDREDTH) / HUNDREDTH if turn else design.theta
    return design.model_copy(update={"starting_point": (float(x), float(y), z), "theta": theta % 360})


def _corners(road: Road, world: World) -> Complex:
    half = world.section.road_width / 2
    left, right = sides(road.sample(), world.profile_of(road).edges(road.sample().s))
    behind = []
    for end, more in ((0.0, -BEYOND), (road.length, BEYOND)):  # continued straight
        heading = float(road.heading(end))
        ahead = more * np.array([cos(heading), sin(heading)])
        behind += [road.at(end, t)[:2] + ahead for t in (-half, half)]
    points = np.concatenate([left, right, behind])
    x, y = points[scipy.spatial.ConvexHull(points).vertices].T
    return np.asarray(x + 1j * y)


def _least_turn(corners: Complex, turns: Array, room: float) -> float | None:
    if np.abs(corners[:, None] - corners).max() > np.sqrt(2) * room:
        return None
    for some in np.array_split(turns, PORTIONS):
        found = first_that_fits(corners, some, room)
        if found:
            return found[0]
    return None
