"""Leads a curve past places where the elements of a reference line do not meet, and says what they miss.

``smoothed`` leads through places 5 m apart, where gaps and kinks are too close together for ``fitted``."""

import numpy as np

from roadgpt.geometry import wrap_angle
from roadgpt.geometry.fitting import Fit, SampledLine, bridged, through

KINK = 0.01  # rad; larger kinks are reported
TOLD = 0.01  # m; larger gaps are reported
BACK = np.pi / 2  # rad; where the heading jumps by more, the line runs back on itself
NODES, APART = 5.0, 0.5  # m between the places of a line with very close joins, and at least


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


def smoothed(line: SampledLine) -> Fit | None:
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
    return through(line.s[kept], np.column_stack([points, heading]))


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
