"""What every plan curve and every height profile answers."""

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class PlanCurve(Protocol):
    """A curve in the plane, asked by arc length ``s`` in metres, 0 to ``length``."""

    @property
    def length(self) -> float:
        """Arc length, metres."""
        ...

    def at(self, s: ArrayLike) -> Array:
        """Points ``(..., 2)`` in metres at stations ``s`` of shape ``(...)``."""
        ...

    def heading(self, s: ArrayLike) -> Array:
        """Directions in radians, counter-clockwise from +x, continuous along the curve."""
        ...

    def curvature(self, s: ArrayLike) -> Array:
        """Curvatures in 1/m, positive to the left."""
        ...


class ElevationProfile(Protocol):
    """Heights over the same stations as the plan."""

    def height(self, s: ArrayLike) -> Array:
        """Heights in metres."""
        ...

    def grade(self, s: ArrayLike) -> Array:
        """Slopes dz/ds, as ratios: 0.05 climbs 5 m in 100 m."""
        ...

    def vertical_curvature(self, s: ArrayLike) -> Array:
        """Change of slope d2z/ds2 in 1/m, negative on a crest."""
        ...


def wrap_angle(angle: ArrayLike) -> Array:
    """The same direction within (-pi, pi]."""
    return np.pi - np.mod(np.pi - np.asarray(angle, float), 2 * np.pi)
