"""The room that judges: a road, a Drive on it and the World give a Verdict. Verb: ``judge``.

The oracle is that of the SBFT tool competition: the car fails when the share of its box outside the right
lane is above the tolerance at any control step, when it falls, when it moves less than 1 m in 10 s, or when
time runs out; it passes when it comes within 8 m of the road's end. Both lanes' far side counts: the left
lane is outside.
"""

from roadgpt.verdict.judging import judge
from roadgpt.verdict.oracle import Oracle, consult
from roadgpt.verdict.verdict import Cause, Outcome, Side, Verdict

__all__ = ["Cause", "Oracle", "Outcome", "Side", "Verdict", "consult", "judge"]
