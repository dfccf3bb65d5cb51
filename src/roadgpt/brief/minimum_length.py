"""Computes a lower bound on the length of any road that satisfies a Brief."""

from math import inf, radians

from roadgpt.brief.model import Brief, Clause, span
from roadgpt.brief.normal import STRAIGHT, total, turns_of
from roadgpt.brief.words import KINDS, LEAST_STRAIGHT, LENGTH_SLACK, SHARPNESS, SIZES

WAY_OF_A_TURN = 30.0  # metres that a turn and the straight after it need at least
GAP = 16.0  # metres of straight between two turns to the same side


def least_length(brief: Brief, min_radius: float) -> float:
    """Returns a lower bound, in metres, on the length of a road with the clauses and turns of a Brief.

    Args:
        brief: the requirements.
        min_radius: radius of the tightest turn allowed, in metres.
    """
    metres = sum(_way(clause, min_radius) for clause in brief.clauses)
    extra = span(brief.turns).lo - span(total(brief.clauses)).lo
    return metres + max(extra, 0) * WAY_OF_A_TURN


def _way(clause: Clause, min_radius: float) -> float:
    """Returns the least length of a clause in metres."""
    if clause.kind in STRAIGHT:
        size = SIZES[clause.size].length if clause.size else None
        least = (1 - LENGTH_SLACK) * span(clause.length).lo
        return least if least > -inf else size.lo if size else LEAST_STRAIGHT
    least, _ = turns_of(clause)
    own, sharp = KINDS[clause.kind].degrees, SHARPNESS[clause.sharpness] if clause.sharpness else None
    angle = clause.degrees.lo if clause.degrees and clause.degrees.lo else own.lo if own else 25.0
    if sharp and sharp.degrees and not clause.degrees and clause.kind == "turn":
        angle = sharp.degrees.lo
    radius = sharp.radius.lo if sharp and sharp.radius else 0.0
    if clause.radius and clause.radius.lo:
        radius = (1 - LENGTH_SLACK) * clause.radius.lo
    arc = radians(angle) * max(radius, min_radius)
    return least * max(arc + (0 if clause.kind in ("s_bend", "chicane") else GAP), WAY_OF_A_TURN * 0.8)
