"""Derives the directions of turns that follow from the other numbers of a Brief.

If 4 of 5 turns go left, 1 goes right; if none of 3 turns goes left, all go right.
"""

from roadgpt.brief.model import Amount, Brief, Clause, Side, exactly

SIDES: tuple[tuple[Side, Side], ...] = (("left", "right"), ("right", "left"))
NONE = exactly(0)


def with_other_side(whole: Brief, turns: Amount) -> Brief:
    """Fills in the number of turns in one direction, if the total and the number in the other direction
    are exact.
    """
    if not turns.exact or turns.lo is None:
        return whole
    for one, other in SIDES:
        counted: Amount | None = getattr(whole, one)
        if counted and counted.exact and getattr(whole, other) is None and (counted.lo or 0) <= turns.lo:
            return whole.model_copy(update={other: exactly(turns.lo - (counted.lo or 0))})
    return whole


def forced_side(whole: Brief) -> Side | None:
    """Returns the direction of all turns if turns in the other direction are excluded; None if they are
    not.
    """
    sides = [one for one, other in SIDES if getattr(whole, other) == NONE]
    return sides[0] if len(sides) == 1 else None


def as_clause(whole: Brief, clauses: list[Clause]) -> tuple[Brief, list[Clause]]:
    """Converts a requirement such as '4 turns or more, none to the right' to a clause of 4 or more left
    turns.
    """
    side, turns = forced_side(whole), whole.turns
    if clauses or not side or not turns or not turns.lo or whole.starts or whole.ends:
        return whole, clauses
    return whole.model_copy(update={"turns": None, "alternating": False}), [
        Clause(kind="turn", count=turns, side=side)
    ]
