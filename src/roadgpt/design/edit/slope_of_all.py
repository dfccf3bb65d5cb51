"""The edit step that changes the grades of many elements, or of a stretch of the road, at once."""

from dataclasses import dataclass
from math import inf

import numpy as np

from roadgpt.brief.change.request import Way
from roadgpt.check.measures import way
from roadgpt.design.edit.stretches import RoadStretch, pieces
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.design.vertical import with_inclines
from roadgpt.road import World


@dataclass(frozen=True, slots=True)
class SlopeOfAll:
    """Changes the incline of each segment of several elements; no incline exceeds what the rules allow.

    The size of an incline i becomes |i| * ``times`` + ``more`` percent, limited by ``least`` and ``most``.
    """

    names: frozenset[str]
    times: float = 1.0
    more: float = 0.0
    least: float = -inf
    """Lower limit of the size of the new incline."""
    most: float = inf
    """Upper limit of the size of the new incline."""
    sign: int = 0
    """1 for uphill, -1 for downhill, 0 if each segment keeps its sign."""
    only: Way | None = None
    """The segments that change: those uphill, downhill or level before; None for all."""
    stretch: RoadStretch | None = None
    """The stretch of the road in which segments change; None for the whole road."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements with the new inclines."""
        at, out = 0.0, list[RoadElement]()
        for element in elements:
            out.append(self._applied(element, at, world) if element.name in self.names else element)
            at += element.length
        return tuple(out)

    def _applied(self, element: RoadElement, at: float, world: World) -> RoadElement:
        limit = 100 * world.limits.max_grade - 0.2
        segments, changes = element.segments, (True,) * len(element.segments)
        if self.stretch is not None:
            segments, changes = pieces(element, at, self.stretch)
        before = np.array([segment.incline for segment in segments])
        size = np.clip(np.abs(before) * self.times + self.more, self.least, self.most)
        signs = self.sign or np.where(before >= 0, 1, -1)
        after = np.clip(signs * size, -limit, limit) + 0.0  # no -0.0
        if self.only is not None:
            changes = tuple(
                there and way(incline) == self.only for there, incline in zip(changes, before, strict=True)
            )
        return element.with_segments(with_inclines(segments, np.where(changes, after, before)))
