"""From a file's reference line and the edge of its lane to the plan of a Road.

exact      lines, arcs and spirals that meet, and the reference line is the edge: they are taken as they are
fitted     anything else that is smooth: clothoids through poses a metre apart
rounded    where directions jump: a spline
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import PieceCurve, wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import advance, joined
from roadgpt.road.opendrive.fit import clothoids
from roadgpt.road.opendrive.lanes import JUMP, Lanes
from roadgpt.road.opendrive.stretch import Bend, Polynomial, Stretch

MEETS = 5e-4  # m, between the end of an element and the start of the next
SAME_WAY = 1e-4  # rad
GAP = 0.1  # m; a larger one is no road any more
KINK = 0.01  # rad; a larger one cannot be driven through at speed, and is rounded off
STEP = 1.0  # m between the poses that clothoids are fitted to, and less where they would stray
CLOSE = 1e-4  # m, between clothoids and the line
GENTLE = 0.02  # rad; over a turn so slight a clothoid strays by micrometres
LEAST = 0.1  # m; nearer to each other no poses are taken
FEWEST = 2


@dataclass(frozen=True)
class Line:
    """Poses along the edge that is driven along, in stretches without a jump of direction."""

    s: Array
    """Station of each pose in the file, ``(n,)``."""
    poses: Array
    """Rows x, y, heading ``(n, 3)``."""
    kinks: Array
    """By how much the direction jumps at each pose, radians ``(n,)``."""


def exact(line: list[Stretch]) -> PieceCurve | None:
    """The plan as the file has it; None where it is not made of lines, arcs and spirals that meet."""
    shapes = [each.shape for each in line]
    pieces = [shape.piece for shape in shapes if isinstance(shape, Bend)]
    if len(pieces) < len(shapes):
        return None
    first = line[0]
    plan = PieceCurve(first.x, first.y, first.heading, tuple(pieces))
    starts = np.r_[0.0, np.cumsum([piece.length for piece in pieces])][:-1]
    told = np.array([(each.x, each.y, each.heading) for each in line])
    apart = np.hypot(*(plan.at(starts) - told[:, :2]).T)
    turned = np.abs(wrap_angle(plan.heading(starts) - told[:, 2]))
    return plan if apart.max() < MEETS and turned.max() < SAME_WAY else None


def lies_on_the_line(lanes: Lanes, length: float) -> bool:
    """Is the edge that is driven along the reference line itself?"""
    s = np.linspace(0.0, length, max(FEWEST, int(length / STEP) + 1))
    s = np.unique(np.r_[s, [each for each in lanes.joints() if 0 <= each <= length]])
    t, slope = lanes.edge(s)
    return bool(np.abs(t).max() < 1e-9 and np.abs(slope).max() < 1e-9)


def walk(line: list[Stretch], lanes: Lanes | None, cuts: Sequence[float]) -> Line:
    """Poses along the edge of the lane, about a metre apart and wherever something changes.

    Args:
        line: the reference line.
        lanes: whose edge; None for the reference line itself.
        cuts: stations that get a pose of their own.

    Raises:
        UsageError: the line has a gap, the edge jumps, or the edge folds in a bend.
    """
    joints = np.unique([*cuts, *(lanes.joints() if lanes else [])])
    parts = [_part(each, joints, lanes) for each in line]
    for (s, before), (_, after) in pairwise(parts):
        gap = float(np.hypot(*(after[0, :2] - before[-1, :2])))
        if gap > GAP:
            raise UsageError(f"its line jumps by {gap:.2f} m at s = {s[-1]:.1f}; mend the file")
    s = np.concatenate([part[0][:-1] for part in parts] + [parts[-1][0][-1:]])
    kinks = [np.zeros(len(part[0]) - 1) for part in parts] + [np.zeros(1)]
    rows = [part[1][:-1].copy() for part in parts] + [parts[-1][1][-1:].copy()]
    for i in range(1, len(parts)):
        end, start = parts[i - 1][1][-1], parts[i][1][0]
        kinks[i][0] = wrap_angle(start[2] - end[2])
        rows[i][0] = [*(end[:2] + start[:2]) / 2, start[2] - kinks[i][0] / 2]
    return Line(s, np.concatenate(rows), np.concatenate(kinks))


def _part(stretch: Stretch, joints: Array, lanes: Lanes | None) -> tuple[Array, Array]:
    """Stations ``(n,)`` and poses ``(n, 3)`` along one element, both ends included."""
    inside = np.searchsorted(joints, [stretch.s, stretch.s + stretch.length])
    cuts = (joints[inside[0] : inside[1]] - stretch.s) / stretch.length
    count = max(1, int(np.ceil(stretch.length / STEP)))
    while (
        isinstance(stretch.shape, Polynomial) and count * LEAST < stretch.length and _strays(stretch, count)
    ):
        count *= 2
    even = np.linspace(0.0, 1.0, count + 1)
    share = np.unique(np.r_[even, cuts[(cuts > 1e-6) & (cuts < 1 - 1e-6)]])
    keep = np.r_[True, np.diff(share) * stretch.length > 1e-3]
    share = share[keep]
    share[-1] = 1.0
    poses, s = stretch.poses(share), stretch.s + share * stretch.length
    if lanes is None:
        return s, poses
    t, slope = lanes.edge(np.clip(s, stretch.s, stretch.s + stretch.length - 1e-9))
    reach = np.diff(s)
    bend = np.diff(poses[:, 2]) / reach
    stays = 1 - t * np.r_[bend, bend[-1:]]
    if (stays < 0.05).any():
        raise UsageError(f"the edge of its lane folds in the bend at s = {s[int(stays.argmin())]:.1f}")
    # a step shows as a change that the slopes at its ends do not explain
    stepped = np.abs(np.diff(t)) - np.maximum(np.abs(slope[1:]), np.abs(slope[:-1])) * reach
    if stepped.max() > JUMP:
        raise UsageError(f"the edge of its lane jumps at s = {s[int(stepped.argmax())]:.1f}")
    x = poses[:, 0] - t * np.sin(poses[:, 2])
    y = poses[:, 1] + t * np.cos(poses[:, 2])
    return s, np.stack([x, y, poses[:, 2] + np.arctan2(slope, stays)], -1)


def _strays(stretch: Stretch, count: int) -> bool:
    """Would clothoids between so many poses leave the line?"""
    poses = stretch.poses(np.linspace(0.0, 1.0, 2 * count + 1))
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


def fitted(line: Line) -> tuple[PieceCurve, Array] | None:
    """The plan through all poses, and its station at each; None where clothoids cannot follow."""
    pieces = clothoids(line.poses)
    if pieces is None:
        return None
    x, y, heading = line.poses[0].tolist()
    stations = np.r_[0.0, np.cumsum([piece.length for piece in pieces])]
    return PieceCurve(x, y, heading, joined(pieces)), stations
