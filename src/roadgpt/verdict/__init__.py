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

from typing import TYPE_CHECKING, Any

from roadgpt.later import load, names_of

if TYPE_CHECKING:
    from roadgpt.verdict.judging import judge, most_beyond
    from roadgpt.verdict.measures import Measures, measure
    from roadgpt.verdict.oracle import Oracle, consult
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

# Commands that only show results load classes and scale alone; judging loads when needed.
_OFFERED = {
    "judging": "judge most_beyond",
    "measures": "Measures measure",
    "oracle": "Oracle consult",
    "verdict": "JUDGEMENT SEVERITIES Cause Contact Incident Outcome Severity Side Verdict graded percent "
    "severity",
}
__all__ = names_of(_OFFERED)


def __getattr__(name: str) -> Any:
    return load(__name__, _OFFERED, name)
