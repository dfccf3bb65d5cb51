"""Whether two boxes touch, and where a line is in a box, for compiled code."""

import math

from roadgpt.compiled import compiled, inlined


@compiled
def touch(
    dx: float, dy: float, heading: float, length: float, width: float, heading_2: float, length_2: float,
    width_2: float,
) -> bool:  # fmt: skip
    """Returns whether two boxes seen from above touch: no line along a side of one of them separates them.
    ``dx`` and ``dy`` lead from the middle of the first to that of the second; everything is in metres and
    radians."""
    if 2.0 * math.hypot(dx, dy) > math.hypot(length, width) + math.hypot(length_2, width_2):
        return False
    c, s = abs(math.cos(heading_2 - heading)), abs(math.sin(heading_2 - heading))
    own, other = (math.cos(heading), math.sin(heading)), (math.cos(heading_2), math.sin(heading_2))
    return not (
        2.0 * abs(dx * own[0] + dy * own[1]) > length + length_2 * c + width_2 * s
        or 2.0 * abs(dy * own[0] - dx * own[1]) > width + length_2 * s + width_2 * c
        or 2.0 * abs(dx * other[0] + dy * other[1]) > length_2 + length * c + width * s
        or 2.0 * abs(dy * other[0] - dx * other[1]) > width_2 + length * s + width * c
    )


@inlined
def part_inside(
    along: float, aside: float, forward: float, sideways: float, length: float, width: float, low: float,
    high: float,
) -> tuple[float, float]:  # fmt: skip
    """Returns between which multiples of its direction, from ``low`` to ``high``, a line is in a box; the
    first is the larger one if it is not. The place ``(along, aside)`` on the line and its direction
    ``(forward, sideways)`` are those seen from the middle of the box along its heading, in metres."""
    for axis in range(2):
        here, slope = (along, forward) if axis == 0 else (aside, sideways)
        room = (length if axis == 0 else width) / 2.0
        if abs(slope) < 1e-9:
            if abs(here) > room:
                return 1.0, 0.0
        else:
            one, two = (-room - here) / slope, (room - here) / slope
            low, high = max(low, min(one, two)), min(high, max(one, two))
    return low, high
