"""Moves a value that all turns share to the whole road, in the plan that a network learns to write.

The normal form repeats it in every clause, and a small network that has to write "r=20.." seven times
loses count.
"""

from collections.abc import Sequence

from roadgpt.brief.model import Amount
from roadgpt.brief.normal import STRAIGHT, normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.slots import NumberSlot

FIELDS = ("degrees", "radius")
FEWEST = 2
"""The number of turning clauses from which this makes a plan shorter."""


def with_shared_values(line: str, slots: Sequence[NumberSlot]) -> str:
    """Returns the plan with shared degrees and radii after the bar, if the text has them only once.

    Args:
        line: a plan, or a refusal.
        slots: the numbers of its text.

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
