"""Simplifications of a Design: fewer segments, level ground, straighter segments, rounder numbers.

A Simplifier lists the simplifications of one type, such as removing a segment, for every segment of a Design.
``minimise`` finds which of them can be combined.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from roadgpt.road import Design, Segment

ROUND = {
    "distance": (50.0, 10.0, 5.0, 1.0),
    "turn_degrees": (30.0, 10.0, 5.0, 1.0),
    "radius": (10.0, 5.0, 1.0),
}
"""The units to which each field is rounded, the coarsest first; in metres or degrees."""
NAMES = {"distance": "length", "turn_degrees": "turn", "radius": "radius"}


@dataclass(frozen=True)
class Simplification:
    """One simplification of one segment."""

    segment: int
    """Index of the segment, from 0, in the Design that is simplified."""
    change: Callable[[Segment], Segment | None]
    """A function that returns the simplified segment, or None to remove the segment."""
    told: str


Simplifier = Callable[[Design], list[Simplification]]


def simplified(design: Design, steps: Sequence[Simplification]) -> Design | None:
    """Returns the Design with all the given simplifications applied; None if no segment would be left."""
    segments: list[Segment | None] = list(design.segments)
    for step in steps:
        segment = segments[step.segment]
        if segment is not None:
            segments[step.segment] = step.change(segment)
    left = tuple(segment for segment in segments if segment is not None)
    return design.model_copy(update={"segments": left}) if left else None


def simplifications() -> list[Simplifier]:
    """Returns one Simplifier for each type of simplification: a function that lists all simplifications of
    this type for a Design.

    The types that simplify the road most come first.
    """
    rounding = [
        _rounding(field, unit)
        for unit in (50.0, 30.0, 10.0, 5.0, 1.0)
        for field in ROUND
        if unit in ROUND[field]
    ]
    return [_dropping, _levelling, _straightening, *rounding, _whole_percent]


def _dropping(design: Design) -> list[Simplification]:
    # the last segment first: what comes after the departure matters least
    count = len(design.segments)
    return [Simplification(index, lambda segment: None, "left out") for index in reversed(range(count))]


def _levelling(design: Design) -> list[Simplification]:
    return [
        Simplification(index, lambda segment: segment.model_copy(update={"incline": 0.0}), "made level")
        for index, segment in enumerate(design.segments)
        if segment.incline
    ]


def _straightening(design: Design) -> list[Simplification]:
    return [
        Simplification(index, _straight, "made straight")
        for index, segment in enumerate(design.segments)
        if segment.turn_degrees
    ]


def _straight(segment: Segment) -> Segment:
    return Segment(
        distance=segment.distance,
        direction="straight",
        incline=segment.incline,
        vertical_radius=segment.vertical_radius,
    )


def _rounding(field: str, unit: float) -> Simplifier:
    def way(design: Design) -> list[Simplification]:
        return [
            Simplification(index, lambda segment: _rounded(segment, field, unit), f"{NAMES[field]} rounded")
            for index, segment in enumerate(design.segments)
            if getattr(segment, field) and getattr(segment, field) % unit
        ]

    return way


def _rounded(segment: Segment, field: str, unit: float) -> Segment:
    value = round(getattr(segment, field) / unit) * unit
    return segment.model_copy(update={field: value}) if value else segment


def _whole_percent(design: Design) -> list[Simplification]:
    return [
        Simplification(
            index,
            lambda segment: segment.model_copy(update={"incline": float(round(segment.incline))}),
            "grade rounded",
        )
        for index, segment in enumerate(design.segments)
        if segment.incline % 1
    ]
