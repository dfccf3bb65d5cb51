"""Adds crests and dips: changes the grades of a straight, and keeps the road's length and its plan view."""

from typing import NamedTuple

from roadgpt.brief.change.request import HILLS
from roadgpt.design.edit.placing import LEAST_FOR_HILL, PlacedChange
from roadgpt.design.edit.slopes import SlopeOfAll
from roadgpt.design.edit.steps import EditCandidate
from roadgpt.design.edit.stretches import RoadStretch
from roadgpt.design.road_elements import RoadElements

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
    """Returns the candidates that put one crest or dip on the straight that a change refers to."""
    hill, sign = _hill_of(placed, elements), HILLS[placed.change.kind or ""]
    return tuple(_slopes(hill, grade, sign) for grade in GRADES)


def hill_sentence(placed: PlacedChange, elements: RoadElements, is_alone: bool) -> str:
    """Returns a sentence on a new crest or dip; it says where, if the request has no other change."""
    hill = _hill_of(placed, elements)
    where = f", its middle at {hill.middle:.0f} m" if is_alone else ""
    return f"a {placed.change.kind} of {2 * hill.half:.0f} m is new{where}"


def _hill_of(placed: PlacedChange, elements: RoadElements) -> Hill:
    """Returns where a change adds a crest or a dip: in the middle of the straight or, if the change asks for
    the middle of the road, as near to that as the straight allows.
    """
    (where,), place = placed.elements, placed.change.place
    start = sum(element.length for element in elements[: elements.index(where)])
    middle = start + where.length / 2
    if place and place.how == "middle":
        whole = sum(element.length for element in elements)
        middle = min(max(whole / 2, start + LEAST_FOR_HILL / 2), start + where.length - LEAST_FOR_HILL / 2)
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
