"""Adds parabolas to drafts, and corrects straights whose measured values are not as required. Main function:
``corrected_draft``.

The parabola that joins the grades of two straights takes up a part of both. A level straight next to a steep
one is therefore measured shorter than designed, and the mean grade of the steep one falls. So joints and
grades of straights are corrected by the measured errors, and the draft is measured again.

``design.fit.grades`` corrects only inclines. Here the lengths of consecutive straights change, too, which
moves the joints between them but not the road in plan view.
"""

from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from math import ceil, copysign

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.outline import Outline
from roadgpt.brief.ranges import Range
from roadgpt.check.matching import Complaint
from roadgpt.check.measures import MeasuredFeature, Measures, measure, way
from roadgpt.check.rules.promises import complaints
from roadgpt.design.elements import cut
from roadgpt.design.layout import PlanLine
from roadgpt.design.vertical import Pace, joined, too_abrupt
from roadgpt.geometry.curve import Array
from roadgpt.road import Segment
from roadgpt.road.builder import elevation_of

TOO_ABRUPT = "slopes that change too fast for the speed"
CORRECTIONS = 8
MOST_OFF = 0.1  # of its length, that a straight is measured longer or shorter
LONG_ENOUGH = 35.0  # m of a straight that may be measured longer or shorter
SHORTEST = 4.0  # m that a correction leaves of a straight
TENTH = 10.0  # per percent


def corrected_draft(
    elements: Sequence[Element],
    line: PlanLine,
    outline: Outline,
    limit: Range,
    pace: Pace,
    ease: float,
    share: float,
    bumps: bool,
) -> tuple[tuple[Segment, ...], list[Complaint]]:
    """Returns the segments of a draft, corrected in up to eight rounds, and a Complaint for each requirement
    that they still violate.

    ``limit`` is the range of inclines that are allowed, in percent. ``ease`` and ``share`` are fractions of
    the comfortable vertical radius. ``ease`` is used between consecutive straights if at least one of them
    has a fixed length, and ``share`` elsewhere. For ``bumps``, see ``Pace.eased``.
    """
    ends = np.cumsum([element.length for element in elements])
    for n in range(CORRECTIONS):
        parts = [part for one in _with_radii(elements, pace, ease, bumps) for part in cut(one)]
        segments = joined(parts, pace, share)
        heights = elevation_of(segments, 0.0).height(line.s)
        found = measure(np.stack([line.z.real, line.z.imag, heights], axis=1), outline.widest)
        if too_abrupt(segments, pace, bumps):
            broken = [Complaint(TOO_ABRUPT, on_heights=True)]
        else:
            broken = complaints(found, outline)
        ends = _shared_ends(elements, ends, found) if n == 0 else ends
        before, elements = elements, _corrected(elements, ends, found, limit)
        if not any(complaint.on_heights for complaint in broken) or elements == before:
            break
    return segments, broken


def _with_radii(elements: Sequence[Element], pace: Pace, ease: float, bumps: bool) -> list[Element]:
    """Returns the elements with vertical radii for consecutive straights, if one has a fixed length."""
    out, ends = list(elements), np.cumsum([element.length for element in elements])
    for row in _rows(elements):
        if any(elements[i].has_fixed_length for i in row):
            for i in row[1:]:
                out[i] = out[i]._replace(vertical_radius=pace.eased(float(ends[i - 1]), ease, bumps))
    return out


def _shared_ends(elements: Sequence[Element], ends: Array, found: Measures) -> Array:
    """Returns the stations at which straights of other grades should be measured to end.

    With the joint where it is required, the climb is as the words say, but the steeper straight is measured
    longer; with the joint moved until its length is right, the climb is less. So both err by half, as far as
    no straight is measured ``MOST_OFF`` longer or shorter than required. Short straights keep their lengths.
    """
    out = ends.copy()
    for row, pieces, runs in _pieces(elements, found):
        spare = [
            MOST_OFF * elements[i].length / (1 if i in (row[0], row[-1]) else 2)
            if elements[i].length >= LONG_ENOUGH
            else 0.0
            for i in row
        ]
        for run, piece in zip(runs[:-1], pieces, strict=False):
            last = run[-1]
            most = min(spare[last - row.start : last - row.start + 2])
            out[last] += np.clip((piece.end - ends[last]) / 2, -most, most)
    return out


def _pieces(
    elements: Sequence[Element], found: Measures
) -> Iterator[tuple[range, list[MeasuredFeature], list[list[int]]]]:
    """Yields the straights between two turns, as they are measured and as the draft has them: runs of the
    same direction of slope. They are left out if they do not correspond, or if no length is fixed.
    """
    if len(found.turns) != sum(bool(element.turn) for element in elements):
        return
    for row, gap in zip(_rows(elements), found.gaps, strict=True):
        pieces = [piece for straight in gap for piece in straight.pieces]
        runs = [[*run] for _, run in groupby(row, key=lambda i: way(elements[i].incline))]
        if len(pieces) == len(runs) and any(elements[i].has_fixed_length for i in row):
            yield row, pieces, runs


def _corrected(elements: Sequence[Element], ends: Array, found: Measures, limit: Range) -> list[Element]:
    """Returns the elements with joints and grades of straights corrected by the measured errors.

    Each element should end at its station in ``ends``. Between two turns, nothing is corrected if the
    measured straights do not correspond to those of the draft.
    """
    out = list(elements)
    joints = np.cumsum([0.0, *(element.length for element in elements)])
    for row, pieces, runs in _pieces(elements, found):
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
    """Returns a straight of fixed length, its incline corrected so that the measured grade is as required."""
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
