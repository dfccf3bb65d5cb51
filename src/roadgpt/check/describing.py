"""Describes a finished road in the terms of a description: from geometry back to a Brief."""

from roadgpt.brief.model import Brief, Clause, exactly
from roadgpt.check.measures import LEVEL, MeasuredFeature, Measures, measure
from roadgpt.road import Road


def describe(road: Road) -> Brief:
    """Returns the Brief that names everything along the road, in whole degrees, metres and percent.

    Every turn and every straight is a clause of its own: side, degrees and radius, or length, and the grade
    from end to end where it is not level. Length and climb of the whole road are given too.

    Raises:
        UsageError: The road has no two different points.
    """
    return described(measure(road.centreline()))


def described(found: Measures) -> Brief:
    """Returns the same Brief for a road that has been measured."""
    return Brief(
        clauses=tuple(_clause(feature) for feature in found.features),
        turns=None if found.turns else exactly(0),
        length=exactly(round(found.length)),
        climb=exactly(round(found.climb)) if abs(round(found.climb)) else None,
    )


def _clause(feature: MeasuredFeature) -> Clause:
    grade = round(feature.grade)
    slope = "flat" if abs(feature.grade) < LEVEL else "up" if grade > 0 else "down"
    incline = exactly(abs(grade)) if slope != "flat" and grade else None
    if feature.kind == "straight":
        return Clause(kind="straight", length=exactly(round(feature.length)), slope=slope, incline=incline)
    return Clause(
        kind="turn",
        side=feature.side,
        degrees=exactly(round(abs(feature.degrees))),
        radius=exactly(round(feature.radius)),
        slope=slope,
        incline=incline,
    )
