"""Defines the NetworkPose: a place in a network and a heading."""

import math
from typing import NamedTuple


class NetworkPose(NamedTuple):
    """A point in metres and a heading in radians."""

    point: tuple[float, float, float]
    heading: float

    def ahead(self, metres: float, turn: float = 0.0) -> "NetworkPose":
        """Returns the pose this far ahead at the same height, with a heading that has changed by ``turn``."""
        (x, y, z), h = self.point, self.heading
        return NetworkPose((x + metres * math.cos(h), y + metres * math.sin(h), z), h + turn)
