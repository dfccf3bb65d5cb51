"""Judges a Drive on a road, and returns a Verdict. Main function: ``judge``.

The test oracle is that of the SBFT tool competition, with a tolerance of 0.5 by default; others have names in
``roadgpt.road.ORACLES``. The car fails if the share of its bounding box outside its lane, to which neither
other lanes nor the shoulder belong, exceeds the tolerance at any control step, if it falls off the road, if
it moves less than 1 m in 10 s, or if a time limit is exceeded; with ``World.limits.lane_departure``, also as
soon as a front tyre crosses a marking. It passes if it comes within 8 m of the end of the road.

On a route through junctions, or among others, a verdict also lists what else went wrong
(``roadgpt.verdict.criteria``), and of the first collision who had the way, whether it could have been
avoided, and whose fault it was; ``measure`` returns how critical a drive was.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from roadgpt.verdict.verdict import (
    JUDGEMENT,
    SEVERITIES,
    Cause,
    Contact,
    Incident,
    Outcome,
    Severity,
    Side,
    Verdict,
    graded,
    percent,
    severity,
)

if TYPE_CHECKING:
    from roadgpt.verdict.judging import judge, most_beyond
    from roadgpt.verdict.measures import Measures, measure
    from roadgpt.verdict.oracle import Oracle, consult

__all__ = [
    "JUDGEMENT",
    "SEVERITIES",
    "Cause",
    "Contact",
    "Incident",
    "Measures",
    "Oracle",
    "Outcome",
    "Severity",
    "Side",
    "Verdict",
    "consult",
    "graded",
    "judge",
    "measure",
    "most_beyond",
    "percent",
    "severity",
]

# The classes and the scale load at once, for commands that only show results; judging loads when needed.
_LATER = {
    "judge": "judging", "most_beyond": "judging", "Oracle": "oracle", "consult": "oracle",
    "Measures": "measures", "measure": "measures",
}  # fmt: skip


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"roadgpt.verdict has no '{name}'; it offers {', '.join(__all__)}")
    return getattr(import_module(f"roadgpt.verdict.{_LATER[name]}"), name)
