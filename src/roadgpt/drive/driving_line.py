"""Computes driving lines: the centre line of the road, shifted sideways by a given offset at every station.

Drivers look up the line every 20 ms. The line is therefore computed once per road and stored as plain lists,
so that a lookup takes one index.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from roadgpt.road import Road

STEP = 0.5  # m between stations
BEYOND = 60.0  # m that the line runs straight on behind the road's end, for drivers that look ahead
LEAST_STRETCH = 0.2  # of a metre that a metre of road leaves to the line on the inside of a bend

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DrivingLine:
    """A driving line, as lists over equally spaced stations of the road; entry ``i`` belongs to station ``i *
    step``."""

    step: float
    """Metres of road between stations."""
    offset: list[float]
    """Metres to the left of the centre line."""
    x: list[float]
    y: list[float]
    heading: list[float]
    """Heading of the line in radians, continuous (not wrapped)."""
    curvature: list[float]
    """1/m, curvature of the line itself, positive to the left."""
    stretch: list[float]
    """Metres of line per metre of road."""
    grade: list[float]
    """Grade of the road as a ratio."""
    crest: list[float]
    """Vertical curvature of the road in 1/m, negative on a crest."""

    def place(self, s: float) -> tuple[int, float]:
        """Returns the index of the last listed station at or before ``s``, and the fraction of the step from
        that station to ``s``."""
        at = s / self.step
        last = len(self.x) - 2
        if at <= 0.0:
            return 0, 0.0
        i = int(at)
        return (i, at - i) if i <= last else (last, 1.0)


def stations(road: "Road") -> FloatArray:
    """Returns the stations of the road at which a line is computed, in metres, both ends included, shape
    ``(n,)``."""
    return np.linspace(0.0, road.length, max(2, math.ceil(road.length / STEP)) + 1)


def line_along(road: "Road", offset: ArrayLike) -> DrivingLine:
    """Returns the line at an offset to the left of the centre line; it continues straight beyond the road's
    end.

    Args:
        road: the road.
        offset: metres to the left; one number, or one number per station of ``stations(road)``.
    """
    s = stations(road)
    step = float(s[1])
    t = np.broadcast_to(np.asarray(offset, float), s.shape)
    turning = np.gradient(t, step)
    along = np.maximum(1 - road.curvature(s) * t, LEAST_STRETCH)
    stretch = np.hypot(along, turning)
    heading = np.unwrap(road.heading(s)) + np.arctan2(turning, along)
    curvature = np.gradient(heading, step) / stretch
    xy = road.at(s, t)[:, :2]
    more = math.ceil(BEYOND / step)
    far = step * np.arange(1, more + 1)[:, None] * [[np.cos(heading[-1]), np.sin(heading[-1])]]
    xy = np.concatenate([xy, xy[-1] + far])
    return DrivingLine(
        step,
        _longer(t, more, t[-1]),
        xy[:, 0].tolist(),
        xy[:, 1].tolist(),
        _longer(heading, more, heading[-1]),
        _longer(curvature, more, 0.0),
        _longer(stretch, more, 1.0),
        _longer(road.grade(s), more, float(road.grade(s[-1]))),
        _longer(road.vertical_curvature(s), more, 0.0),
    )


def _longer(values: FloatArray, more: int, last: float) -> list[float]:
    return [float(v) for v in values] + [float(last)] * more
