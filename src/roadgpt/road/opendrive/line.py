"""Computes the plan curve of a Road from the reference line and the lanes of an OpenDRIVE file.

exact      keeps the reference line, if it consists of lines, arcs and spirals that meet
fitted     joins poses one metre apart by clothoids; leaves out poses near gaps between elements

If there are too many gaps between elements for clothoids, ``read_opendrive`` fits a spline."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.brief.words import LONGEST_ROAD
from roadgpt.errors import UsageError
from roadgpt.geometry import Piece, PieceCurve, wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import Cubic
from roadgpt.geometry.pieces import advance, joined
from roadgpt.road.opendrive.profile import Lanes
from roadgpt.road.opendrive.tree import number
from roadgpt.road.road import check_length

KNOWN = ("line", "arc", "spiral", "poly3", "paramPoly3")
SHORTEST = 1e-3  # m; shorter elements are merged with the previous ones
FINE = 0.1  # m between the places at which the length of a polynomial is summed
MOST_PLACES = 20_000
MOST_ELEMENTS = 4_000  # of one line
OFF = 0.1  # m, allowed between the end of an element and the station of the next
SMALLEST_RADIUS = 0.1  # m
SMALLEST = 1e-9  # m, length given to an element of zero length
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
ROUNDS = 12  # Newton steps of a clothoid; three are enough for gentle bends
_NODES_24, _WEIGHTS_24 = np.polynomial.legendre.leggauss(24)
_TAU, _W = (_NODES_24 + 1) / 2, _WEIGHTS_24 / 2
BLOCK = 20_000  # clothoids at a time, to spare memory
KINK = 0.01  # rad; larger kinks are reported
TOLD = 0.01  # m; larger gaps are reported
BACK = math.pi / 2  # rad; where the heading jumps by more, the line runs back on itself
GENTLE = 0.002  # 1/m, curvature that bridging a join may add
FARTHEST = 2.5  # m before and behind a join
NEAREST = 0.1  # m; joins that need less are left unchanged
SHORT = 1.0  # m; a shorter element between two joins is skipped
SHARE = 0.45  # of any other element, that a join may take at either end
CLOSEST = 0.05  # m between the poses of a bridged line
WIDEST = 12.0  # m between two poses; over a larger gap the line cannot be reconstructed
MEETS = 5e-4  # m, between the end of an element and the start of the next
SAME_WAY = 1e-4  # rad
GAP = 0.3  # m; a larger gap is refused
STEP = 1.0  # m between the poses of the clothoids; less where they would leave the line
CLOSE = 1e-4  # m, between clothoids and the line
HARDLY_TURNS = 0.02  # rad; over such a slight turn a clothoid deviates by micrometres
LEAST = 0.1  # m between the poses of a polynomial
FEWEST = 2  # parts of an element: its middle tells its direction best
TOGETHER = 1e-3  # m; joints closer together than this are merged
NODES, APART = 5.0, 0.5  # m between the places of a line with very close joins, and at least
LEFT_OVER = 0.05  # m of lane edge that must remain per m of line in a bend


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


def clothoids(poses: Array) -> list[Piece] | None:
    """Returns the clothoids that join consecutive poses, rows (x, y, heading) in metres and radians, ``(n +
    1, 3)``; None if two poses cannot be joined. Every clothoid ends at the next pose, so errors do not add
    up.

    The only unknown, the change of curvature, is found with Newton's method. Source: Bertolazzi and Frego, G1
    fitting with clothoids, Mathematical Methods in the Applied Sciences 38 (2015)."""
    found: list[Piece] = []
    for first in range(0, len(poses) - 1, BLOCK):
        some = _block(poses[first : first + BLOCK + 1])
        if some is None:
            return None
        found += some
    return found


def _block(poses: Array) -> list[Piece] | None:
    chord = np.diff(poses[:, :2], axis=0)
    reach = np.hypot(chord[:, 0], chord[:, 1])
    along = np.arctan2(chord[:, 1], chord[:, 0])
    first, last = wrap_angle(poses[:-1, 2] - along), wrap_angle(poses[1:, 2] - along)
    turn = last - first
    a = 3 * (first + last)
    for _ in range(ROUNDS):
        angle = _angle(a, turn, first)
        across = np.sin(angle) @ _W
        slope = (np.cos(angle) * (_TAU * (_TAU - 1))) @ _W
        a = a - across / np.where(np.abs(slope) < 1e-3, -1 / 6, slope)
    angle = _angle(a, turn, first)
    shrunk = np.cos(angle) @ _W
    missed = np.abs(np.sin(angle) @ _W)
    if not (np.isfinite(a).all() and (shrunk > 0.1).all() and (missed < 1e-9).all()):
        return None
    length = reach / shrunk
    k0 = (turn - a) / length
    k1 = (turn + a) / length
    return [Piece(*row) for row in np.column_stack([length, k0, k1]).tolist()]


def _angle(a: Array, turn: Array, first: Array) -> Array:
    """Returns the heading relative to the chord, ``(n, 24)``, at the nodes of integration."""
    return np.asarray(first[:, None] + _TAU * ((turn - a)[:, None] + _TAU * a[:, None]))


@dataclass(frozen=True)
class SampledLine:
    """Poses along the inner edge of the driving lanes, or along the reference line."""

    s: Array  # station at each pose, as measured in the file, ``(n,)``
    poses: Array  # one row (x, y, heading) per pose, ``(n, 3)``, in metres and radians
    gaps: Array
    """Distance in metres between the ends of the two elements that meet at each pose, ``(n,)``; 0 where no
    elements meet."""
    kinks: Array  # jump of the heading in radians at each pose, ``(n,)``; 0 where no elements meet
    ends: Array
    """Points ``(m, 2)`` in metres where the elements of the file begin and end. Where two elements meet, the
    pose is halfway between the end of one and the start of the next."""

    def only(self, kept: Array) -> "SampledLine":
        """Returns a line with only the poses that a boolean mask or an array of indices selects."""
        return SampledLine(self.s[kept], self.poses[kept], self.gaps[kept], self.kinks[kept], self.ends)


def bridged(line: SampledLine) -> SampledLine | None:
    """Returns the line without the poses close to places where elements do not meet exactly; None if the
    remaining poses are too far apart to be joined by clothoids.

    Files contain rounded numbers, and some elements are shorter than the rounding errors. A curve through
    every pose would oscillate there: an error of 1 cm within one metre causes a bend with a radius of 33 m.
    The larger the error, the more poses are left out."""
    kept = _thinned(line.s, _away_from_joins(line))
    if np.diff(line.s[kept]).max() > WIDEST:
        return None
    # the heading of a very short element at an end is noise
    poses = line.poses.copy()
    poses[0, 2] += line.kinks[line.s < line.s[0] + NEAREST].sum()
    poses[-1, 2] -= line.kinks[line.s > line.s[-1] - NEAREST].sum()
    return replace(line, poses=poses).only(kept)


def corners(line: SampledLine) -> list[int]:
    """Returns the indices of poses about 5 m apart, and of those at kinks, through which a smooth line leads
    where the joins of elements are too close together for ``bridged``."""
    kept = [0]
    for i in range(1, len(line.s) - 1):
        since = line.s[i] - line.s[kept[-1]]
        is_corner = abs(line.kinks[i]) > KINK / 10
        if (since >= NODES or (is_corner and since > APART)) and line.s[-1] - line.s[i] > APART:
            kept.append(i)
    return [*kept, len(line.s) - 1]


def smoothed(line: SampledLine) -> tuple[PieceCurve, Array, Array] | None:
    """Returns a curve as ``fitted`` does, of clothoids through the ``corners`` only, in the directions of
    their neighbours."""
    kept = np.array(corners(line))
    points = line.poses[kept, :2]
    if len(points) < 3:
        return None
    chords = np.diff(points, axis=0)
    length = np.hypot(*chords.T)
    along = np.unwrap(np.arctan2(chords[:, 1], chords[:, 0]))
    # the longer a chord, the less it says about the direction at its end
    middle = (along[:-1] * length[1:] + along[1:] * length[:-1]) / (length[1:] + length[:-1])
    heading = np.r_[2 * along[0] - middle[0], middle, 2 * along[-1] - middle[-1]]
    pieces = clothoids(np.column_stack([points, heading]))
    if pieces is None:
        return None
    stations = np.r_[0.0, np.cumsum([piece.length for piece in pieces])]
    x, y = points[0].tolist()
    return PieceCurve(x, y, float(heading[0]), joined(pieces)), line.s[kept], stations


def turns_back(line: SampledLine) -> tuple[float, float] | None:
    """Returns the station (m) and angle (rad) of a kink after which the line runs backwards, if any."""
    kept = bridged(line)
    for i in np.flatnonzero(np.abs(line.kinks) > BACK):
        turned = line.kinks[i]
        if kept is not None:
            behind = min(max(int(np.searchsorted(kept.s, line.s[i])), 1), len(kept.s) - 1)
            turned = wrap_angle(kept.poses[behind, 2] - kept.poses[behind - 1, 2])
        if abs(turned) > BACK:
            return float(line.s[i]), float(abs(turned))
    return None


def _away_from_joins(line: SampledLine) -> Array:
    # a clothoid of length l that closes a gap g has a curvature of 6 g / l^2, for a kink d of 4 d / l
    wanted = np.maximum(np.sqrt(1.5 * line.gaps / GENTLE), 2 * np.abs(line.kinks) / GENTLE)
    joins = np.flatnonzero(wanted > NEAREST)
    kept = np.ones(len(line.s), bool)
    if joins.size:
        at = line.s[joins]
        room = np.diff(at, prepend=line.s[0], append=line.s[-1])
        room = np.where(room > SHORT, SHARE * room, np.inf)
        reach = np.minimum(wanted[joins], FARTHEST)
        first = np.searchsorted(line.s, at - np.minimum(reach, room[:-1]), side="right")
        last = np.searchsorted(line.s, at + np.minimum(reach, room[1:]), side="left")
        for begin, end in zip(first.tolist(), last.tolist(), strict=True):
            kept[begin:end] = False
    kept[[0, -1]] = True
    return kept


def _thinned(s: Array, kept: Array) -> Array:
    out = [0]
    for i in np.flatnonzero(kept)[1:].tolist():
        if s[i] - s[out[-1]] >= CLOSEST:
            out.append(i)
    last = len(s) - 1
    if out[-1] != last:
        out = [*(out[:-1] if len(out) > 1 else out), last]
    return np.array(out)


def misses(line: SampledLine) -> str:
    """Returns how many noticeable kinks and gaps the line has, and the largest of each; "" if it has none."""
    kinks, gaps = np.abs(line.kinks), line.gaps
    parts = []
    for errors, least, name, unit in (
        (np.degrees(kinks), np.degrees(KINK), "kink", "degrees"),
        (gaps, TOLD, "gap", "m"),
    ):
        count = int((errors > least).sum())
        if count:
            worst = int(errors.argmax())
            size = f"{errors[worst]:.1f}" if unit == "degrees" else f"{errors[worst]:.2f}"
            up_to, most = ("of", "") if count == 1 else ("of up to", "the worst ")
            parts.append(
                f"{count} {name}{'s' * (count > 1)} {up_to} {size} {unit} ({most}at s = {line.s[worst]:.1f})"
            )
    return " and ".join(parts)


def exact(line: list[GeometryElement], meets: float = MEETS, same_way: float = SAME_WAY) -> PieceCurve | None:
    """Returns the reference line unchanged; None if it is not made of lines, arcs and spirals that meet. Each
    follows the one before and begins at most ``meets`` metres and ``same_way`` radians from where its file
    has it."""
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
    return plan if apart.max() < meets and turned.max() < same_way else None


def lies_on_the_line(lanes: Lanes, length: float) -> bool:
    """Returns whether the inner edge of the driving lanes coincides with the reference line."""
    s = np.linspace(0.0, length, max(FEWEST, int(length / STEP) + 1))
    s = np.unique(np.r_[s, [each for each in lanes.joints() if 0 <= each <= length]])
    t, slope = lanes.edge(s)
    return bool(np.abs(t).max() < 1e-9 and np.abs(slope).max() < 1e-9)


def walk(line: list[GeometryElement], lanes: Lanes | None) -> SampledLine:
    """Returns poses along the inner edge of the driving lanes, or along the reference line if ``lanes`` is
    None.

    The poses are at most about one metre apart. There is also a pose wherever an element begins, and wherever
    the inner edge may have a kink (``Lanes.joints``). Raises UsageError if the line has a gap, the edge
    jumps, or the edge comes too close to the centre of a bend."""
    joints = np.unique(lanes.joints()) if lanes else np.empty(0)
    parts = [part for each in line for part in _parts(each, joints, lanes)]
    gaps, kinks = [np.zeros(len(parts[0][0]) - 1)], [np.zeros(len(parts[0][0]) - 1)]
    rows = [parts[0][1][:-1]]
    ends = [parts[0][1][:1, :2]]
    for (s, before), (_, after) in pairwise(parts):
        gap, kink = float(np.hypot(*(after[0, :2] - before[-1, :2]))), wrap_angle(after[0, 2] - before[-1, 2])
        if gap > GAP:
            what, advice = ("the edge of its lane", "") if lanes else ("its line", "; correct the file")
            raise UsageError(f"{what} jumps by {gap:.2f} m at s = {s[-1]:.1f}{advice}")
        nothing = np.zeros(len(after) - 2)
        gaps.append(np.r_[gap, nothing])
        kinks.append(np.r_[kink, nothing])
        middle = [*(before[-1, :2] + after[0, :2]) / 2, after[0, 2] - kink / 2]
        rows += [np.array([middle]), after[1:-1]]
        ends += [before[-1:, :2], after[:1, :2]]
    s = np.concatenate([part[0][:-1] for part in parts] + [parts[-1][0][-1:]])
    end = np.zeros(1)
    poses = np.concatenate([*rows, parts[-1][1][-1:]])
    missed, turned = np.concatenate([*gaps, end]), np.concatenate([*kinks, end])
    return SampledLine(s, poses, missed, turned, np.concatenate(ends))


def _parts(element: GeometryElement, joints: Array, lanes: Lanes | None) -> Iterator[tuple[Array, Array]]:
    start, end = element.s, element.s + element.length
    count = max(FEWEST, int(np.ceil(element.length / STEP)))
    if isinstance(element.shape, Polynomial):
        while count * LEAST < element.length and _strays(element, count):
            count *= 2
    even = np.linspace(start, end, count + 1)
    cuts = [start, *joints[(joints > start + TOGETHER) & (joints < end - TOGETHER)], end]
    cuts = [start, *(b for a, b in pairwise(cuts[:-1]) if b - a > TOGETHER), end]
    for a, b in pairwise(cuts):
        s = np.r_[a, even[(even > a + TOGETHER) & (even < b - TOGETHER)], b]
        share = np.clip((s - start) / element.length, 0.0, 1.0)
        poses = element.poses(share)
        yield s, poses if lanes is None else _moved_aside(s, poses, lanes)


def _moved_aside(s: Array, poses: Array, lanes: Lanes) -> Array:
    """Returns the poses moved onto the edge of the lane; at both ends, the lanes just inside are used."""
    inside = min(TOGETHER, float(s[-1] - s[0]) / 4)
    at = np.clip(s, s[0] + inside, s[-1] - inside)
    t, slope = lanes.edge(at)
    t = t + slope * (s - at)
    bend = np.diff(poses[:, 2]) / np.diff(s)
    stays = 1 - t * np.r_[bend, bend[-1:]]
    if (stays < LEFT_OVER).any():
        raise UsageError(f"the edge of its lane folds in the bend at s = {s[int(stays.argmin())]:.1f}")
    x = poses[:, 0] - t * np.sin(poses[:, 2])
    y = poses[:, 1] + t * np.cos(poses[:, 2])
    return np.stack([x, y, poses[:, 2] + np.arctan2(slope, stays)], -1)


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


def fitted(line: SampledLine) -> tuple[PieceCurve, Array, Array] | None:
    """Returns a curve of clothoids through the poses, and the stations in metres of these poses, in the file
    and on the curve. Poses near gaps between elements are left out. Returns None if clothoids cannot follow
    the line."""
    kept = bridged(line)
    pieces = clothoids(kept.poses) if kept is not None else None
    if kept is None or pieces is None:
        return None
    x, y, heading = kept.poses[0].tolist()
    stations = np.r_[0.0, np.cumsum([piece.length for piece in pieces])]
    return PieceCurve(x, y, heading, joined(pieces)), kept.s, stations
