"""Reads the reference line of an OpenDRIVE road, and makes a plan curve of it: unchanged where possible,
otherwise clothoids through poses one metre apart."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.brief.words import LONGEST_ROAD
from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, Piece, PieceCurve, project, wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import ROUNDING, Cubic, Row, closed
from roadgpt.geometry.fitting import SampledLine, clothoids, fitted
from roadgpt.geometry.pieces import advance
from roadgpt.road.road import check_length
from roadgpt_formats.opendrive.rounding import misses, smoothed, turns_back
from roadgpt_formats.opendrive.tree import MapRemarks, number

KNOWN = ("line", "arc", "spiral", "poly3", "paramPoly3")
SHORTEST = 1e-3  # m; shorter elements are merged with the previous ones
MISSED = 0.01  # m, by which a station of the line may be wrong
FINE = 0.1  # m between the places at which the length of a polynomial is summed
MOST_PLACES = 20_000
MOST_ELEMENTS = 4_000  # of one line
OFF = 0.1  # m, allowed between the end of an element and the station of the next
SMALLEST_RADIUS = 0.1  # m
SMALLEST = 1e-9  # m, length given to an element of zero length
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
MEETS, SAME_WAY = 0.002, 0.001  # m and rad, between the elements of a line that stays as it is
GAP = 0.3  # m; a larger gap is refused
STEP = 1.0  # m between the poses of the clothoids; less where they would leave the line
CLOSE = 1e-4  # m, between clothoids and the line
HARDLY_TURNS = 0.02  # rad; over such a slight turn a clothoid deviates by micrometres
LEAST = 0.1  # m between the poses of a polynomial
FEWEST = 2  # parts of an element: its middle tells its direction best


@dataclass(frozen=True)
class Polynomial:
    """A curve (u(p), v(p)), where u and v are cubic polynomials and p runs from 0 to ``end``."""

    u: Cubic
    v: Cubic
    end: float

    @cached_property
    def _walked(self) -> tuple[Array, Array]:
        rough = np.linspace(0.0, self.end, 65)
        length = float(np.hypot(*np.diff(self._at(rough), axis=1)).sum())
        count = int(min(MOST_PLACES, max(64, length / FINE)))
        p = np.linspace(0.0, self.end, count + 1)
        half = self.end / count / 2
        inner = p[:-1, None] + half * (_NODES + 1)
        speed = np.hypot(*self._slope(inner.ravel())).reshape(inner.shape)
        return p, np.r_[0.0, np.cumsum(half * (speed @ _WEIGHTS))]

    @property
    def length(self) -> float:
        """The arc length of the curve in metres."""
        return float(self._walked[1][-1])

    def up_to(self, length: float) -> "Polynomial":
        """Returns the first part of the curve, up to an arc length in metres."""
        p, walked = self._walked
        return Polynomial(self.u, self.v, float(np.interp(length, walked, p)))

    def _at(self, p: Array) -> Array:
        return np.stack([a + p * (b + p * (c + p * d)) for a, b, c, d in (self.u, self.v)])

    def _slope(self, p: Array) -> Array:
        return np.stack([b + p * (2 * c + 3 * p * d) for _, b, c, d in (self.u, self.v)])

    def poses(self, share: Array) -> Array:
        """Returns the poses (x, y, heading) at given fractions (0 to 1) of the length, as rows ``(n, 3)``."""
        p_table, walked = self._walked
        p = np.interp(share * walked[-1], walked, p_table)
        x, y = self._at(p)
        du, dv = self._slope(p)
        heading = np.arctan2(dv, du)
        return np.stack([x, y, np.unwrap(heading) if len(heading) else heading], -1)


Shape = Piece | Polynomial
"""The shape of a geometry element in local coordinates: it starts at the origin along +x."""


@dataclass(frozen=True)
class GeometryElement:
    """One geometry element of the reference line, with the station and pose of its start, and its shape."""

    s: float
    x: float
    y: float
    heading: float
    length: float  # length of the element in metres, as stated in the file
    shape: Shape

    def poses(self, share: Array) -> Array:
        """Returns the poses (x, y, heading) at given fractions (0 to 1) of the length, as rows ``(n, 3)``."""
        if isinstance(self.shape, Piece):
            curve, s = PieceCurve(0.0, 0.0, 0.0, (self.shape,)), share * self.shape.length
            u, v, turned = (*curve.at(s).T, curve.heading(s))
        else:
            u, v, turned = self.shape.poses(share).T
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return np.stack([self.x + u * cos - v * sin, self.y + u * sin + v * cos, self.heading + turned], -1)


def reference_line(road: Element) -> list[GeometryElement]:
    """Returns the geometry elements of a road's reference line, which ``in_order`` has sorted. Raises
    UsageError if there are none, or if one is unknown or invalid."""
    nodes = road.findall("planView/geometry")
    if len(nodes) > MOST_ELEMENTS:
        raise UsageError(f"its line has more than {MOST_ELEMENTS:,} elements; cut out the part that you need")
    check_length(sum(abs(number(node, "length")) for node in nodes) or 1.0)
    kept = [_element(node) for node in _long_enough(nodes)]
    if not kept:
        raise UsageError("its <planView> has no geometry; add the reference line")
    if abs(kept[0].s) > LONGEST_ROAD:
        raise UsageError(f"its line begins at s = {kept[0].s:g}; let it begin at 0")
    out = []
    for each, following in pairwise(kept):
        reach = following.s - each.s
        if abs(reach - each.length) > OFF or reach <= 0:
            raise UsageError(
                f"the geometry at s = {each.s:g} is {each.length:g} m long, but the next one begins at "
                f"s = {following.s:g}; correct it"
            )
        out.append(replace(each, length=reach))
    return [*out, kept[-1]]


def _long_enough(nodes: list[Element]) -> Iterator[Element]:
    """Yields the elements, except those that are shorter than their own rounding errors."""
    passed = 0.0
    for node in nodes:
        length = number(node, "length")
        if 0 <= length < SHORTEST and passed + length < SHORTEST:
            passed += length
        else:
            passed = 0.0
            yield node


def _element(node: Element) -> GeometryElement:
    s, x, y = (number(node, name) for name in ("s", "x", "y"))
    heading, length = number(node, "hdg"), number(node, "length")
    if length < 0:
        raise UsageError(f"the geometry at s = {s:g} is {length:g} m long; correct it")
    shapes = [child for child in node if child.tag in KNOWN]
    if not shapes:
        what = f"is a <{node[0].tag[:40]}>" if len(node) else "has no shape"
        raise UsageError(f"the geometry at s = {s:g} {what}; known are {', '.join(KNOWN)}")
    return GeometryElement(s, x, y, heading, length, _shape(shapes[0], s, max(length, SMALLEST)))


def _shape(node: Element, s: float, length: float) -> Shape:
    if node.tag == "line":
        return Piece(length)
    if node.tag in ("arc", "spiral"):
        names = ("curvStart", "curvEnd") if node.tag == "spiral" else ("curvature", "curvature")
        k0, k1 = (number(node, name) for name in names)
        if max(abs(k0), abs(k1)) * SMALLEST_RADIUS > 1:
            if length < SMALLEST_RADIUS:
                return Piece(length)  # too short to be a bend: its turn becomes a kink at its end
            raise UsageError(f"the {node.tag} at s = {s:g} turns more tightly than {SMALLEST_RADIUS:g} m")
        return Piece(length, k0, k1)
    if node.tag == "poly3":
        v = (number(node, "a"), number(node, "b"), number(node, "c"), number(node, "d"))
        return Polynomial((0.0, 1.0, 0.0, 0.0), v, length).up_to(length)
    kind = node.get("pRange", "normalized")
    if kind not in ("normalized", "arcLength"):
        what = f"has a pRange '{kind[:20]}'; give arcLength or normalized"
        raise UsageError(f"the paramPoly3 at s = {s:g} {what}")
    along, across = (_cubic(node, axis) for axis in "UV")
    shape = Polynomial(along, across, 1.0 if kind == "normalized" else length)
    if not 0.2 * length < shape.length < 5 * length:
        what = f"is {shape.length:.3g} m long, not {length:g} m; correct it"
        raise UsageError(f"the paramPoly3 at s = {s:g} {what}")
    return shape


def _cubic(node: Element, axis: str) -> Cubic:
    a, b, c, d = (number(node, f"{letter}{axis}") for letter in "abcd")
    return a, b, c, d


def exact(line: list[GeometryElement]) -> PieceCurve | None:
    """Returns the reference line unchanged; None if it is not made of lines, arcs and spirals that meet. Each
    follows the one before, and begins nearly where its file has it."""
    shapes = [each.shape for each in line]
    pieces = [shape for shape in shapes if isinstance(shape, Piece)]
    if len(pieces) < len(shapes):
        return None
    first = line[0]
    plan = PieceCurve(first.x, first.y, first.heading, tuple(pieces))
    starts = np.r_[0.0, np.cumsum([piece.length for piece in pieces])][:-1]
    told = np.array([(each.x, each.y, each.heading, each.s) for each in line])
    apart = np.maximum(np.hypot(*(plan.at(starts) - told[:, :2]).T), np.abs(starts - told[:, 3]))
    turned = np.abs(wrap_angle(plan.heading(starts) - told[:, 2]))
    return plan if apart.max() < MEETS and turned.max() < SAME_WAY else None


def walk(line: list[GeometryElement]) -> SampledLine:
    """Returns poses along the reference line, at most about one metre apart, and wherever an element begins.
    Raises UsageError if the line has a gap."""
    parts = [_poses(each) for each in line]
    (_, first), ends = parts[0], [parts[0][1][:1, :2]]
    rows, joins = [first[:-1]], [np.zeros((len(first) - 1, 2))]
    for (s, before), (_, after) in pairwise(parts):
        gap, kink = float(np.hypot(*(after[0, :2] - before[-1, :2]))), wrap_angle(after[0, 2] - before[-1, 2])
        if gap > GAP:
            raise UsageError(f"its line jumps by {gap:.2f} m at s = {s[-1]:.1f}; correct the file")
        middle = [*(before[-1, :2] + after[0, :2]) / 2, after[0, 2] - kink / 2]
        rows += [np.array([middle]), after[1:-1]]
        joins += [np.array([[gap, kink]]), np.zeros((len(after) - 2, 2))]
        ends += [before[-1:, :2], after[:1, :2]]
    s = np.concatenate([part[0][:-1] for part in parts] + [parts[-1][0][-1:]])
    poses = np.concatenate([*rows, parts[-1][1][-1:]])
    gaps, kinks = np.concatenate([*joins, np.zeros((1, 2))]).T
    return SampledLine(s, poses, gaps, kinks, np.concatenate(ends))


def _poses(element: GeometryElement) -> tuple[Array, Array]:
    """Returns stations of an element, both ends included, and the poses there."""
    count = max(FEWEST, int(np.ceil(element.length / STEP)))
    if isinstance(element.shape, Polynomial):
        while count * LEAST < element.length and _strays(element, count):
            count *= 2
    share = np.linspace(0.0, 1.0, count + 1)
    return element.s + share * element.length, element.poses(share)


def _strays(element: GeometryElement, count: int) -> bool:
    poses = element.poses(np.linspace(0.0, 1.0, 2 * count + 1))
    ends, middles = poses[::2], poses[1::2]
    if np.abs(np.diff(ends[:, 2])).max() < HARDLY_TURNS:
        return False
    pieces = clothoids(ends)
    if pieces is None:
        return True
    half, k0, k1 = np.array([(piece.length / 2, piece.k0, piece.k1) for piece in pieces]).T
    x, y = advance(half, ends[:-1, 2], k0, (k1 - k0) / (2 * half), 2 * half)
    away = middles[:, :2] - ends[:-1, :2] - np.stack([x, y], -1)
    aside = away[:, 1] * np.cos(middles[:, 2]) - away[:, 0] * np.sin(middles[:, 2])
    return bool(np.abs(aside).max() > CLOSE)


class PlacedLine(NamedTuple):
    """The reference line of a road, and the stations of the file at stations of the line, both in metres."""

    plan: PieceCurve
    of_file: Array
    own: Array

    def station(self, s: float) -> float:
        """Returns the station on the line of a station in the file."""
        return float(np.interp(s, self.of_file, self.own))

    def part(self, start: float, end: float) -> PieceCurve:
        """Returns the line between two stations of the file."""
        a, b = self.station(start), self.station(end)
        pieces, at = list[Piece](), 0.0
        for piece in self.plan.pieces:
            low, high = max(a - at, 0.0), min(b - at, piece.length)
            if high - low > ROUNDING:
                bend = (piece.k1 - piece.k0) / piece.length
                pieces.append(Piece(high - low, piece.k0 + low * bend, piece.k0 + high * bend))
            at += piece.length
        x, y = self.plan.at(a).tolist()
        return PieceCurve(x, y, float(self.plan.heading(a)), tuple(pieces))

    def moved(self, rows: Sequence[Row], start: float, end: float) -> CubicProfile:
        """Returns cubics of stations of the file, from ``start`` on, as those of stations of ``part``."""
        cubics, first, found = CubicProfile.of_rows(rows), self.station(start), list[Row]()
        knots = [start, *(s for s in self.of_file.tolist() if start < s < end), end]
        for low, high in pairwise(knots):
            at = self.station(low) - first
            ratio = (self.station(high) - first - at) / (high - low)
            for s in (low, *(s for s in cubics.stations if low < s < high)):
                a, b, c, d = cubics.cubic(s)
                found.append((at + (s - low) * ratio, (a, b / ratio, c / ratio**2, d / ratio**3)))
        return closed(found, self.station(end) - first)


def placed_line(road: Element, remarks: MapRemarks, where: str) -> PlacedLine:
    """Returns the reference line of a road, whose records are in order. Raises UsageError if it cannot be
    read, or if no curve follows it."""
    line = reference_line(road)
    plan = exact(line)
    if plan is not None:
        ends = np.array([0.0, plan.length])
        return PlacedLine(plan, ends, ends)
    walked = walk(line)
    back = turns_back(walked)
    if back is not None:
        turned = f"{math.degrees(back[1]):.0f} degrees at s = {back[0]:.1f}"
        raise UsageError(f"its line turns back by {turned}; correct the file")
    near = fitted(walked)
    fit = near or smoothed(walked)
    if fit is None:
        raise UsageError("its line has gaps or kinks so close together that no curve follows it")
    plan, of_file, own = fit
    missed = misses(walked)
    if missed or near is None:
        apart = float(np.abs(project(plan, np.concatenate([walked.poses[:, :2], walked.ends]))[1]).max())
        what = f"{missed or 'too rough'}, at most {apart:.2f} m from the file's line"
        remarks.add("its line has kinks or gaps, and is rounded off there", where, what)
    kept = _bends(of_file, own)
    return PlacedLine(plan, of_file[kept], own[kept])


def _bends(s: Array, own: Array) -> list[int]:
    """Returns the indices of those values that straight lines between them need to be right everywhere."""
    kept, parts = {0, len(s) - 1}, [(0, len(s) - 1)]
    while parts:
        first, last = parts.pop()
        ends = [first, last]
        away = np.abs(own[first:last] - np.interp(s[first:last], s[ends], own[ends]))
        if away.max() > MISSED:
            worst = first + int(away.argmax())
            kept.add(worst)
            parts += [(first, worst), (worst, last)]
    return sorted(kept)
