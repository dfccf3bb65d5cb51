"""Grades of the parts of a draft for which heights are asked."""

from collections.abc import Sequence
from itertools import accumulate, pairwise

from roadgpt.brief.element import Element
from roadgpt.brief.ranges import Range, overlap
from roadgpt.design.vertical import Pace
from roadgpt.road.elevation import MOST_OF_SLOPE

ROUNDS = 12  # of estimating how much height the parabola on a crest takes away
FEW_ROUNDS = 3  # beside a straight of fixed length, which steeper slopes would shorten by longer parabolas
NEARLY = 0.1  # percentage points by which a grade may miss the one that gives a height


def asks_for_heights(plan: Sequence[Element]) -> bool:
    """Returns whether a height is asked of a part; parts of which no slope is asked then stay level."""
    return any(element.required_climb for element in plan)


def with_grades_of_climbs(
    plan: Sequence[Element], limit: Range, pace: Pace, ease: float, bumps: bool
) -> Sequence[Element]:
    """Returns the elements of a plan with the grades in percent that give the heights that are asked for.

    For ``ease`` and ``bumps``, see ``Pace.eased``.
    """
    if not asks_for_heights(plan):
        return plan
    grades = _grades_of_climbs(plan, pace, ease, bumps)
    return [_with_grade(element, grade, limit) for element, grade in zip(plan, grades, strict=True)]


def has_room_for_heights(plan: Sequence[Element], limit: Range, pace: Pace, ease: float, bumps: bool) -> bool:
    """Returns whether the grades that give the heights are allowed; with shorter parabolas, which take less
    height from a crest, lower grades do.
    """
    if not asks_for_heights(plan):
        return True
    grades = _grades_of_climbs(plan, pace, ease, bumps)
    rooms = [overlap(limit, element.required_grade) or limit for element in plan]
    return all(
        room.lo - NEARLY <= grade <= room.hi + NEARLY
        for element, grade, room in zip(plan, grades, rooms, strict=True)
        if element.required_climb
    )


def _grades_of_climbs(plan: Sequence[Element], pace: Pace, ease: float, bumps: bool) -> list[float]:
    """Returns the grade in percent that gives each element its height; 0 if it needs none.

    Where the road rises and then falls, the parabola between the two slopes takes away height at its vertex,
    which both slopes make up for.
    """
    joints = list(accumulate(element.length for element in plan))[:-1]
    radii = [pace.eased(s, ease, bumps) for s in joints]
    grades = [_grade_of_climb(element, 0.0) for element in plan]
    for _ in range(FEW_ROUNDS if any(element.has_fixed_length for element in plan) else ROUNDS):
        lost = [0.0] * len(plan)
        for at, ((one, other), radius) in enumerate(zip(pairwise(grades), radii, strict=True)):
            if one * other < 0 and all(plan[i].required_climb for i in (at, at + 1)):
                change = abs(one - other) / 100
                room = 2 * MOST_OF_SLOPE * min(plan[at].length, plan[at + 1].length)  # half on each side
                cut = min(radius * change, room) * change / 8
                lost[at], lost[at + 1] = lost[at] + cut, lost[at + 1] + cut
        grades = [_grade_of_climb(element, metres) for element, metres in zip(plan, lost, strict=True)]
    return grades


def _grade_of_climb(element: Element, lost: float) -> float:
    """Returns the grade in percent that gives an element its height and ``lost`` metres more; 0 if it needs
    none.
    """
    if element.required_climb is None:
        return 0.0
    metres = _height(element.required_climb)
    return 100 * (metres + (lost if metres > 0 else -lost)) / element.length


def _height(asked: Range) -> float:
    """Returns the height in metres to design: the number that was given, or one inside the range: a little
    beyond its end nearer to 0, or half of "at most" a height.
    """
    if asked.number is not None:
        return asked.number
    near, far = sorted((asked.lo, asked.hi), key=abs)
    return near * 1.1 if near and abs(far) > 1.2 * abs(near) else (near + far) / 2


def _with_grade(element: Element, grade: float, limit: Range) -> Element:
    asked = element.required_climb
    if asked is None:
        return element
    low, high = sorted(grade * end / _height(asked) for end in (asked.lo, asked.hi))
    found = Range(low, high, number=grade)
    for other in (limit, element.required_grade):
        both = overlap(found, other) or found
        room = both if both.lo <= both.hi else limit
        near = min(max(grade, room.lo), room.hi)  # as high as it can be, if it cannot be as high as asked
        found = Range(both.lo, both.hi, number=near) if both.lo <= both.hi else Range(near, near)
    return element._replace(required_grade=found)
