"""What a segment list proposes: its turns with their sides, its straights, and the slope of each.

Segments of one hand in a row are one turn, as RoadGPT's prompt asks of turns beyond 70 degrees; straight ones
are one part as long as they all go up, down or level.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from roadgpt.check.measures import LEAST_TURN, Measures, way
from roadgpt.road import Segment


class Part(NamedTuple):
    """Segments ``first`` to ``end`` (not included) that are one turn, or straight and of one slope."""

    first: int
    end: int
    degrees: float
    """Of all together, left positive; 0 of a straight."""

    @property
    def is_turn(self) -> bool:
        """Does it turn far enough to be seen as a turn?"""
        return abs(self.degrees) >= LEAST_TURN

    @property
    def side(self) -> str:
        """Of a turn."""
        return "left" if self.degrees > 0 else "right"

    @property
    def members(self) -> range:
        """Indices of its segments."""
        return range(self.first, self.end)


def parts_of(segments: Sequence[Segment]) -> tuple[Part, ...]:
    """The parts of a segment list, in driving order."""
    out: list[Part] = []
    for index, segment in enumerate(segments):
        turn, last = segment.turn_degrees, out[-1] if out else None
        if (
            last
            and np.sign(last.degrees) == np.sign(turn)
            and (turn or _goes_on(segments[index - 1 : index + 1]))
        ):
            out[-1] = Part(last.first, index + 1, last.degrees + turn)
        else:
            out.append(Part(index, index + 1, turn))
    return tuple(out)


def _goes_on(pair: Sequence[Segment]) -> bool:
    """Does a straight go on as it was, up, down or level?"""
    return way(pair[0].incline) == way(pair[1].incline)


def turns_of(parts: Sequence[Part]) -> tuple[Part, ...]:
    """Those that are turns."""
    return tuple(part for part in parts if part.is_turn)


def mean_incline(part: Part, segments: Sequence[Segment]) -> float:
    """Percent, over all segments of a part."""
    own = [segments[i] for i in part.members]
    return sum(s.distance * s.incline for s in own) / sum(s.distance for s in own)


def shows(found: Measures, proposed: Sequence[Segment]) -> bool:
    """Has a measured road the turns that were proposed, to their sides, and each on its slope?"""
    turns = turns_of(parts_of(proposed))
    if [turn.side for turn in found.turns] != [turn.side for turn in turns]:
        return False
    pairs = zip(found.turns, turns, strict=True)
    return all(way(turn.grade) == way(mean_incline(part, proposed)) for turn, part in pairs)
