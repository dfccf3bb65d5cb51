"""Says in three levels how far outside its lane a car was: inside, partly outside or mostly outside.

All pictures, pages, tables and terminal output colour results by these levels. With the SBFT competition's
tolerance of 0.95, a car may pass a test with nearly its whole body outside its lane. The levels distinguish
such a PASS from the PASS of a car that never left its lane.
"""

import math
from typing import Literal, get_args

Severity = Literal["inside", "partly outside", "mostly outside"]
SEVERITIES: tuple[Severity, ...] = get_args(Severity)
"""All levels, from the best to the worst."""

MOSTLY = 0.5
"""Share of the car's bounding box outside its lane above which the level is "mostly outside"."""


def severity(share: float) -> Severity:
    """Returns the level for a share (0 to 1) of the car's bounding box outside its lane."""
    if share > MOSTLY:
        return "mostly outside"
    return "partly outside" if share > 0 else "inside"


def graded(outcome: str, share: float | None) -> str:
    """Returns the outcome as displayed, for example "PASS (partly outside)".

    The level is appended only to PASS, and only if the share is known and not 0.

    Args:
        outcome: PASS, FAIL or any other outcome.
        share: Largest share of the car's bounding box outside its lane, 0 to 1; None if it is not known.
    """
    if outcome != "PASS" or not share:
        return outcome
    return f"{outcome} ({severity(share)})"


def percent(share: float) -> str:
    """Returns a share (0 to 1) as text in per cent.

    Only exactly 0 becomes "0 %", and only exactly 1 becomes "100 %"."""
    told = f"{100 * share:.0f}"
    if told == "0" and share > 0:
        told = f"{100 * share:.1g}"
    elif told == "100" and share < 1:
        told = f"{math.floor(1000 * share) / 10:.1f}"
    return f"{told} %"
