"""Room between turns: how much straight road they need, so that each of them is seen by itself."""

from itertools import pairwise

from roadgpt.brief.model import Side
from roadgpt.design.edit.steps import straight
from roadgpt.design.road_elements import RoadElement, RoadElements

SEPARATE = 18.0  # m between turns of one hand, so that they are seen as two
HIDDEN = 9.0  # m, measured: turns of one hand with so much between them are two, but no straight is seen


def gap(name: str, length: float, incline: float) -> RoadElement:
    """Returns a new straight."""
    return RoadElement(name, "gap", (straight(length, incline),))


def with_room(elements: RoadElements, before: RoadElements) -> RoadElements:
    """Returns the elements with straights between new neighbours of one hand, so that two turns are seen.

    Turns that were neighbours before, on the same sides, are two already.
    """
    known = {_pair(one, other) for one, other in pairwise(b for b in before if b.kind == "turn")}
    out: list[RoadElement] = []
    last: RoadElement | None = None
    metres = 0.0
    for element in elements:
        if element.kind == "turn":
            is_new = last is not None and last.side == element.side and _pair(last, element) not in known
            if is_new and metres < SEPARATE - 2:
                out.append(gap(f"room before {element.name}", round(SEPARATE - metres, 1), element.incline))
            last, metres = element, 0.0
        else:
            metres += element.length
        out.append(element)
    return tuple(out)


def _pair(one: RoadElement, other: RoadElement) -> tuple[str, Side | None, str, Side | None]:
    return one.name, one.side, other.name, other.side
