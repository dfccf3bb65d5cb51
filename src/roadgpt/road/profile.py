"""Defines the cross-section of a road: the edges of its lanes and shoulders at each station."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry.curve import Array


class Edges(NamedTuple):
    """The offsets of a left and a right edge, in metres to the left of the centre line.

    Both arrays have the shape of the stations for which they were computed.
    """

    left: Array
    right: Array


@dataclass(frozen=True)
class Profile:
    """The cross-section of a road with one lane in each direction and a shoulder on both sides.

    The right lane is the driven one. Methods take stations ``s`` in metres, of any shape, and return values
    in metres, of the same shape. Offsets are positive to the left of the centre line.
    """

    lane_width: float
    shoulder_width: float

    @property
    def paved_reach(self) -> float:
        """The largest distance in metres between the centre line and an edge of the carriageway."""
        return self.lane_width

    @property
    def reach(self) -> float:
        """The largest distance in metres between the centre line and the outer edge of a shoulder."""
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
