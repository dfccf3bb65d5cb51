"""Says in three levels how far outside its lane a car was: at most 10 % of it, partly or mostly.

All pictures, pages, tables and terminal output colour results by these levels. A car that passes a test may
have been partly outside its lane, and with a tolerance above 0.5, such as that of RoadGPT's thesis, even
mostly. The levels distinguish such a PASS from the PASS of a car that kept to its lane.
"""

import math
from typing import Literal, get_args

Severity = Literal["at most 10 % outside", "partly outside", "mostly outside"]
SEVERITIES: tuple[Severity, ...] = get_args(Severity)
"""All levels, from the best to the worst."""

PARTLY, MOSTLY = 0.1, 0.5
"""Shares of the car's bounding box outside its lane above which the level is "partly" or "mostly outside"."""


def severity(share: float) -> Severity:
    """Returns the level for a share (0 to 1) of the car's bounding box outside its lane."""
    if share > MOSTLY:
        return "mostly outside"
    return "partly outside" if share > PARTLY else SEVERITIES[0]


def graded(outcome: str, share: float | None) -> str:
    """Returns the outcome as displayed, for example "PASS (partly outside)".

    The level is appended only to PASS, and only if the share is known and above 10 %.

    Args:
        outcome: PASS, FAIL or any other outcome.
        share: Largest share of the car's bounding box outside its lane, 0 to 1; None if it is not known.
    """
    if outcome != "PASS" or (share or 0.0) <= PARTLY:
        return outcome
    return f"{outcome} ({severity(share or 0.0)})"


def percent(share: float) -> str:
    """Returns a share (0 to 1) as text in per cent.

    Only exactly 0 becomes "0 %", and only exactly 1 becomes "100 %"; less than
    0.001 % is rounded up to it."""
    told = f"{100 * share:.0f}"
    if told == "0" and share > 0:
        told = f"{max(100 * share, 0.001):.1g}"
    elif told == "100" and share < 1:
        told = f"{math.floor(1000 * share) / 10:.1f}"
    return f"{told} %"
