"""Defines Windows: the grades that the requirements allow a road and each of its features."""

from collections.abc import Sequence
from itertools import pairwise
from math import inf

from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import STEEPEST
from roadgpt.check.matching import change_of_grade
from roadgpt.check.measures import GradeChange
from roadgpt.check.rules.too_abrupt import MOST
from roadgpt.design.vertical import COMFORT
from roadgpt.errors import DesignError
from roadgpt.road import World

UNDER_LIMIT = 0.4  # percentage points kept off the steepest grade allowed
MARGIN = 0.5  # percentage points kept off the ends of a required range of grades
CLEARLY = 0.6  # percentage points between two straights of different grades that go the same way
MARGIN_SHARE = 0.2  # of the width of the range: no more is kept off


class Windows:
    """The ranges of grade, in percent, that the road and each of its features may have."""

    def __init__(self, outline: Outline, world: World) -> None:
        limit = min(100 * world.limits.max_grade, STEEPEST) - UNDER_LIMIT
        if outline.steepest:
            limit = min(limit, outline.steepest.hi - min(UNDER_LIMIT, 0.2 * outline.steepest.hi))
        self.limit = Range(-limit, limit)
        """The grades that are allowed anywhere."""
        self.comfort = world.limits.speed_limit**2 / COMFORT
        """The vertical radius in metres that is comfortable at the speed limit."""
        self.least = world.limits.speed_limit**2 / MOST
        """The least vertical radius in metres that the rule ``too_abrupt`` allows at the speed limit."""
        self.base: Range | None = None
        """The grades of features without a requirement of their own; None if they are free."""
        self.way = {"up": "uphill", "down": "downhill"}.get(outline.grade or "", "flat")
        self.allowed = {"up": Range(-1, inf), "down": Range(-inf, 1), "flat": Range(-1, 1)}.get(
            outline.grade or "", self.limit
        )
        if outline.grade == "flat":
            self.base = Range(-0.4, 0.4, number=0.0)
        elif outline.grade or outline.grade_range:
            usual = Range(-12, -3) if outline.grade == "down" else Range(3, 12)
            self.base = (outline.grade_range or usual).drawn_in(MARGIN, MARGIN_SHARE)
        if self.base:
            self.base = overlap(self.base, self.limit) or self.base
            if self.base.lo > self.base.hi:
                most = f"the {self.limit.hi + UNDER_LIMIT:.3g} % that it may have"
                raise DesignError(f"a road of {outline.grade_range} % is steeper than {most}; ask for less")

    def of(self, feature: Feature) -> Range | None:
        """Returns the range of grades for the design of a feature, a little inside its required range or, if
        it has none, that for the road; None if that is open as well. Raises DesignError if the required grade
        is steeper than allowed, or contradicts that of the whole road."""
        if feature.grade is None:
            return self.base
        own = overlap(feature.grade.drawn_in(MARGIN, MARGIN_SHARE), self.limit) or self.limit
        if own.lo > own.hi:
            most = f"the {self.limit.hi + UNDER_LIMIT:.3g} % that the road may have"
            raise DesignError(f"a {feature.name} of {feature.grade} % is steeper than {most}; ask for less")
        meets = overlap(own, self.base) or own
        if meets.lo <= meets.hi:
            return meets
        if own.hi <= self.allowed.lo or own.lo >= self.allowed.hi:
            whole = f"a road that is {self.way} all the way"
            raise DesignError(
                f"a {feature.name} of {feature.grade} % contradicts {whole}; leave one of them out"
            )
        return own

    def row(self, straights: Sequence[Feature]) -> list[Range | None]:
        """Returns a range of grades per straight; an open grade gets a range unlike that of a neighbour."""
        out = [self.of(straight) for straight in straights]
        for i, straight in enumerate(straights):
            known = out[i - 1] if i else (out[i + 1] if i + 1 < len(out) else None)
            if straight.grade is None and self.base is None and known:
                out[i] = self.other(known)
        for i, (one, other) in enumerate(pairwise(straights)):
            out[i : i + 2] = _divided(out[i : i + 2], change_of_grade(one.grade, other.grade))
        return out

    def other(self, grade: Range | None) -> Range:
        """Returns a range of grades that measurements can distinguish from the range ``grade``."""
        if self.base and not (self.base.lo <= 0 <= self.base.hi):
            return Range(0, 0)
        return Range(0, 0) if grade is None or grade.lo > 1 or grade.hi < -1 else Range(3.5, 6)

    @staticmethod
    def between(one: Range | None, other: Range | None) -> float:
        """Returns the least change of grade between two ranges, in percentage points; 0 if they overlap."""
        return max(one.lo - other.hi, other.lo - one.hi, 0.0) if one and other else 0.0

    def part(self, one: Range | None, other: Range | None) -> bool:
        """Returns whether the grade must change between two features with these ranges of grade."""
        return self.between(one, other) > 0


def _divided(pair: list[Range | None], change: GradeChange | None) -> list[Range | None]:
    """Returns the ranges of grade of two straights, clearly apart from the grade between them; unchanged if
    there is no change, or if one of them would become empty."""
    one, other = pair
    if change is None or one is None or other is None:
        return pair
    low, high = Range(hi=change.grade - CLEARLY / 2), Range(lo=change.grade + CLEARLY / 2)
    first, second = (low, high) if change.rises else (high, low)
    found = [overlap(one, first) or one, overlap(other, second) or other]
    return [*found] if all(each.lo <= each.hi for each in found) else pair
