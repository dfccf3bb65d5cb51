"""The numerical description of the turns and straights that a road is made of."""

from math import inf, radians
from typing import Literal, NamedTuple

from roadgpt.brief.ranges import Range


class Element(NamedTuple):
    """One turn or one straight; its grade is constant, and ``turn`` is 0 for a straight.

    A turn consists of a clothoid, an arc and a second clothoid."""

    straight: float = 0.0
    """Length of a straight in metres; not used for a turn, whose length follows from its other fields."""
    turn: float = 0.0
    """Change of heading in degrees, positive to the left; 0 for a straight."""
    radius: float = inf
    """Radius of the arc of a turn in metres; infinite for a straight."""
    transition: float = 0.0
    """Length in metres of each of the two clothoids of a turn."""
    incline: float = 0.0
    """Grade in percent, uphill positive."""
    vertical_radius: float | None = None
    """Radius in metres of the vertical curve (a parabola) between the previous grade and this one; None
    leaves the choice to the design."""
    required_length: Range | None = None
    """Allowed range of the length of a straight, in metres; None for a turn, and for a straight that was
    added only to join other elements."""
    required_grade: Range | None = None
    """Allowed range of the mean grade, in percent; None if the description asks for no grade here."""
    required_climb: Range | None = None
    """Allowed range of the height of the end above the start, in metres; None if none is asked for here."""
    half: Literal["", "both", "first", "second"] = ""
    """For a turn with a crest or a dip in its middle, "both": the requirements are then those of its first
    half, and its second half has the opposite ones. "first" and "second" are one half of such a turn, which
    has a clothoid at its outer end only."""

    @property
    def halves(self) -> "tuple[Element, ...]":
        """The two halves of a turn with a crest or a dip in its middle; the element itself otherwise."""
        if self.half != "both":
            return (self,)
        first = self._replace(turn=self.turn / 2, half="first")
        grade, climb = (span and span.negative for span in (self.required_grade, self.required_climb))
        return first, first._replace(half="second", required_grade=grade, required_climb=climb)

    @property
    def length(self) -> float:
        """Length in metres along the plan view of the road."""
        ends = 0.5 if self.half in ("first", "second") else 1.0
        return self.radius * radians(abs(self.turn)) + ends * self.transition if self.turn else self.straight

    @property
    def is_elastic(self) -> bool:
        """Whether this is a straight that the design may lengthen at will."""
        return not self.turn and (self.required_length is None or self.required_length.hi == inf)

    @property
    def has_fixed_length(self) -> bool:
        """Whether this is a straight that the design may not lengthen at will, because its required length
        has an upper limit."""
        return self.required_length is not None and self.required_length.hi < inf

    @property
    def curvature(self) -> float:
        """Curvature of the arc in 1/m, positive to the left; 0 for a straight."""
        return (1 if self.turn > 0 else -1) / self.radius


Elements = tuple[Element, ...]
"""The elements of a road in driving order."""
