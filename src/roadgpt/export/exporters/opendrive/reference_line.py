"""Writes the reference line in plan and in height: lines, arcs, spirals and parabolas exactly, all other
curves as cubics. Also computes the box around the lines of a network, for the header of its file."""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import accumulate
from typing import NamedTuple, TypeVar

import numpy as np

from roadgpt.export.markup import XmlElement
from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve, PlanCurve, SplineCurve, shifted
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import advance
from roadgpt.road import Profile, Road
from roadgpt.road.profile import Width

T = TypeVar("T")
TOLERANCE = 1e-4  # m, between a spline and its cubics
STRAIGHT = 1e-7  # m of lateral deviation below which an element is written as a simpler one
ROUND = 1e-5  # m between a spiral that other programs would refuse and the arcs that replace it
APART = 0.1  # m; nodes of a spline closer together than this share a cubic
STEP = 2.0  # m between the stations at which a curve of an unknown class is cut
CLOSE, NEARLY = 1e-8, 1e-5  # 1/m and ratio; curvatures that differ by less are almost equal
LINE = XmlElement("line", is_shared=True)
APART_ON_BENDS = 1.0  # m, greatest distance between two points of a bend, to find the box around a network
SHORTEST = 1e-6  # m; a shorter piece is left out, and the next one starts in its place
SAME = 1e-5  # m; a cubic this close to the continuation of the previous one is left out
EQUAL = 1e-12  # greatest difference between the coefficients of two cubics that are taken as equal
SHORTEST_CUBIC = 0.02  # m; the shortest cubic, at a cusp of a spline
BETWEEN = (0.25, 0.5, 0.75)  # where a cubic is compared with the function


class Start(NamedTuple):
    """Where a line, an arc or a spiral begins; x and y are in metres."""

    s: float  # the station in metres
    x: float
    y: float
    heading: float  # in radians
    piece: Piece


def geometries(plan: PlanCurve, starts: Sequence[Start] | None = None) -> Iterator[XmlElement]:
    """Returns the ``geometry`` elements of a plan curve in the order of their stations.

    ``starts`` are those of the curve's pieces, as ``starts_of`` returns them; None to compute them."""
    return _pieces(plan, starts) if isinstance(plan, PieceCurve) else _cubics(plan)


def starts_of(plans: Sequence[PieceCurve]) -> list[list[Start]]:
    """Returns one list for each curve, with the starts of its pieces.

    All curves are computed together, which is faster than one after another."""
    rows = np.array([(p.length, p.k0, p.k1) for plan in plans for p in plan.pieces])
    length, k0, k1 = rows.T
    turns = (length * (k0 + k1) / 2).tolist()
    headings = [
        heading
        for plan, own in _shares(plans, turns)
        for heading in accumulate(own[:-1], initial=plan.heading0)
    ]
    along, across = advance(length, np.array(headings), k0, (k1 - k0) / length, length)
    steps = zip(headings, along.tolist(), across.tolist(), strict=True)
    found = []
    for plan, own in _shares(plans, list(steps)):
        s, x, y = 0.0, plan.x, plan.y
        starts = []
        for piece, (heading, dx, dy) in zip(plan.pieces, own, strict=True):
            starts.append(Start(s, x, y, heading, piece))
            s, x, y = s + piece.length, x + dx, y + dy
        found.append(starts)
    return found


def _shares(plans: Sequence[PieceCurve], values: Sequence[T]) -> Iterator[tuple[PieceCurve, Sequence[T]]]:
    first = 0
    for plan in plans:
        yield plan, values[first : first + len(plan.pieces)]
        first += len(plan.pieces)


def _pieces(plan: PieceCurve, starts: Sequence[Start] | None) -> Iterator[XmlElement]:
    if starts is None or not all(map(_is_tellable, plan.pieces)):
        pieces = [part for piece in plan.pieces for part in _tellable(piece)]
        stations = np.r_[0.0, np.cumsum([piece.length for piece in pieces])][:-1]
        points, headings = plan.at(stations).tolist(), plan.heading(stations).tolist()
        starts = [
            Start(s, x, y, heading, piece)
            for s, (x, y), heading, piece in zip(stations.tolist(), points, headings, pieces, strict=True)
        ]
    kept = [start for start in starts if start.piece.length > SHORTEST] or list(starts[:1])
    if kept[0].s:
        kept[0] = kept[0]._replace(s=0.0)
    ends = [start.s for start in kept[1:]] + [plan.length]
    for (s, x, y, heading, piece), end in zip(kept, ends, strict=True):
        # up to the next piece, so that lengths add up even where a piece was left out
        length = piece.length if abs(end - s - piece.length) < SHORTEST / 100 else end - s
        yield _geometry(s, x, y, heading, length).extended(_shape(piece))


def _is_tellable(piece: Piece) -> bool:
    """Returns whether other programs accept a piece, as numpy's ``isclose`` compares: see ``_tellable``."""
    k0, k1 = piece.k0, piece.k1
    return k0 == k1 or not math.isfinite(k1) or not abs(k0 - k1) <= CLOSE + NEARLY * abs(k1)


def _tellable(piece: Piece) -> list[Piece]:
    """Returns the piece itself, or arcs instead of a spiral with almost equal curvatures at its ends.

    Some programs refuse such a spiral; CommonRoad compares the curvatures with numpy's ``isclose``, whose
    tolerances are ``CLOSE`` and ``NEARLY``."""
    if _is_tellable(piece):
        return [piece]
    change = piece.k1 - piece.k0
    parts = max(1, int(np.ceil(np.sqrt(abs(change) * piece.length**2 / 12 / ROUND))))
    curvatures = piece.k0 + change * (np.arange(parts) + 0.5) / parts
    return [Piece(piece.length / parts, k, k) for k in curvatures.tolist()]


def _geometry(s: float, x: float, y: float, heading: float, length: float) -> XmlElement:
    return XmlElement("geometry", {"s": s, "x": x, "y": y, "hdg": heading, "length": length})


def _shape(piece: Piece) -> XmlElement:
    """Returns a line, arc or spiral. Programs that read the file may divide by the curvature of an arc, so an
    arc that is almost straight is written as a line."""
    bend = piece.length**2 / 6
    if abs(piece.k1 - piece.k0) * bend > STRAIGHT:
        return XmlElement("spiral", {"curvStart": piece.k0, "curvEnd": piece.k1})
    middle = (piece.k0 + piece.k1) / 2
    return XmlElement("arc", {"curvature": middle}) if abs(middle) * bend > STRAIGHT else LINE


def _cubics(plan: PlanCurve) -> Iterator[XmlElement]:
    """Yields cubics by arc length, each in the frame of its start: u points ahead, v to the left.

    The derivative by the parameter has length 1 at both ends, and the cubics are so short that the parameter
    equals the arc length within a micrometre."""

    def ways(s: Array) -> Array:
        heading = plan.heading(s)
        return np.stack([np.cos(heading), np.sin(heading)], axis=-1)

    stations, found = cubics(plan.at, ways, breaks_of(plan), TOLERANCE)
    headings = plan.heading(stations).tolist()
    ends = stations[1:].tolist()
    last: XmlElement | None = None  # a line that may still be extended
    for s, end, heading, cubic in zip(stations.tolist(), ends, headings, found, strict=False):
        (x, y), ahead, c, d = cubic
        length = end - s
        cu, cv = float(ahead @ c), float(ahead[0] * c[1] - ahead[1] * c[0])
        du, dv = float(ahead @ d), float(ahead[0] * d[1] - ahead[1] * d[0])
        is_line = max(abs(cu), abs(cv)) * length**2 + max(abs(du), abs(dv)) * length**3 < STRAIGHT
        if last is not None:
            if is_line and abs(float(last.attributes["hdg"]) - heading) * length < STRAIGHT:
                last.attributes = {**last.attributes, "length": end - float(last.attributes["s"])}
                continue
            yield last
            last = None
        made = _geometry(s, float(x), float(y), heading, length)
        if is_line:
            last = made.extended(LINE)
        else:
            along = {"aU": 0, "bU": 1, "cU": cu, "dU": du}
            across = {"aV": 0, "bV": 0, "cV": cv, "dV": dv}
            yield made.extended(XmlElement("paramPoly3", {**along, **across, "pRange": "arcLength"}))
    if last is not None:
        yield last


def breaks_of(plan: PlanCurve) -> Array:
    """Returns the stations at which a curve is divided into cubics, both ends included.

    For a spline, these are its nodes, except nodes that are within APART of an end or of the previous node
    that was kept. For any other curve, they are equally spaced, about STEP apart."""
    if isinstance(plan, SplineCurve):
        inner = plan.stations[1:-1]
        kept, last = [], 0.0
        for s in inner.tolist():
            if s - last > APART and plan.length - s > APART:
                kept.append(s)
                last = s
        return np.array([0.0, *kept, plan.length])
    return np.linspace(0.0, plan.length, max(2, round(plan.length / STEP) + 1))


def bounds_of(
    roads: Sequence[Sequence[Start]], sides: Sequence[tuple[float, float]]
) -> tuple[float, float, float, float]:
    """Returns the box around all lanes: smallest x, smallest y, largest x and largest y, in metres.

    ``sides`` has the result of ``reaches`` for each road. No lane lies outside the box. The box is too large
    by at most 2.1 cm, plus 0.35 cm for each metre of the greatest distance in ``sides``. This limit holds if
    no bend has a radius below 6 m, and all widths and lane offsets are constant."""
    starts = [start for own in roads for start in own]
    left, right = np.repeat(np.array(sides), [len(own) for own in roads], axis=0).T
    length, k0, k1 = np.array([(start.piece.length, start.piece.k0, start.piece.k1) for start in starts]).T
    x, y, heading = np.array([start[1:4] for start in starts]).T
    bend = np.maximum(np.abs(k0), np.abs(k1))
    count = np.where(bend > 0, np.ceil(length / APART_ON_BENDS), 1).astype(int)
    reach = length + np.maximum(left, right)
    # the other pieces cannot leave the box around the starts of all pieces
    outside = [(v - reach < v.min()) | (v + reach > v.max()) for v in (x, y)]
    outer = np.flatnonzero(outside[0] | outside[1])
    points_of = count[outer] + 1
    piece = np.repeat(outer, points_of)
    first = np.zeros(len(starts), int)
    first[outer] = np.cumsum(points_of) - points_of
    u = length[piece] * (np.arange(len(piece)) - first[piece]) / count[piece]
    k, dk = k0[piece], ((k1 - k0) / length)[piece]
    dx, dy = advance(u, heading[piece], k, dk, length[piece])
    angle = heading[piece] + u * (k + u * dk / 2)
    points = np.array([x[piece] + dx, y[piece] + dy])
    normal = np.array([-np.sin(angle), np.cos(angle)])
    corners = np.concatenate((points + left[piece] * normal, points - right[piece] * normal), axis=1)
    # an edge is at most this far from the chord between two of its points
    sag = float(np.max(bend * (length / count) ** 2 / 8 * (1 + bend * np.maximum(left, right))))
    west, south = (corners.min(axis=1) - sag).tolist()
    east, north = (corners.max(axis=1) + sag).tolist()
    return west, south, east, north


def reaches(profile: Profile) -> tuple[float, float]:
    """Returns the distances in metres from the reference line to the outermost edges, on the left and right.

    Where widths vary, the distances are upper bounds."""
    left, right = (sum(_widest(lane.width) for lane in side) for side in (profile.left, profile.right))
    low, high = profile.offset_range
    return left + high, right - low


def _widest(width: Width) -> float:
    if not isinstance(width, CubicProfile):
        return width
    found = [width.coefficients[-1][0]]
    for start, end, (a, b, c, d) in zip(width.stations, width.stations[1:], width.coefficients, strict=False):
        n = end - start
        found += [a, a + n * b / 3, a + n * (2 * b + n * c) / 3, a + n * (b + n * (c + n * d))]
    return max(found)


def elevations(road: Road) -> list[XmlElement]:
    """Returns the ``elevation`` elements of a road in the order of their stations, beginning at station 0."""
    return _elements("elevation", "s", *_table(road))


def level_height(road: Road) -> float | None:
    """Returns the height in metres of a road with a grade of 0 throughout, such as a road in a junction.

    None is returned for any other road, and for a level road whose elevation is not a GradeProfile with two
    stations."""
    profile = road.elevation
    if isinstance(profile, GradeProfile) and len(profile.stations) == 2 and not any(profile.grades):
        return profile.z0
    return None


def rows(name: str, station: str, profile: CubicProfile, length: float) -> list[XmlElement]:
    """Returns one XML element for each cubic of a profile, up to the end of the road; the first is at station
    0.

    A cubic that is identical to the continuation of the previous one is left out. ``station`` names the
    attribute for the station at which a cubic begins."""
    if profile.stations[0] == 0 and not any(1e-9 < s < length - 1e-9 for s in profile.stations):
        return [XmlElement(name, dict(zip((station, *"abcd"), (0.0, *profile.coefficients[0]), strict=True)))]
    stations = _within(profile.stations, length)
    table = profile.cubics(stations)
    kept = [0]
    for n in range(1, len(stations)):
        carried = shifted(table[kept[-1]], stations[n] - stations[kept[-1]])
        if not np.allclose(carried, table[n], rtol=0.0, atol=EQUAL):
            kept.append(n)
    return _elements(name, station, stations[kept], table[kept])


def _elements(name: str, station: str, stations: Array, table: Array) -> list[XmlElement]:
    return [
        XmlElement(name, dict(zip((station, *"abcd"), row, strict=True)))
        for row in np.column_stack([stations, table]).tolist()
    ]


def _table(road: Road) -> tuple[Array, Array]:
    """Returns stations ``(n,)`` and coefficients ``(n, 4)``. From each station on, the height is a cubic of
    the distance from that station."""
    profile, length = road.elevation, road.length
    if isinstance(profile, GradeProfile):
        stations = _within(profile.stations[:-1], length)
        half = profile.vertical_curvature(stations) / 2
        rows = [profile.height(stations), profile.grade(stations), half, np.zeros_like(half)]
        return stations, np.column_stack(rows)
    if isinstance(profile, CubicProfile):
        stations = _within(profile.stations, length)
        return stations, profile.cubics(stations)

    def column(of: Function) -> Function:
        return lambda s: np.asarray(of(s))[:, None]

    stations, found = cubics(column(profile.height), column(profile.grade), breaks_of(road.plan), TOLERANCE)
    kept = [0]
    for i in range(1, len(found)):
        last, length = found[kept[-1]][None], stations[i + 1] - stations[i]
        u = np.array([0.0, length / 2, length])
        carried = at(np.repeat(last, 3, axis=0), stations[i] - stations[kept[-1]] + u)
        if np.abs(carried - at(np.repeat(found[i][None], 3, axis=0), u)).max() > SAME:
            kept.append(i)
    return stations[kept], found[kept][:, :, 0]


def _within(stations: tuple[float, ...], length: float) -> Array:
    return np.array([0.0, *(s for s in stations if 1e-9 < s < length - 1e-9)])


Function = Callable[[Array], Array]
"""A function that returns values ``(n, d)`` at stations ``(n,)``."""


def cubics(value: Function, slope: Function, breaks: Array, tolerance: float) -> tuple[Array, Array]:
    """Returns stations ``(n + 1,)`` and the coefficients ``(n, 4, d)`` of the cubics between them.

    The cubics have the values and slopes of the function at the stations.

    Args:
        value: The function to approximate, smooth between the breaks.
        slope: The derivative of ``value`` with respect to s.
        breaks: Increasing stations at which a cubic must begin or end, including both ends of the range.
        tolerance: Greatest distance between cubic and function, in the unit of the values."""
    stations = np.asarray(breaks, float)
    while True:
        found = _between(stations, value(stations), slope(stations))
        lengths = np.diff(stations)
        far = np.zeros(len(lengths), bool)
        for share in BETWEEN:
            away = value(stations[:-1] + share * lengths) - at(found, share * lengths)
            far |= np.sqrt((away**2).sum(axis=-1)) > tolerance
        far &= lengths > SHORTEST_CUBIC
        if not far.any():
            return stations, found
        middles = (stations[:-1] + lengths / 2)[far]
        stations = np.sort(np.r_[stations, middles])


def at(coefficients: Array, u: Array) -> Array:
    """Evaluates cubics ``(n, 4, d)`` to values ``(n, d)``: cubic i at distance ``u[i]`` from its start."""
    a, b, c, d = (coefficients[:, i] for i in range(4))
    u = u[:, None]
    return np.asarray(a + u * (b + u * (c + u * d)))


def _between(stations: Array, values: Array, slopes: Array) -> Array:
    length = np.diff(stations)[:, None]
    rise = np.diff(values, axis=0) / length
    c = (3 * rise - 2 * slopes[:-1] - slopes[1:]) / length
    d = (slopes[:-1] + slopes[1:] - 2 * rise) / length**2
    return np.stack([values[:-1], slopes[:-1], c, d], axis=1)
