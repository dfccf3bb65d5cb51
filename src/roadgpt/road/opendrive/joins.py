"""Bridges those places of an OpenDRIVE road where elements, or the edges of lanes, do not meet exactly.

Files contain rounded numbers, and some elements are shorter than the rounding errors. A curve through every
pose would oscillate there: an error of 1 cm within one metre causes a bend with a radius of 33 m. Poses close
to such a place are therefore left out. The larger the error, the more poses are left out.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import Array

KINK = 0.01  # rad; larger kinks are reported
TOLD = 0.01  # m; larger gaps are reported
BACK = math.pi / 2  # rad; where the heading jumps by more, the line runs back on itself
GENTLE = 0.002  # 1/m, curvature that bridging a join may add
FARTHEST = 2.5  # m before and behind a join
NEAREST = 0.1  # m; joins that need less are left unchanged
SHORT = 1.0  # m; a shorter element between two joins is skipped
SHARE = 0.45  # share of any other element that a join may take at either end
CLOSEST = 0.05  # m between two poses
WIDEST = 12.0  # m between two poses; over a larger gap the line cannot be reconstructed


@dataclass(frozen=True)
class SampledLine:
    """Poses along the inner edge of the driving lanes, or along the reference line."""

    s: Array
    """Station at each pose, as measured in the file, ``(n,)``."""
    poses: Array
    """One row (x, y, heading) per pose, ``(n, 3)``, in metres and radians."""
    gaps: Array
    """Distance in metres between the ends of the two elements that meet at each pose, ``(n,)``; 0 where no
    elements meet.
    """
    kinks: Array
    """Jump of the heading in radians at each pose, ``(n,)``; 0 where no elements meet."""
    ends: Array
    """Points ``(m, 2)`` in metres where the elements of the file begin and end.

    Where two elements meet, the pose is halfway between the end of one and the start of the next.
    """

    def only(self, kept: Array) -> "SampledLine":
        """Returns a line with only the poses selected by ``kept``, which is a boolean mask or an array of
        indices.
        """
        return SampledLine(self.s[kept], self.poses[kept], self.gaps[kept], self.kinks[kept], self.ends)


def bridged(line: SampledLine) -> SampledLine | None:
    """Returns the line without the poses close to places where elements do not meet exactly; None if the
    remaining poses are too far apart to be joined by clothoids.
    """
    kept = _thinned(line.s, _away_from_joins(line))
    if np.diff(line.s[kept]).max() > WIDEST:
        return None
    # the heading of a very short element at an end is noise
    poses = line.poses.copy()
    poses[0, 2] += line.kinks[line.s < line.s[0] + NEAREST].sum()
    poses[-1, 2] -= line.kinks[line.s > line.s[-1] - NEAREST].sum()
    return replace(line, poses=poses).only(kept)


def turns_back(line: SampledLine) -> tuple[float, float] | None:
    """Returns the station (m) and angle (rad) of a kink after which the line runs backwards; None if
    there is no such kink.
    """
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
    """Returns the indices of the kept poses, no two closer together than clothoids can resolve."""
    out = [0]
    for i in np.flatnonzero(kept)[1:].tolist():
        if s[i] - s[out[-1]] >= CLOSEST:
            out.append(i)
    last = len(s) - 1
    if out[-1] != last:
        out = [*(out[:-1] if len(out) > 1 else out), last]
    return np.array(out)


def misses(line: SampledLine) -> str:
    """Returns a text that states how many noticeable kinks and gaps the line has, and the largest kink and
    gap; an empty text if there are none.
    """
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
