"""Defines the standard form of a plan, and which plans make sense as training data."""

from roadgpt.brief.feasible import is_possible
from roadgpt.brief.model import Brief, exactly
from roadgpt.brief.normal import normal, total
from roadgpt.brief.plan import plan

MOST_TURNS = 12


def standard(brief: Brief) -> str:
    """Brings a Brief into normal form and returns its plan."""
    return plan(normal(brief))


def makes_sense(brief: Brief) -> bool:
    """Returns True if the Brief asks for a road that a map of 250 m can hold, with at most 12 turns.

    A Brief makes no sense if it requires nothing, or if it excludes turns but states their sharpness, angle
    or radius.
    """
    said = normal(brief)
    shapes = said.sharpness or said.degrees or said.radius
    if brief == Brief() or (said.turns == exactly(0) and shapes):
        return False
    turns = max(each.lo or 0 for each in (total(said.clauses), said.turns) if each)
    return turns <= MOST_TURNS and is_possible(brief)
