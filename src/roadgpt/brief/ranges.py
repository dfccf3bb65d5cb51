"""Defines Range, a closed interval of numbers, and what two ranges have in common."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import inf


@dataclass(frozen=True, slots=True)
class Range:
    """A closed interval from ``lo`` to ``hi``; either end may be infinite."""

    lo: float = -inf
    hi: float = inf
    number: float | None = field(default=None, compare=False, repr=False)
    """The number that was asked for, if the interval is its tolerance; None if an interval was asked for."""

    def __contains__(self, number: float) -> bool:
        return self.lo <= number <= self.hi

    def __str__(self) -> str:
        if self.lo == self.hi:
            return f"{self.lo:g}"
        if self.lo == -inf:
            return f"{self.hi:g} or less"
        return f"{self.lo:g} or more" if self.hi == inf else f"{self.lo:g} to {self.hi:g}"

    def drawn_in(self, margin: float, share: float) -> Range:
        """Returns the range narrowed at both ends by ``margin``, or by the fraction ``share`` (0 to 1) of
        its width if that is less."""
        edge = min(margin, share * (self.hi - self.lo))
        return Range(self.lo + edge, self.hi - edge, self.number)

    @property
    def usual(self) -> float:
        """``number``, or the middle of the range if ``number`` is None; infinite if one end is open."""
        return (self.lo + self.hi) / 2 if self.number is None else self.number

    @property
    def negative(self) -> Range:
        """The range of the same numbers with the opposite sign."""
        return Range(-self.hi, -self.lo, None if self.number is None else -self.number)

    def around(self, share: float) -> Range:
        """Returns the range with its tolerance on both sides of ``number`` multiplied by ``share`` (0 to 1);
        unchanged if ``number`` is None."""
        if self.number is None:
            return self
        low, high = self.number - self.lo, self.hi - self.number
        return Range(self.number - share * low, self.number + share * high, self.number)


def nearest(number: float, *ranges: Range) -> float:
    """Returns the number nearest to ``number`` that lies in all of the ranges, which must overlap."""
    low, high = max(each.lo for each in ranges), min(each.hi for each in ranges)
    return min(max(number, low), high)


def overlap(one: Range | None, other: Range | None) -> Range | None:
    """Returns the intersection of two ranges; None means no limit, and an empty intersection has ``lo`` >
    ``hi``."""
    if one is None or other is None:
        return one or other
    found = Range(max(one.lo, other.lo), min(one.hi, other.hi))
    number = other.number if one.number is None else one.number
    return replace(found, number=number) if number is not None and number in found else found
