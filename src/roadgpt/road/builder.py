r"""Builds a Road from a Design, either from lines, arcs, clothoids and parabolas, or from a spline.

The curvature of a turning segment changes from an entry value to its own value, and then to an exit value:

    curvature   own   ____arc____
                     /           \
           entry ___/             \___ exit
                clothoid      clothoid

The entry or exit value is 0 where the neighbouring segment is straight or turns the other way. Where both
segments turn the same way, the value is the smaller of their own curvatures, so that the two segments form
one longer turn. The prompt in the RoadGPT thesis asks language models to build turns of more than 70 degrees
in this way.

The spline is that of the thesis, section 5.3.2: each segment is treated as a straight line between two nodes,
and the spline through the nodes makes the road smooth. Unlike the program of the thesis, this module does not
shift roads by (5, 5) m."""

import math
from collections.abc import Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import GradeProfile, Piece, PieceCurve, wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import joined
from roadgpt.road.design import Design, Segment, vertical_curves_of
from roadgpt.road.road import Road, check_length
from roadgpt.road.world import Geometry

TRANSITION_SHARE = 0.25  # share of the distance, for each clothoid whose length the design leaves open
LONGEST_TRANSITION = 12.0  # m, for a clothoid whose length the design leaves open
MOST_TRANSITION = 0.45  # share of the distance, for each clothoid of a turn without a given radius
ROUNDS = 60  # of the fixed-point iteration; each brings neighbouring curvatures closer
SETTLED = 1e-12  # 1/m
EQUAL = 1e-9  # 1/m; curvatures closer than this need no clothoid between them
STUB = 5.0  # m, level, before the first segment of a spline, so that the car starts on level ground
GROWS = 2  # segments with a reduced grade after the stub
MOST_HOPS = 500
HOP = 2.0  # m; a spline through points this dense keeps a radius of 14.8 m above SBFT's least, 14.33 m


class _TurnSpec(NamedTuple):
    """The turn that a segment specifies; lengths are in metres. ``turn`` is the absolute angle in radians;
    ``hand`` is 1 for a left turn, -1 for a right turn."""

    distance: float
    turn: float
    ramp: float
    radius: float | None
    hand: float


_TurnLayout = tuple[float, float, float, float, float]
"""A turn's own curvature, and the lengths of its clothoid, arc, clothoid and unused straight."""


def pieces_of(segments: Sequence[Segment]) -> list[Piece]:
    """Returns the lines, arcs and clothoids of all segments in order. Every segment keeps its length and its
    change of heading exactly. A radius that the segment states is kept if the turn fits into this length and
    at most one of the neighbouring segments turns the same way."""
    bends = [_bend(segment) for segment in segments]
    joints = _settled_joints(bends)
    out: list[Piece] = []
    for segment, bend, entry, exit_ in zip(segments, bends, joints, joints[1:], strict=False):
        out += _pieces(bend, entry, exit_) if bend else [Piece(segment.distance)]
    return out


def _bend(segment: Segment) -> _TurnSpec | None:
    turn = math.radians(segment.turn_degrees)
    if abs(turn) < 1e-9:
        return None
    ramp = segment.transition or min(TRANSITION_SHARE * segment.distance, LONGEST_TRANSITION)
    return _TurnSpec(segment.distance, abs(turn), ramp, segment.radius, math.copysign(1.0, turn))


def _settled_joints(bends: Sequence[_TurnSpec | None]) -> list[float]:
    """Returns the curvatures at the start, between segments and at the end, by fixed-point iteration."""
    joints = [0.0] * (len(bends) + 1)
    hands = [bend.hand if bend else 0.0 for bend in bends]
    meets = [i for i in range(1, len(bends)) if hands[i - 1] == hands[i] != 0]
    for _ in range(ROUNDS if meets else 0):
        own = [_solve(b, joints[i], joints[i + 1])[0] if b else 0.0 for i, b in enumerate(bends)]
        moved = max(abs(min(own[i - 1], own[i]) - joints[i]) for i in meets)
        for i in meets:
            joints[i] = min(own[i - 1], own[i])
        if moved < SETTLED:
            break
    return joints


def _solve(bend: _TurnSpec, entry: float, exit_: float) -> _TurnLayout:
    if bend.radius and 0 in (entry, exit_):
        kept = _with_radius(bend, 1 / bend.radius, entry, exit_)
        if kept:
            return kept
    ramp = min(bend.ramp, MOST_TRANSITION * bend.distance)
    own = (bend.turn - (entry + exit_) * ramp / 2) / (bend.distance - ramp)
    return own, ramp, bend.distance - 2 * ramp, ramp, 0.0


def _with_radius(bend: _TurnSpec, own: float, entry: float, exit_: float) -> _TurnLayout | None:
    first = bend.ramp if entry < own - EQUAL else 0.0
    last = bend.ramp if exit_ < own - EQUAL else 0.0
    turned = first * (own + entry) / 2 + last * (own + exit_) / 2
    shrink = min(1.0, bend.turn / turned) if turned else 1.0
    first, last, arc = first * shrink, last * shrink, (bend.turn - turned * shrink) / own
    spare = bend.distance - first - last - arc
    fits = spare > -1e-6 and own >= max(entry, exit_)
    return (own, first, arc, last, max(spare, 0.0)) if fits else None


def _pieces(bend: _TurnSpec, entry: float, exit_: float) -> list[Piece]:
    own, first, arc, last, spare = _solve(bend, entry, exit_)
    free = (entry == 0) + (exit_ == 0)
    k, k_in, k_out = bend.hand * own, bend.hand * entry, bend.hand * exit_
    return [
        Piece(spare / free if entry == 0 else 0.0),
        Piece(first, k_in, k),
        Piece(arc, k, k),
        Piece(last, k, k_out),
        Piece(spare / free if exit_ == 0 else 0.0),
    ]


def build(design: Design, geometry: Geometry = "arcs") -> Road:
    """Returns the Road that a Design describes.

    The geometry "arcs" keeps the lengths, angles and radii of the design. "spline" is the method of the
    RoadGPT thesis: a cubic spline through nodes at the ends of the segments. Raises UsageError if two
    neighbouring nodes of the spline coincide, the road would be longer than 50 km, or the design has
    junctions, lanes or traffic on the left, or is a map; ``roadgpt.build_route`` builds these."""
    if not design.is_plain:
        raise UsageError(
            "a design with junctions, lanes or traffic on the left, and a map, are built by build_route"
        )
    if geometry == "spline":
        return Road.through(nodes_of(design))
    check_length(sum(segment.distance for segment in design.segments))
    x, y, z = design.starting_point
    plan = PieceCurve(x, y, math.radians(design.theta), joined(pieces_of(design.segments)))
    return Road(plan, elevation_of(design.segments, z))


def elevation_of(segments: Sequence[Segment], z0: float) -> GradeProfile:
    """Returns the elevation profile of the segments of a Design, starting at height ``z0`` in metres. A
    vertical curve changes heights only within its own length. Elsewhere, heights are as if the grade changed
    abruptly between segments."""
    grades = [segment.incline / 100 for segment in segments]
    stations, values = [0.0], [grades[0]]
    for i, at, half, _ in vertical_curves_of(segments):
        stations += [at - half, at + half]
        values += [grades[i - 1], grades[i]]
    # not sum(), which rounds differently from Python 3.12 on
    stations += [*accumulate(segment.distance for segment in segments)][-1:]
    values.append(grades[-1])
    return GradeProfile(z0, tuple(stations), tuple(values))


def nodes_of(design: Design) -> Array:
    """Returns the nodes of the spline of a Design, ``(n, 3)`` in metres: the start, the end of a level
    stretch of 5 m before the first segment, and the end of every segment."""
    nodes = [design.starting_point]
    heading = math.radians(design.theta)
    hops = [(STUB, 0.0, 0.0)] + [(s.distance, s.turn_degrees, s.incline) for s in design.segments]
    for distance, turn, incline in hops:
        heading += math.radians(turn)
        x, y, z = nodes[-1]
        across, along = distance * math.cos(heading), distance * math.sin(heading)
        nodes.append((x + across, y + along, z + distance * incline / 100))
    return np.array(nodes)


def in_short_segments(design: Design) -> Design:
    """Returns a design of short straight segments, so that with the geometry "spline" the road follows the
    lines, arcs and clothoids of the given design.

    The grade is built up over two segments after the level stretch at the start, so that the spline does not
    overshoot there. This shifts the heights of the rest of the road by a constant."""
    road = build(design)
    first = min(STUB, road.length / 2)
    count = min(MOST_HOPS, max(2, math.ceil((road.length - first) / HOP)))
    ways = np.diff(road.at(np.linspace(first, road.length, count + 1)), axis=0)
    distances = np.hypot(ways[:, 0], ways[:, 1])
    headings = np.arctan2(ways[:, 1], ways[:, 0])
    turns = np.degrees(wrap_angle(np.diff(headings, prepend=math.radians(design.theta))))
    grown = np.minimum(1.0, np.arange(1, count + 1) / (GROWS + 1))
    inclines = 100 * grown * ways[:, 2] / distances
    hops = zip(distances.tolist(), turns.tolist(), inclines.tolist(), strict=True)
    segments = []
    for distance, exact_turn, incline in hops:
        turn = round(exact_turn, 5)
        segments.append(
            Segment(
                distance=round(distance, 5),
                direction="left" if turn > 0 else "right" if turn < 0 else "straight",
                incline=round(incline, 4),
                turn_degrees=turn,
            )
        )
    return design.model_copy(update={"segments": tuple(segments)})
