"""Defines the protocols that all plane curves and all elevation profiles implement."""

from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Point = tuple[float, float, float]
"""x, y and z in metres."""
LEAST_STRETCH = 0.2  # lower bound of the metres beside a curve per metre of it, on the inside of a bend
Number = TypeVar("Number", float, Array)


class PlanCurve(Protocol):
    """A curve in the plane, parametrised by its arc length ``s`` in metres, from 0 to ``length``."""

    @property
    def length(self) -> float:
        """The arc length of the whole curve in metres."""
        ...

    def at(self, s: ArrayLike) -> Array:
        """Returns points of shape ``(..., 2)`` in metres at stations ``s`` of shape ``(...)``."""
        ...

    def heading(self, s: ArrayLike) -> Array:
        """Returns headings in radians at stations ``s``, counter-clockwise from +x. Headings are continuous
        along the curve, so they may exceed pi."""
        ...

    def curvature(self, s: ArrayLike) -> Array:
        """Returns curvatures in 1/m at stations ``s``, positive to the left."""
        ...


class ElevationProfile(Protocol):
    """The height of a road in metres as a function of ``s``, the arc length of its plane curve in metres."""

    def height(self, s: ArrayLike) -> Array:
        """Returns heights in metres at stations ``s``."""
        ...

    def grade(self, s: ArrayLike) -> Array:
        """Returns grades dz/ds at stations ``s`` as ratios: a grade of 0.05 climbs 5 m in 100 m."""
        ...

    def vertical_curvature(self, s: ArrayLike) -> Array:
        """Returns the change of grade d2z/ds2 in 1/m at stations ``s``; it is negative on a crest."""
        ...


def placed(s: ArrayLike, starts: Array) -> tuple[Array, NDArray[np.intp]]:
    """Returns, for each station, the distance from the start of its interval, and that interval's index.
    ``starts`` are the stations at which the intervals begin. The first interval is extended backwards and the
    last one forwards."""
    s = np.asarray(s, float)
    index = np.maximum(starts.searchsorted(s, side="right") - 1, 0)
    return s - starts[index], index


def before(steps: Array) -> Array:
    """Returns, for each step, the sum of the steps before it along the last axis."""
    sums = np.zeros(steps.shape)
    steps[..., :-1].cumsum(axis=-1, out=sums[..., 1:])
    return sums


def wrap_angle(angle: ArrayLike) -> Array:
    """Returns angles in radians, wrapped to (-pi, pi], as an array of the same shape."""
    return np.asarray(wrapped(np.asarray(angle, float)))


def wrapped(angle: Number) -> Number:
    """Returns an angle in radians, wrapped to (-pi, pi]; a number stays a number, which is faster."""
    return np.pi - (np.pi - angle) % (2 * np.pi)
