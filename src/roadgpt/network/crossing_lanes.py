"""Says which lanes lead where at a junction.

Traffic that turns to the rightmost arm keeps to the rightmost lane, traffic that turns to the leftmost arm to
the leftmost lane; other ways on have all lanes, as many as both roads have. Where a lane would lead nowhere,
every way has lanes of its own. Ways from one arm never cross.
"""

import math
from collections.abc import Iterator, Sequence

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
    into, room = len(stubs[start].into), [len(stubs[j].out_of) for j in exits]
    turns_right = bool(exits) and turns[0] == "right" and len(exits) > 1
    turns_left = bool(exits) and turns[-1] == "left" and len(exits) > 1
    spans = _usual_spans(into, room, turns_right, turns_left)
    if len({n for span in spans for n in span}) < min(into, sum(room)) and len(exits) <= into:
        spans = _spans_of_their_own(into, room, turns_right, turns_left)
    for n, j in enumerate(exits):
        lanes = spans[n]
        beside = room[n] - len(lanes) if turns_right and n == 0 else 0
        yield j, tuple((i, beside + k) for k, i in enumerate(lanes))


def _usual_spans(into: int, room: Sequence[int], turns_right: bool, turns_left: bool) -> list[range]:
    """Returns the lanes that lead to each exit, where exits may share lanes.

    Args:
        into: The number of lanes that lead into the junction.
        room: The number of lanes of each exit, from the right to the left.
        turns_right: Whether the first exit is for traffic that turns right.
        turns_left: Whether the last exit is for traffic that turns left.
    """
    through = len(room) - turns_right - turns_left
    # without a way straight on, those to the left and to the right share all lanes
    left = 1 if through else max(into - into // 2, 1)
    right = 1 if through else max(into // 2, 1)
    found = []
    for n, most in enumerate(room):
        if turns_right and n == 0:
            found.append(range(into - min(right, most), into))
        elif turns_left and n == len(room) - 1:
            found.append(range(min(left, most)))
        else:
            place = len(room) - 1 - turns_left - n  # 0 for the leftmost way on
            first, last = (round(k * (into - 1) / through) for k in (place, place + 1))
            found.append(range(first, min(last + 1, first + most)))
    return found


def _spans_of_their_own(into: int, room: Sequence[int], turns_right: bool, turns_left: bool) -> list[range]:
    """Returns the lanes that lead to each exit, where no lane leads to two exits; see ``_usual_spans``."""
    sizes = [1] * len(room)
    order = range(turns_right, len(room) - turns_left), range(len(room))
    for n in (n for each in order for n in each):
        sizes[n] = min(room[n], sizes[n] + into - sum(sizes))
    found = []
    for n, size in enumerate(sizes):
        first = into - size if turns_right and n == 0 else sum(sizes[n + 1 :])
        found.append(range(first, first + size))
    return found


def _turn(start: Stub, end: Stub) -> float:
    return math.degrees(float(wrap_angle(end.direction - start.direction - math.pi)))
