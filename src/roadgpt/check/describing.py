"""From geometry back to a Brief: what a finished road is like, said in the terms of a description."""

from roadgpt.brief.model import Brief, Clause, exactly
from roadgpt.check.measures import LEVEL, MeasuredFeature, Measures, measure
from roadgpt.road import Road


def describe(road: Road) -> Brief:
    """The Brief that names everything along the road, with whole degrees, metres and percent.

    Every turn and straight is a clause of its own: side, degrees and radius, or length; and the grade from
    end to end where it is not level. Length and climb of the whole road stand beside them.

    Raises:
        UsageError: the road has no two different points.
    """
    return described(measure(road.centreline()))


def described(found: Measures) -> Brief:
    """The same of a road that has been measured."""
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
