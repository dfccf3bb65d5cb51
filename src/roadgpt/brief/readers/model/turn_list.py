"""Lists the turns of a road one by one, and joins equal ones again."""

from collections.abc import Sequence
from itertools import groupby

from roadgpt.brief.model import Clause, exactly
from roadgpt.brief.normal import SINGLE, STRAIGHT


def one_by_one(clauses: Sequence[Clause]) -> list[Clause]:
    """Returns clauses with a single turn each, and the straights between them.

    The result is empty if a clause does not say how many turns it has, if its turns alternate, or if it is a
    feature of several turns, such as an S-bend.
    """
    turning = [clause for clause in clauses if clause.kind not in STRAIGHT]
    if any(each.kind not in SINGLE or not each.count.exact or each.alternating for each in turning):
        return []
    return [one for clause in clauses for one in _ones(clause)]


def joined(clauses: Sequence[Clause]) -> tuple[Clause, ...]:
    """Returns clauses in which equal turns that follow one another are one clause with their number."""
    out: list[Clause] = []
    for clause, same in groupby(clauses):
        equal = [*same]
        is_turn = clause.kind not in STRAIGHT
        out += [clause.model_copy(update={"count": exactly(len(equal))})] if is_turn else equal
    return tuple(out)


def _ones(clause: Clause) -> list[Clause]:
    if clause.kind in STRAIGHT:
        return [clause]
    return [clause.model_copy(update={"count": exactly(1)})] * int(clause.count.lo or 0)
