"""Draws lines along a road, also painted ones, as polylines with few points and a bounded chord error."""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import maximum_filter1d

from roadgpt.errors import ExportError
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.road.profile import LINE, Edges, Profile
from roadgpt.road.road import Road

CHORD = 0.002  # m, most distance between a polyline and the curve it stands for
LONGEST = 10.0  # m between stations on a straight
SHORTEST = 0.05  # m between stations; tighter bends are not followed more closely
STEP = 0.5  # m between the places where the curvature is sampled
BESIDE = 1e-3  # m before a sudden change of a width, where a polyline gets an additional point
PINCH = 0.95  # share of the radius; an offset line closer to the centre of its bend would fold
SAME = 1e-9  # m
NOT_FINITE = "the road has a number that is not finite; check it before it is exported"
Place = Literal["left", "right", "middle", "between"]
ORDER: tuple[Place, ...] = ("left", "right", "middle", "between")


def finite(values: Array) -> Array:
    """Returns the values unchanged. Raises ExportError if one is not finite, which no format can hold."""
    if not np.isfinite(values).all():
        raise ExportError(NOT_FINITE)
    return values


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
