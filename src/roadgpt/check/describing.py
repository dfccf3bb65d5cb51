"""Describes a finished road as a Brief, the data structure for descriptions."""

from roadgpt.brief.model import Brief, Clause, exactly
from roadgpt.check.measures import LEVEL, MeasuredFeature, measure
from roadgpt.road import Road


def describe(road: Road) -> Brief:
    """Returns a Brief that lists the turns and straights of a road, in whole degrees, metres and percent.

    Each turn is a clause with side, angle and radius, and each straight a clause with its length. A clause
    also states the mean grade, unless the turn or straight is level. The Brief includes the length of the
    whole road. A climb that rounds to 0 m is left out.

    Raises:
        UsageError: The road has no two different points.
    """
    found = measure(road.centreline())
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
