"""Computes what "halfway" means in a plan: half of the length of the whole route, with a tolerance.

| halfway // t_junction left || len=400   ->   | len=180..220 // t_junction left || len=400
"""

import re

from roadgpt.brief.amount import figure
from roadgpt.errors import BriefError

HALFWAY = "halfway"
SHARES = (0.45, 0.55)
"""The shares of the length of the route that count as half of it."""
WORD = re.compile(rf"\b{HALFWAY}\b")
WHOLE_LENGTH = re.compile(r"\|\|[^|]*\blen=(\d+(?:\.\d+)?)(?![\d.])")


def without_halfway(line: str) -> str:
    """Returns a plan with a range of lengths, such as "len=180..220", in place of each word "halfway".

    Raises:
        BriefError: The plan does not give the length of the whole route as one number.
    """
    if not WORD.search(line):
        return line
    found = WHOLE_LENGTH.search(line)
    if found is None:
        raise BriefError("'halfway' in a plan needs the length of the whole route, as in || len=400")
    return WORD.sub(_length(float(found[1])), line)


def with_halfway(line: str) -> str:
    """Returns a plan with the word "halfway" in place of each length that means half of the whole route.

    A plan that does not give the length of the whole route as one number is returned unchanged.
    """
    found = WHOLE_LENGTH.search(line)
    return (
        line if found is None else re.sub(rf"{re.escape(_length(float(found[1])))}(?![\d.])", HALFWAY, line)
    )


def _length(whole: float) -> str:
    low, high = (figure(share * whole) for share in SHARES)
    return f"len={low}..{high}"
