"""Grades how far outside its lane a car was, on the one scale that pictures, pages, tables and terminals
colour by.

A tolerance says when a test has failed; it does not say that the car kept its lane. With the SBFT
competition's tolerance of 0.95, a car may pass with nearly its whole body outside, and such a PASS must look
different from that of a car that never left its lane.
"""

import math
from typing import Literal, get_args

Severity = Literal["inside", "partly outside", "mostly outside"]
SEVERITIES: tuple[Severity, ...] = get_args(Severity)
"""All grades, from the best to the worst."""

MOSTLY = 0.5
"""Share of the car's box outside its lane above which most of the car counts as outside."""


def severity(share: float) -> Severity:
    """Returns the grade of a share of the car's box outside its lane, 0 to 1."""
    if share > MOSTLY:
        return "mostly outside"
    return "partly outside" if share > 0 else "inside"


def graded(outcome: str, share: float | None) -> str:
    """Returns the outcome as it is shown: a PASS states how far outside the car was, if it was.

    Args:
        outcome: PASS, FAIL or any other outcome.
        share: largest share of the car's box outside its lane; None if it is not known.
    """
    if outcome != "PASS" or not share:
        return outcome
    return f"{outcome} ({severity(share)})"


def percent(share: float) -> str:
    """Returns a share in per cent; only 0 is shown as 0 %, and only 1 as 100 %."""
    told = f"{100 * share:.0f}"
    if told == "0" and share > 0:
        told = f"{100 * share:.1g}"
    elif told == "100" and share < 1:
        told = f"{math.floor(1000 * share) / 10:.1f}"
    return f"{told} %"
