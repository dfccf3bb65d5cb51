"""Ways to take turns and straights away; what stands around them keeps every number."""

from collections.abc import Sequence
from math import sqrt

from roadgpt.design.edit.candidates import EditCandidate
from roadgpt.design.edit.spacing import HIDDEN, SEPARATE
from roadgpt.design.edit.steps import Adjust, Become, EditStep, straight
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.errors import EditError
from roadgpt.road import Segment


def removal_candidates(gone: Sequence[RoadElement], elements: RoadElements) -> tuple[EditCandidate, ...]:
    """Returns all candidates that replace turns or straights by nothing or by a straight."""
    if len(gone) == len([b for b in elements if b.segments]):
        raise EditError("then no road would be left; remove fewer")
    fillers = (0.0, SEPARATE, 1.0, 45.0)
    out: list[EditCandidate] = []
    for filler in fillers:
        steps: list[EditStep] = []
        for element in gone:
            steps.append(_without(element, elements, filler))
        out.append(tuple(steps))
    return tuple(out)


def _without(element: RoadElement, elements: RoadElements, filler: float) -> EditStep:
    at = elements.index(element)
    if element.kind == "gap":
        bends = tuple(s for s in element.segments if s.turn_degrees)
        sides = [
            b.side for b in (*elements[max(at - 1, 0) : at], *elements[at + 1 : at + 2]) if b.kind == "turn"
        ]
        if len(sides) == 2 and sides[0] == sides[1]:
            return Adjust(element, length=HIDDEN - 0.2 * min(filler / SEPARATE, 1.0), length_slack=0.6)
        return Become(element, bends)
    length = {0.0: 0.0, 1.0: _chord(element)}.get(filler, filler)
    kept: tuple[Segment, ...] = (straight(length, element.incline),) if length else ()
    return Become(element, kept)


def _chord(element: RoadElement) -> float:
    seen = element.seen
    assert seen is not None
    return max(0.7 * element.length, sqrt(2) * min(seen.radius, 60.0))
