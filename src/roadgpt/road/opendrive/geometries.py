"""Evaluates the geometry elements of an OpenDRIVE reference line: position and heading along each element."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Protocol
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.brief.words import LONGEST_ROAD
from roadgpt.errors import UsageError
from roadgpt.geometry import Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import Cubic
from roadgpt.road.opendrive.numbers import number
from roadgpt.road.road import check_length

KNOWN = ("line", "arc", "spiral", "poly3", "paramPoly3")
SHORTEST = 1e-3  # m; shorter elements are merged with the previous ones
FINE = 0.1  # m between the places at which the length of a polynomial is summed
MOST_PLACES = 20_000
MOST = 4_000  # elements of one line
OFF = 0.1  # m, allowed between the end of an element and the station of the next
SMALLEST_RADIUS = 0.1  # m
SMALLEST = 1e-9  # m, length given to an element of zero length
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)


class Shape(Protocol):
    """The shape of a geometry element in local coordinates: it starts at the origin along +x."""

    def poses(self, share: Array) -> Array:
        """Returns the poses (x, y, heading) at given fractions (0 to 1) of the length, as rows ``(n, 3)``."""
        ...


@dataclass(frozen=True)
class GeometryElement:
    """One geometry element of the reference line, with the station and pose of its start, and its shape."""

    s: float
    x: float
    y: float
    heading: float
    length: float
    """Length of the element in metres, as stated in the file."""
    shape: Shape

    def poses(self, share: Array) -> Array:
        """Returns the poses (x, y, heading) at given fractions (0 to 1) of the length, as rows ``(n, 3)``."""
        u, v, turned = self.shape.poses(share).T
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return np.stack([self.x + u * cos - v * sin, self.y + u * sin + v * cos, self.heading + turned], -1)


@dataclass(frozen=True)
class PieceShape:
    """The shape of a line, an arc or a spiral."""

    piece: Piece

    def poses(self, share: Array) -> Array:
        """Implements ``Shape.poses``."""
        curve = PieceCurve(0.0, 0.0, 0.0, (self.piece,))
        s = share * self.piece.length
        return np.column_stack([curve.at(s), curve.heading(s)])


@dataclass(frozen=True)
class Polynomial:
    """A curve (u(p), v(p)), where u and v are cubic polynomials and p runs from 0 to ``end``."""

    u: Cubic
    v: Cubic
    end: float

    @cached_property
    def _walked(self) -> tuple[Array, Array]:
        """Returns values of the parameter p, and the arc length in metres up to each."""
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
        """Implements ``Shape.poses``."""
        p_table, walked = self._walked
        p = np.interp(share * walked[-1], walked, p_table)
        x, y = self._at(p)
        du, dv = self._slope(p)
        heading = np.arctan2(dv, du)
        return np.stack([x, y, np.unwrap(heading) if len(heading) else heading], -1)


def reference_line(road: Element) -> list[GeometryElement]:
    """Returns the geometry elements of a road's reference line, which ``in_order`` has sorted. Raises
    UsageError if there are none, or if one is unknown or invalid.
    """
    nodes = road.findall("planView/geometry")
    if len(nodes) > MOST:
        raise UsageError(f"its line has more than {MOST:,} elements; cut out the part that you need")
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
        return PieceShape(Piece(length))
    if node.tag in ("arc", "spiral"):
        names = ("curvStart", "curvEnd") if node.tag == "spiral" else ("curvature", "curvature")
        k0, k1 = (number(node, name) for name in names)
        if max(abs(k0), abs(k1)) * SMALLEST_RADIUS > 1:
            if length < SMALLEST_RADIUS:
                return PieceShape(Piece(length))  # too short to be a bend: its turn becomes a kink at its end
            raise UsageError(f"the {node.tag} at s = {s:g} turns more tightly than {SMALLEST_RADIUS:g} m")
        return PieceShape(Piece(length, k0, k1))
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
