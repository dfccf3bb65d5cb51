"""Joins: where the elements of a line, or the edges of its lanes, do not meet to the last digit.

Files round their numbers, and tools leave elements that are shorter than their errors. A curve through every
pose would wriggle there: a miss of 1 cm from one metre to the next is a bend of 33 m. So a line is left a
little before such a join and met again a little behind it, the farther the worse the join is.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import Array

KINK = 0.01  # rad; what is told of
TOLD = 0.01  # m; gaps that are told of
BACK = math.pi / 2  # rad; a line that jumps round by more goes back on itself
GENTLE = 0.002  # 1/m, of the wriggle that a join may leave
FARTHEST = 2.5  # m before and behind a join
NEAREST = 0.1  # m; what reaches less far is left as it is
SHORT = 1.0  # m; an element so short between two joins is passed over
SHARE = 0.45  # of any other element, that a join may take at either end
CLOSEST = 0.05  # m between two poses
WIDEST = 12.0  # m between two poses; a line that misses so long has no course


@dataclass(frozen=True)
class SampledLine:
    """Poses along the edge that is driven along."""

    s: Array
    """Station of each pose in the file, ``(n,)``."""
    poses: Array
    """Rows x, y, heading ``(n, 3)``."""
    gaps: Array
    """How far the ends miss each other that meet at each pose, metres ``(n,)``."""
    kinks: Array
    """By how much the direction jumps at each pose, radians ``(n,)``."""
    ends: Array
    """Where the elements of the file end and begin, ``(m, 2)``: a pose between two is in their middle."""

    def only(self, kept: Array) -> "SampledLine":
        """Some of the poses."""
        return SampledLine(self.s[kept], self.poses[kept], self.gaps[kept], self.kinks[kept], self.ends)


def bridged(line: SampledLine) -> SampledLine | None:
    """The line without the poses beside its joins; None where too little is left to tell its course."""
    kept = _thinned(line.s, _away_from_joins(line))
    if np.diff(line.s[kept]).max() > WIDEST:
        return None
    # an element so short at an end has a direction that is noise
    poses = line.poses.copy()
    poses[0, 2] += line.kinks[line.s < line.s[0] + NEAREST].sum()
    poses[-1, 2] -= line.kinks[line.s > line.s[-1] - NEAREST].sum()
    return replace(line, poses=poses).only(kept)


def turns_back(line: SampledLine) -> tuple[float, float] | None:
    """Station and radians of a kink behind which the line runs back on itself; None where there is none."""
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
    # a clothoid of length l that makes up for a gap g bends by 6 g / l^2, for a kink d by 4 d / l
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
    """Indices of what is kept, none nearer to the one before than clothoids can tell apart."""
    out = [0]
    for i in np.flatnonzero(kept)[1:].tolist():
        if s[i] - s[out[-1]] >= CLOSEST:
            out.append(i)
    last = len(s) - 1
    if out[-1] != last:
        out = [*(out[:-1] if len(out) > 1 else out), last]
    return np.array(out)


def misses(line: SampledLine) -> str:
    """How many joins there are to speak of, and how bad the worst are; empty where there are none."""
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
