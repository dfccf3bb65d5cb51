"""Adds crests and dips: changes the grades of a straight, and keeps the road's length and its plan view."""

from typing import NamedTuple

from roadgpt.design.edit.placing import PlacedChange
from roadgpt.design.edit.request import HILLS
from roadgpt.design.edit.slope_of_all import SlopeOfAll
from roadgpt.design.edit.steps import EditCandidate
from roadgpt.design.edit.stretches import RoadStretch
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.errors import EditError

LEAST = 40.0  # m: the shortest straight for a crest or a dip
LONGEST = 60.0  # m, from the beginning of a crest or a dip to its middle
GRADES = (5.0, 3.5)  # percent of both slopes; the second value is tried if the first cannot be built


class Hill(NamedTuple):
    """The place on a straight where a crest or a dip is added."""

    name: str
    """The name of the straight."""
    middle: float
    """Station in metres of the highest point of the crest, or of the lowest point of the dip."""
    half: float
    """Metres from the beginning of the crest or dip to its middle."""


def hill_candidates(placed: PlacedChange, elements: RoadElements) -> tuple[EditCandidate, ...]:
    """Returns the candidates that put one crest or dip on the straight that a change names.

    Raises:
        EditError: as for ``hill_of``.
    """
    hill, sign = hill_of(placed, elements), HILLS[placed.change.kind or ""]
    return tuple(_slopes(hill, grade, sign) for grade in GRADES)


def hill_of(placed: PlacedChange, elements: RoadElements) -> Hill:
    """Returns where a change adds a crest or a dip: in the middle of the straight or, if the change asks for
    the middle of the road, as near to that as the straight allows.

    Raises:
        EditError: the straight is too short or bends, or the change does not refer to exactly one straight.
    """
    change = placed.change
    kind = change.kind or ""
    where = _straight_at(placed, elements)
    if where is None or where.length < LEAST or any(segment.turn_degrees for segment in where.segments):
        found = f"; there are {where.length:.0f} m" if where else ""
        raise EditError(f"a {kind} needs a straight of {LEAST:.0f} m or more{found}; lengthen it first")
    start = sum(element.length for element in elements[: elements.index(where)])
    middle = start + where.length / 2
    if change.place and change.place.how == "middle":
        whole = sum(element.length for element in elements)
        middle = min(max(whole / 2, start + LEAST / 2), start + where.length - LEAST / 2)
    half = min(LONGEST, middle - start, start + where.length - middle)
    return Hill(where.name, middle, half)


def _slopes(hill: Hill, grade: float, sign: int) -> EditCandidate:
    ends = (
        RoadStretch(hill.middle - hill.half, hill.middle),
        RoadStretch(hill.middle, hill.middle + hill.half),
    )
    names = frozenset([hill.name])
    return tuple(
        SlopeOfAll(names, least=grade, most=grade, sign=side, stretch=stretch)
        for stretch, side in zip(ends, (sign, -sign), strict=True)
    )


def _straight_at(placed: PlacedChange, elements: RoadElements) -> RoadElement | None:
    """Returns the straight at the place of a change; None if there is none."""
    place = placed.change.place
    how = place.how if place else "end"
    if how == "on":
        if len(placed.marks) != 1 or placed.marks[0].is_turn:
            raise EditError(f"'{placed.change.words}' names no single straight; name one")
        return placed.marks[0]
    gaps = [element for element in elements if element.kind == "gap" and element.segments]
    at = {element.name: index for index, element in enumerate(elements)}
    match how:
        case "start" | "end":
            found = gaps[:1] if how == "start" else gaps[-1:]
        case "middle":
            found = [_around_middle(gaps, elements)] if gaps else []
        case "before":
            found = [gap for gap in gaps if at[gap.name] < at[placed.marks[0].name]][-1:]
        case "between" if placed.stop is not None:
            low, high = at[placed.marks[-1].name], at[placed.stop.name]
            found = [gap for gap in gaps if low < at[gap.name] < high]
            if len(found) != 1:
                raise EditError(
                    f"'{placed.change.words}' names {len(found) or 'no'} straights; name one of them"
                )
        case _:
            found = [gap for gap in gaps if at[gap.name] > at[placed.marks[-1].name]][:1]
    return found[0] if found else None


def _around_middle(gaps: list[RoadElement], elements: RoadElements) -> RoadElement:
    """Returns the straight that holds the middle of the road, or else the one nearest to it."""
    whole = sum(element.length for element in elements)

    def away(gap: RoadElement) -> float:
        start = sum(element.length for element in elements[: elements.index(gap)])
        return max(start - whole / 2, whole / 2 - start - gap.length, 0.0)

    return min(gaps, key=away)
