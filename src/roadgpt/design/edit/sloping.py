"""Steps that change slopes."""

from dataclasses import dataclass

import numpy as np

from roadgpt.design.edit.steps import Aims, Goal, changed, with_incline
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.road import World


@dataclass(frozen=True, slots=True)
class Slope:
    """Another grade of one turn or straight, percent as measured."""

    element: RoadElement
    grade: float
    low: float
    high: float

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The grade, where the element is seen."""
        if self.element.seen is None:
            return ()
        return (Goal(self.element.name, "grade", self.grade, self.low, self.high),)

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Inclines in proportion where they all go the same way, else all alike."""
        limit = 100 * world.max_grade - 0.2
        aim = float(np.clip(aims.get((self.element.name, "grade"), self.grade), -limit, limit))

        def sloped(element: RoadElement) -> RoadElement:
            inclines = np.array([s.incline for s in element.segments])
            mean = element.incline
            if abs(mean) >= 1 and (inclines * np.sign(mean) > 0.5).all() and aim * mean > 0:
                wanted = np.clip(inclines * aim / mean, -limit, limit)
            else:
                wanted = np.full(len(inclines), aim)
            return element.with_segments(
                with_incline(s, g) for s, g in zip(element.segments, wanted, strict=True)
            )

        return changed(elements, self.element.name, sloped)


@dataclass(frozen=True, slots=True)
class SlopeOfAll:
    """Another slope of many elements: every incline times a factor, and so much more; then within bounds."""

    names: frozenset[str]
    times: float = 1.0
    more: float = 0.0
    low: float = -100.0
    high: float = 100.0
    way: int = 0
    """1 or -1 makes every slope one uphill or downhill first."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """None: inclines of many segments measure as they are written."""
        return ()

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Every segment by itself."""
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
