"""The cross-section of a road by station: where its lanes and shoulders have their edges."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry.curve import Array


class Edges(NamedTuple):
    """The offsets of two edges in metres to the left of the centre line, of the shape of the stations."""

    left: Array
    right: Array


@dataclass(frozen=True)
class Profile:
    """A cross-section of one lane in each direction, the right one driven, with a shoulder on both sides.

    Its methods take stations ``s`` of shape ``(...)`` in metres and return values of this shape in metres.
    Offsets are positive to the left of the centre line.
    """

    lane_width: float
    shoulder_width: float

    @property
    def paved_reach(self) -> float:
        """The greatest distance of an edge of the carriageway from the centre line in metres."""
        return self.lane_width

    @property
    def reach(self) -> float:
        """The greatest distance of the outer edge of a shoulder from the centre line in metres."""
        return self.lane_width + self.shoulder_width

    def width(self, s: ArrayLike) -> Array:
        """Returns the width of the driven lane."""
        return np.full(np.shape(s), self.lane_width)

    def shoulder(self, s: ArrayLike) -> Array:
        """Returns the width of the shoulder beside the driven lane."""
        return np.full(np.shape(s), self.shoulder_width)

    def middle(self, s: ArrayLike) -> Array:
        """Returns the offset of the middle of the driven lane."""
        return np.full(np.shape(s), -self.lane_width / 2)

    def edges(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the edges of the carriageway."""
        return Edges(np.full(np.shape(s), self.paved_reach), np.full(np.shape(s), -self.paved_reach))

    def rims(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the outer edges of the shoulders."""
        return Edges(np.full(np.shape(s), self.reach), np.full(np.shape(s), -self.reach))
