"""Computes embankments: slopes from the edges and ends of a road down into the surrounding land."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from roadgpt.export.edges import line
from roadgpt.geometry.curve import Array
from roadgpt.road import Profile, Road
from roadgpt.road.land import Land

RUN = 1.7  # horizontal length of a slope, divided by its height
FOOT = 0.4  # m by which a slope ends below the land
OUTSIDE = 2.0  # m beyond the edge, where the height of the land is taken
ACROSS = 7  # points of the edge at an end of the road


class Embankment(NamedTuple):
    """One slope, given by the points of its upper and of its lower edge, ``(n, 3)`` each, in metres."""

    edge: Array
    foot: Array
    is_left: bool
    """True if the slope is on your left when you follow the points of its upper edge."""


def embankments(road: Road, profile: Profile, s: Array, land: Land) -> Iterator[Embankment]:
    """Yields the slopes along both edges of a road and across both of its ends.

    The slopes begin at the outer edges of the shoulders, with points at the stations ``s``, and end just
    below the surface of the surrounding land.
    """
    heading, (left, right) = road.heading(s), profile.rims(s)
    for side, rim in ((-1.0, right), (1.0, left)):
        edge = line(road, s, rim)
        near = line(road, s, rim + side * OUTSIDE)
        outward = side * np.stack([-np.sin(heading), np.cos(heading)], axis=-1)
        yield bank_from(edge, near, outward, land, is_left=side > 0)
    for end, sign in ((0.0, -1.0), (road.length, 1.0)):
        rims = profile.rims(end)
        across = np.linspace(*(rims if sign > 0 else rims[::-1]), ACROSS)
        edge = np.stack([line(road, np.array([end]), t)[0] for t in across])
        to = float(road.heading(end))
        way = sign * np.array([np.cos(to), np.sin(to)])
        near = edge[:, :2] + OUTSIDE * way
        yield bank_from(edge, near, np.repeat(way[None], len(edge), axis=0), land, is_left=True)


def bank_from(edge: Array, near: Array, outward: Array, land: Land, is_left: bool) -> Embankment:
    """Returns the slope from an edge ``(n, 3)`` in the directions ``outward`` ``(n, 2)``, down to just below
    the land at the points ``near`` ``(n, 2)``.
    """
    drop = edge[:, 2] - np.minimum(land.height(near[:, 0], near[:, 1]), edge[:, 2]) + FOOT
    foot = np.column_stack([edge[:, :2] + RUN * drop[:, None] * outward, edge[:, 2] - drop])
    return Embankment(edge, foot, is_left)
