"""Draws lines along a road, also painted ones, as polylines with few points and a bounded chord error."""

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import maximum_filter1d

from roadgpt.export.markup import finite
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.road import Edges, Profile, Road
from roadgpt.road.land import Land
from roadgpt.road.profile import LINE

CHORD = 0.002  # m, most distance between a polyline and the curve it stands for
LONGEST = 10.0  # m between stations on a straight
SHORTEST = 0.05  # m between stations; tighter bends are not followed more closely
STEP = 0.5  # m between the places where the curvature is sampled
BESIDE = 1e-3  # m before a sudden change of a width, where a polyline gets an additional point
PINCH = 0.95  # share of the radius; an offset line closer to the centre of its bend would fold
SAME = 1e-9  # m
Place = Literal["left", "right", "middle", "between"]
ORDER: tuple[Place, ...] = ("left", "right", "middle", "between")


def stations(road: Road, reach: float, chord: float = CHORD) -> Array:
    """Returns increasing stations at which a polyline along the road needs points, both ends included.

    The stations are dense in bends and on crests, and sparse on straights.

    Args:
        road: The road.
        reach: Greatest offset of a polyline from the centre line, in metres. A greater offset needs more
            points.
        chord: Greatest allowed distance in metres between the polyline and the curve."""
    s = np.linspace(0.0, road.length, max(3, int(np.ceil(road.length / STEP)) + 1))
    finite(road.at(s))
    plan, upright = np.abs(finite(road.curvature(s))), np.abs(finite(road.vertical_curvature(s)))
    # each value is widened to its neighbours, because the curvature may jump between two stations
    bend = maximum_filter1d(np.maximum(plan * (1 + plan * reach), upright), 3)
    if road.profile is not None:
        bend = np.maximum(bend, _sway(road.profile, s))
    spacing = np.clip(np.sqrt(8 * chord / np.maximum(bend, 1e-12)), SHORTEST, LONGEST)
    along = np.r_[0.0, np.cumsum(np.diff(s) * (1 / spacing[1:] + 1 / spacing[:-1]) / 2)]
    count = max(2, int(np.ceil(along[-1])) + 1)
    found = np.interp(np.linspace(0.0, along[-1], count), along, s)
    return found if road.profile is None else _with_joints(found, road.profile)


def normals(road: Road, s: Array) -> Array:
    """Returns the upward unit normals ``(n, 3)`` of the road surface at stations ``s``."""
    heading, grade = road.heading(s), road.grade(s)
    if road.profile is None or road.profile.superelevation_angle is None:
        up = np.stack([-grade * np.cos(heading), -grade * np.sin(heading), np.ones_like(grade)], axis=-1)
    else:
        ahead = np.stack([np.cos(heading), np.sin(heading), grade], axis=-1)
        up = np.cross(ahead, road.at(s, 0.5) - road.at(s, -0.5))
    return np.asarray(up / np.linalg.norm(up, axis=-1, keepdims=True))


def _sway(profile: Profile, s: Array) -> Array:
    """Returns, at each station, the greatest curvature in 1/m that changes of width and superelevation give
    to any edge of a lane."""
    edges = np.stack([t for side in profile.lane_edges(s) for t in side])
    both = np.concatenate([edges, edges * np.sin(profile.superelevation(s))])
    return np.asarray(np.abs(np.gradient(np.gradient(both, s, axis=1), s, axis=1)).max(axis=0))


def _with_joints(s: Array, profile: Profile) -> Array:
    widths = [lane.width for lane in (*profile.left, *profile.right)]
    cubics = [width for width in widths if isinstance(width, CubicProfile)]
    joints = np.unique([each for width in cubics for each in width.stations])
    joints = joints[(joints > s[0] + 2 * BESIDE) & (joints < s[-1] - 2 * BESIDE)]
    if not joints.size:
        return s
    rise = [np.abs(width.height(joints) - width.height(joints - BESIDE)) for width in cubics]
    steps = joints[np.max(rise, axis=0) > BESIDE]
    away = np.abs(s[:, None] - joints).min(axis=1)
    return np.sort(np.r_[s[away > 2 * BESIDE], joints, steps - BESIDE])


def fold(road: Road, profile: Profile) -> str | None:
    """Returns a sentence on the place where an edge of a lane or shoulder lies farthest beyond the centre of
    its bend, so that no polyline shows it rightly; None if there is no such place."""
    s = stations(road, profile.reach)
    edges = np.stack([t for side in profile.lane_edges(s) for t in side])
    beyond = road.curvature(s) * edges
    edge, place = np.unravel_index(int(beyond.argmax()), beyond.shape)
    if beyond[edge, place] <= PINCH:
        return None
    radius, offset = 1 / abs(float(road.curvature(s[place]))), abs(float(edges[edge, place]))
    return (
        f"at s = {s[place]:.0f} m the edge of a lane or shoulder lies {offset:.1f} m to the inside of a bend "
        f"with a radius of {radius:.1f} m; there it folds or is drawn elsewhere, and lanes may end"
    )


def line(road: Road, s: Array, t: ArrayLike) -> Array:
    """Returns the points ``(n, 3)`` of the line at offset ``t`` to the left of the centre line, in metres.

    There is one point for each station in ``s``.

    On the inside of a tight bend, the offset is limited to 0.95 of the radius of the bend, so that the line
    does not fold back on itself."""
    k = road.curvature(s)
    inside = k * np.asarray(t) > PINCH
    offsets = np.where(inside, PINCH / np.where(inside, k, 1.0), t)
    return road.at(s, offsets)


class NamedLine(NamedTuple):
    """One painted line."""

    number: int  # index of the line in the result of ``Profile.markings``
    place: Place
    """Position of the line: "left" or "right" edge of the carriageway, "middle" for the centre line, or
    "between" two lanes."""
    is_broken: bool
    edges: Edges
    """The offsets in metres of the left and right edges of the line, at the stations passed to
    ``named_lines``."""


def named_lines(profile: Profile, s: Array) -> list[NamedLine]:
    """Returns the painted lines of a road at stations ``s`` along the whole road: first the edge lines, then
    the centre line, then lines between lanes."""
    carriageway = profile.edges(s)
    found = []
    for number, (marking, edges) in enumerate(profile.markings(s)):
        place: Place = "between"
        if np.abs(edges.left - carriageway.left).max() < SAME:
            place = "left"
        elif np.abs(edges.right - carriageway.right).max() < SAME:
            place = "right"
        elif np.abs(edges.left - LINE / 2).max() < SAME:
            place = "middle"
        found.append(NamedLine(number, place, marking == "broken", edges))
    return sorted(found, key=lambda line: ORDER.index(line.place))


RUN = 1.7  # horizontal length of a slope, divided by its height
FOOT = 0.4  # m by which a slope ends below the land
OUTSIDE = 2.0  # m beyond the edge, where the height of the land is taken
ACROSS = 7  # points of the edge at an end of the road


class Embankment(NamedTuple):
    """One slope, given by the points of its upper and of its lower edge, ``(n, 3)`` each, in metres."""

    edge: Array
    foot: Array
    is_left: bool  # true if the slope is on your left when you follow the points of its upper edge


def embankments(road: Road, profile: Profile, s: Array, land: Land) -> Iterator[Embankment]:
    """Yields the slopes along both edges of a road and across both of its ends.

    The slopes begin at the outer edges of the shoulders, with points at the stations ``s``, and end just
    below the surface of the surrounding land."""
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
    the land at the points ``near`` ``(n, 2)``."""
    drop = edge[:, 2] - np.minimum(land.height(near[:, 0], near[:, 1]), edge[:, 2]) + FOOT
    foot = np.column_stack([edge[:, :2] + RUN * drop[:, None] * outward, edge[:, 2] - drop])
    return Embankment(edge, foot, is_left)
