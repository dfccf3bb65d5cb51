"""Defines Amount, a number as a description gives it, and Frozen, the base class of immutable values."""

import re
from collections.abc import Callable, Iterator
from math import inf
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from roadgpt.brief.ranges import Range
from roadgpt.errors import BriefError

NUMBER = r"-?\d{1,15}(?:\.\d+)?"
AMOUNT = re.compile(rf"({NUMBER})?(\.\.)?({NUMBER})?")


class Frozen(BaseModel):
    """Base class of immutable values that are compared by content and read from and written to JSON."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def __repr_args__(self) -> Iterator[tuple[str | None, Any]]:
        """Yields only the fields that differ from their defaults, so that a printed Brief stays readable."""
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if field.is_required() or value != field.get_default(call_default_factory=True):
                yield name, value


class Amount(Frozen):
    """A number as the description gives it: exact (lo == hi), a lower bound (hi is None), an upper bound (lo
    is None) or a range."""

    lo: Annotated[float | None, Field(allow_inf_nan=False)] = None
    hi: Annotated[float | None, Field(allow_inf_nan=False)] = None

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.lo is None and self.hi is None:
            raise ValueError("an amount needs a lower or an upper bound")
        if self.lo is not None and self.hi is not None and self.lo > self.hi:
            raise ValueError(f"an amount between {self.lo:g} and {self.hi:g} has its bounds swapped")
        return self

    def __str__(self) -> str:
        lo, hi = (None if number is None else figure(number) for number in (self.lo, self.hi))
        if lo is None:
            return f"at most {hi}"
        return f"at least {lo}" if hi is None else lo if self.exact else f"{lo} to {hi}"

    @property
    def exact(self) -> bool:
        """True if the amount is a single number, not a bound or a range."""
        return self.lo == self.hi

    def times(self, factor: float) -> "Amount":
        """Returns the Amount of all numbers that this one allows, each multiplied by ``factor``."""
        ends = [None if end is None else end * factor + 0.0 for end in (self.lo, self.hi)]  # never -0
        lo, hi = ends if factor > 0 else ends[::-1]
        return Amount(lo=lo, hi=hi)


def span(amount: Amount | None) -> Range:
    """Returns the range of numbers that an amount allows; None allows every number."""
    lo, hi = (amount.lo, amount.hi) if amount else (None, None)
    return Range(-inf if lo is None else lo, inf if hi is None else hi)


def about(amount: Amount | None, slack: Callable[[float], float]) -> Range:
    """Returns the range of numbers that an amount allows, with a tolerance around a single number."""
    asked = span(amount)
    if amount is None or not amount.exact:
        return asked
    return Range(asked.lo - slack(asked.lo), asked.lo + slack(asked.lo), number=asked.lo)


def meets(amount: Amount | None, possible: Range) -> bool:
    """Returns whether an amount allows at least one number of a range; None allows every number."""
    own = span(amount)
    return max(own.lo, possible.lo) <= min(own.hi, possible.hi)


def figure(number: float, decimals: int = 4) -> str:
    """Formats a number in plain decimals, never with an exponent, and without trailing zeros."""
    return f"{number:.{decimals}f}".rstrip("0").rstrip(".")


def amount_text(amount: Amount) -> str:
    """Returns an amount as it is written in a plan: 3, 3.., ..3 or 3..5."""
    low, high = ("" if end is None else figure(end, 6) for end in (amount.lo, amount.hi))
    return low if amount.exact else f"{low}..{high}"


def read_amount(text: str) -> Amount:
    """Returns the amount that a plan gives. Raises BriefError for other texts and for reversed ranges."""
    match = AMOUNT.fullmatch(text)
    if not match or not (match[1] or match[3]) or (match[1] and match[3] and not match[2]):
        raise BriefError(
            f"'{text[:40]}' is not a number in a plan; write 3, 3.., ..3 or 3..5, with 15 digits at most"
        )
    low, high = (float(bound) if bound else None for bound in (match[1], match[3]))
    try:
        return Amount(lo=low, hi=high if match[2] else low)
    except ValidationError as error:
        raise BriefError(
            f"the range '{text[:40]}' in a plan is reversed; write the smaller number first"
        ) from error


def exactly(number: float) -> Amount:
    """Returns the Amount that allows only this number."""
    return Amount(lo=number, hi=number)


def at_least(number: float) -> Amount:
    """Returns the Amount that allows this number or more."""
    return Amount(lo=number)


def at_most(number: float) -> Amount:
    """Returns the Amount that allows this number or less."""
    return Amount(hi=number)


def between(low: float, high: float) -> Amount:
    """Returns the Amount of every number from ``low`` to ``high``, both included; ``high`` may be inf."""
    return Amount(lo=low, hi=high if high < inf else None)
