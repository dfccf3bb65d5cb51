"""Describes a finished road as a Brief, the data structure for descriptions."""

from roadgpt.brief.model import Brief, Clause, exactly, span
from roadgpt.check.measures import MeasuredFeature, RoadMeasures, measure, way
from roadgpt.road import Road

STEEPER = 1.5  # percent; the steepest place is told if it is steeper than all the mean grades by more
TOLD = 0.9  # share of a straight that its pieces must cover to stand for it; very short ones are no pieces


def describe(road: Road) -> Brief:
    """Returns a Brief that lists the turns and straights of a road, in whole degrees, metres and percent.

    Each turn is a clause with side, angle and radius, and each piece of a straight that goes up, down or flat
    a clause with its length. A clause also states the mean grade, unless it is level. A turn, or a straight
    with very short waves, that goes both up and down states none; the Brief then has the number of changes of
    slope. It includes the length of the whole road, and its steepest place if the clauses do not show it. A
    climb that rounds to 0 m is left out."""
    found = measure(road.centreline())
    clauses = tuple(clause for feature in found.features for clause in _clauses(feature, found))
    has_bumps = any(clause.slope is None for clause in clauses)
    told = max((span(clause.incline).hi for clause in clauses if clause.incline), default=0.0)
    return Brief(
        clauses=clauses,
        turns=None if found.turns else exactly(0),
        length=exactly(round(found.length)),
        climb=exactly(round(found.climb)) if abs(round(found.climb)) else None,
        hills=exactly(found.hills) if has_bumps and found.hills else None,
        steepest=exactly(round(found.steepest)) if found.steepest > told + STEEPER else None,
    )


def _clauses(feature: MeasuredFeature, found: RoadMeasures) -> list[Clause]:
    if sum(piece.length for piece in feature.pieces) > TOLD * feature.length:
        return [*map(_clause, feature.pieces)]
    is_bumpy = {"up", "down"} <= found.ways(feature)
    return [_clause(feature).model_copy(update={"slope": None, "incline": None} if is_bumpy else {})]


def _clause(feature: MeasuredFeature) -> Clause:
    grade = round(feature.grade)
    slope = way(feature.grade)
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
