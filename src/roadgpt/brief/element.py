"""The turns and straights that a road is made of, as numbers."""

from math import inf, radians
from typing import NamedTuple

from roadgpt.brief.words import Range


class Element(NamedTuple):
    """A turn (a clothoid, an arc and a clothoid), or a straight where ``turn`` is 0; on one slope."""

    straight: float = 0.0
    """Length of a straight in metres. The length of a turn follows from its other numbers."""
    turn: float = 0.0
    """Change of heading in degrees, left positive."""
    radius: float = inf
    """Radius of the arc in metres."""
    transition: float = 0.0
    """Length in metres of the clothoid at either end of a turn."""
    incline: float = 0.0
    """Grade in percent, uphill positive."""
    vertical_radius: float | None = None
    """Radius in metres of the parabola from the slope before; None leaves it open."""
    required_length: Range | None = None
    """Metres that a straight was asked to have; None of a turn, or of a straight that only joins others."""
    required_grade: Range | None = None
    """Percent that the grade as a whole must lie in; None where nothing was asked."""

    @property
    def length(self) -> float:
        """Metres along the plan."""
        return self.radius * radians(abs(self.turn)) + self.transition if self.turn else self.straight

    @property
    def is_elastic(self) -> bool:
        """Whether this is a straight that may be made longer."""
        return not self.turn and (self.required_length is None or self.required_length.hi == inf)

    @property
    def has_fixed_length(self) -> bool:
        """Whether this is a straight whose length was asked for with an upper limit."""
        return self.required_length is not None and self.required_length.hi < inf

    @property
    def curvature(self) -> float:
        """Curvature of the arc in 1/m, left positive; 0 of a straight."""
        return (1 if self.turn > 0 else -1) / self.radius


Elements = tuple[Element, ...]
"""Elements of a road in driving order."""
