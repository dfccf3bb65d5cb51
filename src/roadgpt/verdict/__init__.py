"""The room that judges: a road, a Drive on it and the World give a Verdict. Verb: ``judge``.

The oracle is that of the SBFT tool competition: the car fails when the share of its box outside the right
lane is above the tolerance at any control step, when it falls, when it moves less than 1 m in 10 s, or when
time runs out; it passes when it comes within 8 m of the road's end. Both lanes' far side counts: the left
lane is outside. Where the World asks for it, the car fails at a lane departure, too. How far outside a car
was is told of every drive, on the one scale in ``severity.py``.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from roadgpt.verdict.severity import SEVERITIES, Severity, graded, percent, severity
from roadgpt.verdict.verdict import Cause, Outcome, Side, Verdict

if TYPE_CHECKING:
    from roadgpt.verdict.judging import judge, most_beyond
    from roadgpt.verdict.oracle import Oracle, consult

__all__ = [
    "SEVERITIES",
    "Cause",
    "Oracle",
    "Outcome",
    "Severity",
    "Side",
    "Verdict",
    "consult",
    "graded",
    "judge",
    "most_beyond",
    "percent",
    "severity",
]

# Values and the scale load at once, for commands that only tell; judging waits until somebody judges.
_LATER = {"judge": "judging", "most_beyond": "judging", "Oracle": "oracle", "consult": "oracle"}


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"roadgpt.verdict has no '{name}'; it offers {', '.join(__all__)}")
    return getattr(import_module(f"roadgpt.verdict.{_LATER[name]}"), name)
