"""Writes and reads the numbers of plans: 3, 3.., ..3 and 3..5."""

import re

from pydantic import ValidationError

from roadgpt.brief.amount import Amount
from roadgpt.errors import BriefError

NUMBER = r"-?\d+(?:\.\d+)?"
AMOUNT = re.compile(rf"({NUMBER})?(\.\.)?({NUMBER})?")


def amount_text(amount: Amount) -> str:
    """Returns an amount as it is written in a plan."""
    if amount.exact:
        return _number(amount.lo)
    low, high = (_number(bound) for bound in (amount.lo, amount.hi))
    return f"{low}..{high}"


def read_amount(text: str) -> Amount:
    """Returns the amount that a plan gives.

    Raises:
        BriefError: The text is not an amount, or the first number of a range is the larger one.
    """
    match = AMOUNT.fullmatch(text)
    if not match or not (match[1] or match[3]) or (match[1] and match[3] and not match[2]):
        raise BriefError(f"'{text[:40]}' is not a number in a plan; write 3, 3.., ..3 or 3..5")
    low, high = (float(bound) if bound else None for bound in (match[1], match[3]))
    try:
        return Amount(lo=low, hi=high if match[2] else low)
    except ValidationError as error:
        raise BriefError(
            f"the range '{text[:40]}' in a plan is reversed; write the smaller number first"
        ) from error


def _number(value: float | None) -> str:
    """Returns a number in plain decimals, never with an exponent; an empty string for None."""
    return "" if value is None else f"{value:.6f}".rstrip("0").rstrip(".")
