"""A step that changes many slopes."""

from dataclasses import dataclass

from roadgpt.design.edit.steps import Aims, Goal, with_incline
from roadgpt.design.road_elements import RoadElements
from roadgpt.road import World


@dataclass(frozen=True, slots=True)
class SlopeOfAll:
    """Changes the slopes of many elements: each incline is multiplied, increased and then clipped."""

    names: frozenset[str]
    times: float = 1.0
    more: float = 0.0
    low: float = -100.0
    high: float = 100.0
    way: int = 0
    """1 or -1 makes every slope one uphill or downhill first."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """None, because inclines of many segments measure as they are written."""
        return ()

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Returns the elements with each segment's incline changed by itself."""
        limit = 100 * world.max_grade - 0.2

        def one(incline: float) -> float:
            if self.way:
                incline = self.way * abs(incline)
            by = self.more if incline >= 0 else -self.more
            incline = incline * self.times + by
            if self.way:
                incline = self.way * min(max(abs(incline), self.low), self.high)
            else:
                incline = min(max(incline, self.low), self.high)
            return min(max(incline, -limit), limit)

        return tuple(
            b.with_segments(with_incline(s, one(s.incline)) for s in b.segments)
            if b.name in self.names
            else b
            for b in elements
        )
