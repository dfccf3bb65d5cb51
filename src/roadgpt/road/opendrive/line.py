"""Computes the plan curve of a Road from the reference line and the lanes of an OpenDRIVE file.

exact      keeps the reference line, if it consists of lines, arcs and spirals that meet
fitted     joins poses one metre apart by clothoids; leaves out poses near gaps between elements

If there are too many gaps between elements for clothoids, ``read_opendrive`` fits a spline.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import PieceCurve, wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import advance, joined
from roadgpt.road.opendrive.fit import clothoids
from roadgpt.road.opendrive.geometries import GeometryElement, PieceShape, Polynomial
from roadgpt.road.opendrive.joins import SampledLine, bridged
from roadgpt.road.opendrive.lanes import Lanes

MEETS = 5e-4  # m, between the end of an element and the start of the next
SAME_WAY = 1e-4  # rad
GAP = 0.3  # m; a larger gap is refused
STEP = 1.0  # m between the poses of the clothoids; less where they would leave the line
CLOSE = 1e-4  # m, between clothoids and the line
GENTLE = 0.02  # rad; over such a slight turn a clothoid deviates by micrometres
LEAST = 0.1  # m; the least distance between poses
FEWEST = 2  # parts of an element: its middle tells its direction best
TOGETHER = 1e-3  # m; joints closer together than this are merged
LEFT_OVER = 0.05  # m of lane edge that must remain per m of line in a bend


def exact(line: list[GeometryElement]) -> PieceCurve | None:
    """Returns the reference line unchanged; None if it is not made of lines, arcs and spirals that meet."""
    shapes = [each.shape for each in line]
    pieces = [shape.piece for shape in shapes if isinstance(shape, PieceShape)]
    if len(pieces) < len(shapes):
        return None
    first = line[0]
    plan = PieceCurve(first.x, first.y, first.heading, tuple(pieces))
    starts = np.r_[0.0, np.cumsum([piece.length for piece in pieces])][:-1]
    told = np.array([(each.x, each.y, each.heading, each.s) for each in line])
    apart = np.maximum(np.hypot(*(plan.at(starts) - told[:, :2]).T), np.abs(starts - told[:, 3]))
    turned = np.abs(wrap_angle(plan.heading(starts) - told[:, 2]))
    return plan if apart.max() < MEETS and turned.max() < SAME_WAY else None


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
    jumps, or the edge comes too close to the centre of a bend.
    """
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
    """Yields the parts, with both ends, into which joints cut an element: stations and poses ``(n, 3)``."""
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
    """Returns whether ``count`` clothoids would be more than ``CLOSE`` metres away from the element."""
    poses = element.poses(np.linspace(0.0, 1.0, 2 * count + 1))
    ends, middles = poses[::2], poses[1::2]
    if np.abs(np.diff(ends[:, 2])).max() < GENTLE:
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
    the line.
    """
    kept = bridged(line)
    pieces = clothoids(kept.poses) if kept is not None else None
    if kept is None or pieces is None:
        return None
    x, y, heading = kept.poses[0].tolist()
    stations = np.r_[0.0, np.cumsum([piece.length for piece in pieces])]
    return PieceCurve(x, y, heading, joined(pieces)), kept.s, stations
