"""Composes a draft from turns, required straights, and further straights that join these elements.

lead-in | turn | joining straight | turn | required straight | turn | lead-out"""

from collections.abc import Sequence
from math import inf

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.map_fit import longest_straight
from roadgpt.brief.outline import USUALLY_WIDEST, Feature, Outline
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import LEAST_STRAIGHT
from roadgpt.design.draw import (
    LEAD,
    SEPARATE,
    DraftTask,
    drawn_straight,
    drawn_turns,
    free_straight,
    inside,
    narrowed_turns,
    with_one_at_bound,
)
from roadgpt.design.sequence import TurnSequence
from roadgpt.design.windows import Windows

LEAD_MEAN = 26.0  # m by which a lead-in or lead-out exceeds its least length on average
JOIN_MEAN = 16.0  # m by which a straight between turns exceeds its least length on average
LEG = 33.0  # m, least length of a straight between hairpins; 30 m of it are measured as straight
LEG_MEAN = 25.0  # m by which such a straight exceeds LEG on average
CRAMPED = 0.5  # haste from which hairpins are joined like other turns
LONELY_MEAN = 60.0  # m by which a straight beside the only turn exceeds its least length on average
APPROACH = 35.0  # m of additional straight in front of a turn of a hard road, about: room to gain speed
DIRECT = 0.35  # probability that turns to opposite sides follow each other almost without a straight
HARDLY = 7.0  # m
CHANGE = 24.0  # m of straight for the change from one required grade to another
LONGEST_CHANGE = 100.0  # m; more would not fit on the map
STEP_ASIDE = 14.0  # m with the grade of a turn before a required straight, as none changes in the turn
OPEN = Range(LEAST_STRAIGHT, inf)  # m, of a required straight without a required length
ALONE = (60.0, 240.0)  # m, of a road without turns and without a required length
HILL = 42.0  # m of one climb or fall of a hilly road
CLIMBS_AT = 12.0  # percent at most, where a road must be long enough for its climb
MODERATE = 5.0  # percent, of a straight whose height is given and whose length is open
EASE = 0.85  # of that grade, on average
SHORT_LEAD = 5.0  # m, of a lead-in or lead-out of a road that must be short
NEAR_NUMBER = 0.1  # share of the tolerance of a length that is used where possible
ROUNDING = 0.1  # m by which a straight from corner to corner is shorter than the diagonal
FEWEST_METRES = 1.0  # m, of a straight that is shortened so that the whole length is right


def composed(order: TurnSequence, task: DraftTask) -> list[Element] | None:
    """Returns the elements of a draft in driving order; None if they cannot have the required length."""
    outline = task.outline
    narrowed = narrowed_turns(order.turns, task)
    if order.turns:
        narrowed = with_one_at_bound(narrowed, order.turns, task)
    turns: list[Element | None] = list(drawn_turns(narrowed, task))
    elements: list[Element] = []
    legs = map(order.is_leg, range(len(order.gaps)))
    for before, gap, after, leg in zip([None, *turns], order.gaps, [*turns, None], legs, strict=True):
        elements += gap_between(before, gap, after, task, leg)
        if after:
            elements.append(after)
    if outline.hills:
        elements = _with_hills(elements, outline.hills, task.rng)
    length = asked_length(outline, task.windows)
    whole = _with_length(elements, length, task) if length else elements
    if whole is None or (order.turns and any(group.feature.kind == "turn" for group in outline.groups)):
        return whole
    whole = _evened(whole, [wish for gap in order.gaps for wish in gap])
    return _from_corner_to_corner(whole, task) if outline.turns.hi == 0 else whole


def _evened(elements: list[Element], wishes: Sequence[Feature]) -> list[Element]:
    """Returns the elements of a road none of whose turns has a place. The required straights of open length
    have equal lengths if each has a number for its grade, so that "the first half climbs at 5 percent, the
    second falls at 5" comes out even, or if they have equal heights."""
    is_free = [element.is_elastic and element.required_length is not None for element in elements]
    free = [element.length for element, may_change in zip(elements, is_free, strict=True) if may_change]
    open_wishes = [wish for wish in wishes if not wish.length or wish.length.hi == inf]
    have_grades = all(wish.grade and wish.grade.number is not None for wish in open_wishes)
    heights = {abs(wish.climb.number or 0.0) if wish.climb else 0.0 for wish in open_wishes}
    are_alike = have_grades or (len(heights) == 1 and all(heights))
    if not free or len(free) != len(open_wishes) or not are_alike:
        return elements
    length = sum(free) / len(free)
    return [
        element._replace(straight=length) if may_change else element
        for element, may_change in zip(elements, is_free, strict=True)
    ]


def _from_corner_to_corner(elements: list[Element], task: DraftTask) -> list[Element]:
    """Returns the straights of a road without turns, shortened if they do not fit on the map's diagonal;
    unchanged, so that the road is too large for the map, if they would be shorter than required."""
    world, whole = task.world, sum(element.length for element in elements)
    longest = longest_straight(world.site.map_size, world.section.road_width) - ROUNDING
    keep = min(longest / whole, 1.0)
    asked = [(whole, task.outline.length), *((each.length, each.required_length) for each in elements)]
    if any(span and keep * length < span.lo for length, span in asked):
        return elements
    return [element._replace(straight=keep * element.length) for element in elements]


def asked_length(outline: Outline, windows: Windows) -> Range | None:
    """Returns the range of lengths in metres that the road may have; None if any length will do. If a climb
    but no length is required, the range begins at the length that the climb needs at a moderate grade."""
    if outline.length or not outline.climb:
        return outline.length
    height = max(outline.climb.lo, -outline.climb.hi, 0.0)
    allowed = windows.base or windows.limit
    steepest = min(max(allowed.hi, -allowed.lo), CLIMBS_AT)
    return Range(100 * height / (EASE * max(steepest, 1.0)), inf)


def gap_between(
    before: Element | None,
    wishes: Sequence[Feature],
    after: Element | None,
    task: DraftTask,
    is_leg: bool = False,
) -> list[Element]:
    """Returns the straights between two turns, or between a turn and an end of the road, where ``before`` or
    ``after`` is None. ``wishes`` are required here, in order. If ``is_leg``, both turns are hairpins."""
    outline, windows, rng = task.outline, task.windows, task.rng
    if is_leg and not wishes and task.haste < CRAMPED:
        return [Element(free_straight(LEG, LEG_MEAN, task))]
    if wishes:
        few = outline.turns.hi <= 1 and len(wishes) == 1
        return _asked_gap(before, wishes, after, LONELY_MEAN if few else JOIN_MEAN, task)
    if not before and not after:
        length = ALONE[0] + rng.random() * (ALONE[1] - ALONE[0]) * (1 - 0.6 * task.haste)
        return [Element(length, required_grade=windows.base)]
    if not before or not after:
        mean = LONELY_MEAN if outline.turns.hi == 1 else LEAD_MEAN
        return [Element(free_straight(LEAD, mean, task) + _approach(after, task))]
    changes = windows.part(before.required_grade, after.required_grade)
    least = CHANGE if changes else 0.0
    if before.turn * after.turn > 0:
        least = max(least, SEPARATE)
    elif not changes and rng.random() < DIRECT:
        length = HARDLY * rng.random()
        return [Element(length)] if length > FEWEST_METRES else []
    length = free_straight(max(least, FEWEST_METRES), JOIN_MEAN, task)
    return [Element(length + _approach(after, task))]


def _approach(after: Element | None, task: DraftTask) -> float:
    return APPROACH * (0.4 + task.rng.random()) if task.outline.hard and after else 0.0


def _asked_gap(
    before: Element | None,
    wishes: Sequence[Feature],
    after: Element | None,
    mean: float,
    task: DraftTask,
) -> list[Element]:
    """Returns the required straights. A grade that must change at a turn changes a little away from it."""
    out: list[Element] = []
    windows = task.windows
    grades = windows.row(wishes)
    if before and windows.part(before.required_grade, grades[0]):
        out.append(Element(STEP_ASIDE, required_grade=before.required_grade))
    for number, (wish, grade) in enumerate(zip(wishes, grades, strict=True)):
        neighbours = [grades[i] for i in (number - 1, number + 1) if 0 <= i < len(grades)]
        if number == 0 and before:
            neighbours.append(before.required_grade)
        if number == len(wishes) - 1 and after:
            neighbours.append(after.required_grade)
        changes = [_change(grade, other, task) for other in neighbours if windows.part(grade, other)]
        least = max(LEAD, sum(changes) + 8.0 if changes else 0.0, _room_of_climb(wish))
        if number and not windows.part(grades[number - 1], grade):
            out.append(_ledge(grades[number - 1], grade, windows))
        length = drawn_straight(wish, least, mean, task)
        if wish.length and wish.length.number is not None:
            # the straight alone is then a little short, and with what looks straight a little long
            beside = (before if number == 0 else None, after if number == len(wishes) - 1 else None)
            length = max(length - sum(map(_looks_straight, beside)) / 2, min(least, length))
        asked = wish.length or OPEN
        out.append(Element(length, required_length=asked, required_grade=grade, required_climb=wish.climb))
    if after and windows.part(grades[-1], after.required_grade):
        out.append(Element(STEP_ASIDE, required_grade=after.required_grade))
    return out


def _room_of_climb(wish: Feature) -> float:
    """Returns the length in metres on which a straight of open length has its height at a moderate grade."""
    if wish.climb is None or (wish.length and wish.length.hi < inf):
        return 0.0
    return 100 * min(abs(wish.climb.lo), abs(wish.climb.hi)) / MODERATE


def _looks_straight(turn: Element | None) -> float:
    """Returns how many metres of the transition at either end of a turn bend too little to be seen."""
    return turn.transition * min(turn.radius / USUALLY_WIDEST, 1.0) if turn else 0.0


def _ledge(before: Range | None, after: Range | None, windows: Windows) -> Element:
    """Returns a short straight of another slope, so that its two neighbours are measured as two straights."""
    grade = windows.other(after)
    changes = windows.between(before, grade) + windows.between(grade, after)
    length = max(STEP_ASIDE, windows.least * changes / 100)
    return Element(length, required_length=Range(length, length), required_grade=grade)


def _change(grade: Range | None, other: Range | None, task: DraftTask) -> float:
    """Returns the length in metres of straight to reserve for a change of grade at its end. Without haste, a
    comfortable parabola between the two grades has room, unless it needs more than 100 m."""
    comfortable = task.windows.comfort * task.windows.between(grade, other) / 100
    return max(CHANGE * (1 - 0.3 * task.haste), min(comfortable, LONGEST_CHANGE) * (1 - task.haste))


def _with_hills(elements: list[Element], hills: Range, rng: np.random.Generator) -> list[Element]:
    """Returns elements whose free straights are long enough for climbs and falls."""
    stretches = int(hills.lo) + 1
    room = sum(max(int(element.length / HILL), 1) for element in elements if element.length > 0.7 * HILL)
    free = [i for i, element in enumerate(elements) if element.is_elastic]
    out = list(elements)
    for _ in range(max(stretches - room, 0) if free else 0):
        i = free[rng.integers(len(free))]
        out[i] = out[i]._replace(straight=out[i].length + HILL)
    return out


def _with_length(elements: list[Element], asked: Range, task: DraftTask) -> list[Element] | None:
    """Returns the elements with free straights changed so that the road has the required length; None if they
    cannot be shortened enough."""
    rng, now = task.rng, sum(element.length for element in elements)
    core = asked.around(NEAR_NUMBER)
    if core.lo + 1 < now < core.hi - 1:
        return elements
    low = core.lo if core.lo > 0 else 0.7 * asked.hi
    high = core.hi if core.hi < inf else 1.3 * asked.lo
    target = low + (high - low) * (0.15 + 0.7 * rng.random())
    free = [i for i, element in enumerate(elements) if element.is_elastic]
    if not free:
        return elements
    missing = target - now
    if missing > 0:
        shares = rng.dirichlet(np.ones(len(free)))
        lengths = [elements[i].length + missing * share for i, share in zip(free, shares, strict=True)]
    else:
        least = [_least(elements, i, LEAD if task.haste < 0.5 else SHORT_LEAD) for i in free]
        slack = sum(elements[i].length - floor for i, floor in zip(free, least, strict=True))
        if slack < -missing:
            return elements if now < asked.hi - 1 else None
        keep = 1 + missing / slack
        lengths = [floor + keep * (elements[i].length - floor) for i, floor in zip(free, least, strict=True)]
    out = list(elements)
    for i, length in zip(free, lengths, strict=True):
        out[i] = out[i]._replace(straight=length)
    return out


def _least(elements: Sequence[Element], index: int, lead: float) -> float:
    """Returns the least length of a straight in metres."""
    before = elements[index - 1] if index else None
    after = elements[index + 1] if index + 1 < len(elements) else None
    least = lead
    if before and after:
        least = SEPARATE if before.turn * after.turn > 0 else FEWEST_METRES
    required = elements[index].required_length
    if required:
        least = max(least, inside(required.lo), CHANGE)
    return min(least, elements[index].length)
