"""Corrects straights whose measured lengths or grades differ from the required ones.

The parabola that joins the grades of two straights takes up a part of both. A level straight is measured only
where the road is level, so it loses length to a steep neighbour, and the mean grade of the steep one falls.
The planner therefore measures a draft, corrects joints and grades by the errors, and measures again.
"""

from collections.abc import Sequence
from itertools import groupby, pairwise
from math import ceil, copysign

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.words import Range
from roadgpt.check.measures import MeasuredFeature, Measures, way
from roadgpt.design.vertical import Pace
from roadgpt.geometry.curve import Array

SHORTEST = 4.0  # m that a correction leaves of a straight
TENTH = 10.0  # per percent


def with_vertical_radii(
    elements: Sequence[Element], pace: Pace, ease: float, bumps: bool = False
) -> list[Element]:
    """Returns the elements with vertical radii for consecutive straights.

    Radii are set only if at least one of the consecutive straights has a fixed length.

    Args:
        elements: the elements of a draft, in driving order.
        pace: the vertical radii that the expected speeds require.
        ease: share of the comfortable radius, from 0 (only as large as the rule requires) to 1.
        bumps: True if a crest or a dip was requested, so that the vertical acceleration may reach gravity.
    """
    out, ends = list(elements), np.cumsum([element.length for element in elements])
    for row in _rows(elements):
        if any(elements[i].has_fixed_length for i in row):
            for i in row[1:]:
                out[i] = out[i]._replace(vertical_radius=pace.eased(float(ends[i - 1]), ease, bumps))
    return out


def corrected(elements: Sequence[Element], ends: Array, found: Measures, limit: Range) -> list[Element]:
    """Returns the elements with joints and grades of straights corrected by the measured errors.

    Between two turns, nothing is corrected if the measured straights do not correspond to those of the draft.

    Args:
        elements: the elements of the draft that was measured, in driving order.
        ends: station in metres at which each element should end.
        found: the measured road.
        limit: range of inclines that are allowed, in percent.
    """
    out = list(elements)
    if len(found.turns) != sum(bool(element.turn) for element in elements):
        return out
    joints = np.cumsum([0.0, *(element.length for element in elements)])
    for row, gap in zip(_rows(elements), found.gaps, strict=True):
        pieces = [piece for straight in gap for piece in straight.pieces]
        runs = [[*run] for _, run in groupby(row, key=lambda i: way(elements[i].incline))]
        if len(pieces) != len(runs) or not any(elements[i].has_fixed_length for i in row):
            continue
        for run, piece in zip(runs, pieces, strict=True):
            last = run[-1]
            if last != row[-1] and (out[last].has_fixed_length or out[last + 1].has_fixed_length):
                joints[last + 1] += ends[last] - piece.end
            if len(run) == 1:
                out[last] = _with_grade(out[last], piece, limit)
        lengths = _spread(np.diff(joints[row.start : row.stop + 1]))
        for i, length in zip(row, lengths.tolist(), strict=True):
            out[i] = out[i]._replace(straight=length)
    return out


def _rows(elements: Sequence[Element]) -> list[range]:
    """Returns the indices of the straights before the first turn, between two turns, and after the last."""
    marks = [-1, *(i for i, element in enumerate(elements) if element.turn), len(elements)]
    return [range(a + 1, b) for a, b in pairwise(marks)]


def _with_grade(element: Element, seen: MeasuredFeature, limit: Range) -> Element:
    """Returns a straight of fixed length with the grade at which its mean grade is the required one."""
    asked = element.required_grade
    if not asked or not element.has_fixed_length or 0 in asked or seen.inner_grade in asked:
        return element
    missing = min(max(seen.grade, asked.lo), asked.hi) - seen.grade
    grade = element.incline + copysign(ceil(abs(missing) * TENTH) / TENTH, missing)
    grade = min(max(grade, asked.lo, limit.lo), asked.hi, limit.hi)
    return element._replace(incline=round(grade, 1))


def _spread(lengths: Array) -> Array:
    """Returns lengths of the same sum, none below ``SHORTEST`` if there is room for that."""
    spare = np.maximum(lengths - SHORTEST, 0.0)
    room = max(float(lengths.sum()) - SHORTEST * len(lengths), 0.0)
    if not room or (lengths >= SHORTEST).all():
        return lengths
    return np.asarray(SHORTEST + spare * room / spare.sum())
