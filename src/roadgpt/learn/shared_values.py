"""Rewrites plans for training: a value that all turns share is written once, for the whole road.

The normal form repeats such a value in every clause, and a small network that has to write "r=20.." seven
times loses count.
"""

from collections.abc import Sequence

from roadgpt.brief.model import Amount
from roadgpt.brief.normal import STRAIGHT, normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.slots import NumberSlot

FIELDS = ("degrees", "radius")
FEWEST = 2
"""The least number of turning clauses for which the rewritten plan is shorter."""


def with_shared_values(line: str, slots: Sequence[NumberSlot]) -> str:
    """Moves degrees and radii that all turns share to the part of a plan that holds for the whole road.

    A value is moved only if each of its numbers occurs exactly once in the description, two or more turns
    share it, and the plan has no such value for the whole road yet.

    Args:
        line: a plan, or a refusal.
        slots: the numbers in the description.

    Returns:
        A plan with the same normal form.
    """
    if line.startswith("!"):
        return line
    brief = read_plan(line)
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    for name in FIELDS:
        amounts = {getattr(clause, name) for clause in turning}
        shared = next(iter(amounts)) if len(amounts) == 1 else None
        if len(turning) < FEWEST or not shared or getattr(brief, name) or not _is_said_once(shared, slots):
            continue
        clauses = tuple(
            clause if clause.kind in STRAIGHT else clause.model_copy(update={name: None})
            for clause in brief.clauses
        )
        brief = brief.model_copy(update={"clauses": clauses, name: shared})
    return plan(brief) if normal(brief) == normal(read_plan(line)) else line


def _is_said_once(amount: Amount, slots: Sequence[NumberSlot]) -> bool:
    values = [slot.value for slot in slots]
    return all(values.count(number) == 1 for number in (amount.lo, amount.hi) if number is not None)
