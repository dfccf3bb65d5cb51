"""Says which lanes lead where at a junction.

Traffic that turns to the rightmost arm keeps to the rightmost lane, traffic that turns to the leftmost arm to
the leftmost lane; all other ways on have all lanes, as many as both roads have.
"""

import math
from collections.abc import Iterator, Sequence
from operator import or_

from roadgpt.brief.junctions import side_of
from roadgpt.geometry.curve import wrap_angle
from roadgpt.network.building import Stub

LaneWay = tuple[tuple[int, int], ...]
"""Pairs of lanes that continue each other, from left to right: indices of a lane that leads into the junction
and of a lane that leads out of it, counted from 0 at the centre line."""


def lane_ways(stubs: Sequence[Stub], start: int) -> Iterator[tuple[int, LaneWay]]:
    """Yields the arms to which one can go from an arm, each with the lanes that lead there.

    Args:
        stubs: The arms in counter-clockwise order.
        start: Index of the arm on which one arrives.
    """
    count = len(stubs)
    others = [(start + n) % count for n in range(1, count)]
    exits = [j for j in others if stubs[start].into and stubs[j].out_of]
    turns = [side_of(_turn(stubs[start], stubs[j])) for j in exits]
    into = len(stubs[start].into)
    is_rightmost = [n == 0 and side == "right" and len(exits) > 1 for n, side in enumerate(turns)]
    is_leftmost = [n == len(exits) - 1 and side == "left" and n > 0 for n, side in enumerate(turns)]
    # without a way straight on, those to the left and to the right share all lanes
    has_through = not all(map(or_, is_rightmost, is_leftmost))
    left = 1 if has_through else max(into - into // 2, 1)
    right = 1 if has_through else max(into // 2, 1)
    for n, j in enumerate(exits):
        out_of = len(stubs[j].out_of)
        if is_rightmost[n]:
            lanes = min(right, out_of)
            yield j, tuple((into - lanes + k, out_of - lanes + k) for k in range(lanes))
        else:
            lanes = min(left if is_leftmost[n] else into, out_of)
            yield j, tuple((k, k) for k in range(lanes))


def _turn(start: Stub, end: Stub) -> float:
    return math.degrees(float(wrap_angle(end.direction - start.direction - math.pi)))
