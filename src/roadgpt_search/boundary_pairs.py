"""Pairs of similar roads at the boundary of failure: the car passed on one of them and failed on the other.

Two roads correspond if they have the same sequence of left turns, right turns and straights. A road half-way
between two corresponding roads can be made by averaging each length, angle, radius and slope."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from roadgpt.brief.element import Element, Elements
from roadgpt.campaign.model import Result
from roadgpt.design.elements import elements_of


class Measure(NamedTuple):
    """A numeric property, such as a radius, by which two turns or two straights are compared."""

    field: str  # name of the field of ``Element`` that holds the property
    called: str  # name of the property in texts
    unit: str
    scale: float  # the difference in this property that counts as a distance of 1 between two roads


GRADE = Measure("incline", "grade", " %", 1.0)
OF_TURN = (
    GRADE,
    Measure("turn", "angle", " degrees", 10.0),
    Measure("radius", "radius", " m", 2.0),
    Measure("transition", "clothoid", " m", 2.0),
)
OF_STRAIGHT = (GRADE, Measure("length", "length", " m", 10.0))


@dataclass(frozen=True)
class BoundaryPair:
    """A road on which the car kept its lane, and a similar road on which the car failed."""

    kept: int  # number of the test that passed
    lost: int  # number of the test that failed
    distance: float
    """Distance between the two roads: the square root of the sum of squared differences over all turns and
    straights, where 10 m of a straight, 2 m of a radius or a clothoid, 10 degrees of a turn and 1 % of a
    slope count as 1."""


def _differences(one: Elements, other: Elements) -> Iterator[tuple[float, int, Measure]]:
    """Yields how much two corresponding roads differ in each property, in units of ``Measure.scale``, the
    index of the element, and the property."""
    for at, (a, b) in enumerate(zip(one, other, strict=True)):
        for measure in OF_TURN if a.turn else OF_STRAIGHT:
            yield (getattr(a, measure.field) - getattr(b, measure.field)) / measure.scale, at, measure


def distance(one: Elements, other: Elements) -> float:
    """Returns ``BoundaryPair.distance`` of two roads; infinite if they do not correspond."""
    if _row(one) != _row(other):
        return np.inf
    return math.sqrt(sum(difference**2 for difference, *_ in _differences(one, other)))


def weightiest(kept: Elements, lost: Elements) -> str:
    """Returns the largest difference between two corresponding roads, in units of ``Measure.scale``, as text
    such as 'turn 2: radius 15.4 m, then 14.9 m'; empty if they do not differ."""
    every = _differences(kept, lost)
    most, at, measure = max(every, key=lambda each: abs(each[0]), default=(0.0, 0, GRADE))
    if not most:
        return ""
    is_turn = bool(kept[at].turn)
    number = sum(bool(element.turn) == is_turn for element in kept[: at + 1])
    then = f"{_figure(kept[at], measure)}, then {_figure(lost[at], measure)}"
    return f"{'turn' if is_turn else 'straight'} {number}: {measure.called} {then}"


def _figure(element: Element, measure: Measure) -> str:
    value = getattr(element, measure.field)
    size = abs(value) if measure.field == "turn" else value
    return f"{size:.2f}".rstrip("0").rstrip(".").replace("-", "−") + measure.unit


def pairs_of(results: Sequence[Result]) -> list[BoundaryPair]:
    """Returns the boundary pairs among the results of one cell, the closest first; each test is in at most
    one pair. Roads with junctions are left out."""
    roads = {
        r.number: elements_of(r.plain_design.segments)
        for r in results
        if r.plain_design and r.outcome in ("PASS", "FAIL")
    }
    kept = [r.number for r in results if r.outcome == "PASS" and r.number in roads]
    lost = [r.number for r in results if r.outcome == "FAIL" and r.number in roads]
    return paired(roads, kept, lost)


def paired(roads: dict[int, Elements], kept: Sequence[int], lost: Sequence[int]) -> list[BoundaryPair]:
    """Returns boundary pairs as ``pairs_of`` does. ``roads`` has the elements of each road by test number;
    ``kept`` and ``lost`` are the numbers of the passed and of the failed tests."""
    rows: dict[tuple[float, ...], list[int]] = {}
    for number in kept:
        rows.setdefault(_row(roads[number]), []).append(number)
    every = [
        BoundaryPair(other, number, distance(roads[other], roads[number]))
        for number in lost
        for other in rows.get(_row(roads[number]), ())
    ]
    out: list[BoundaryPair] = []
    used: set[int] = set()
    for pair in sorted(every, key=lambda pair: (pair.distance, pair.lost, pair.kept)):
        if pair.lost not in used and pair.kept not in used:
            out.append(pair)
            used |= {pair.lost, pair.kept}
    return out


def _row(elements: Elements) -> tuple[float, ...]:
    return tuple(float(np.sign(element.turn)) for element in elements)
