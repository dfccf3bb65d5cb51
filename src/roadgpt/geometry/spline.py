"""Reproduces the cubic spline with which the RoadGPT thesis and the SBFT tool competition build roads.

``interpolate`` returns exactly the competition's points, including its quirks. ``SplineCurve`` is the same
curve, parametrised by arc length. Source: the competition's ``road_points`` interpolation
(scipy.interpolate.splprep without smoothing)."""

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
import scipy
from numpy.typing import ArrayLike

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array

MIN_NODES = 20  # least number of intervals between interpolated points, however short the road
DECIMALS = 3  # the competition rounds interpolated points to millimetres
STRAIGHT = 1e-6  # m^2: three nodes that span less (twice the triangle's area) lie on a line
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)
_NEWTON = 8  # Newton steps at most; two are enough where nodes are close together
_CLOSE = 1e-4  # m; a Newton step that starts with a smaller error is the last
_SPANS = 4  # quadrature spans per spline interval: arc length good to a micrometre

Tck = tuple[Array, list[Array], int]


def _spline(points: Array) -> tuple[Tck, Array]:
    if len(points) < 2:
        raise UsageError("a road needs two points or more; give at least two [x, y] pairs")
    degree = {2: 1, 3: 2}.get(len(points), 3)
    try:
        tck, u = scipy.interpolate.splprep(points.T, s=0, k=degree)
    except ValueError as error:
        raise UsageError("two neighbouring points of the road are the same; remove the duplicate") from error
    knots, coefficients, _ = cast(tuple[Array, list[Array], int], tck)
    return (knots, coefficients, degree), np.asarray(u)


def walked(points: Array) -> float:
    """Returns the length of a polyline through points ``(n, 2)``, summed as in the competition's library. A
    different order of summation could give 29.999... for a length of 30 m. Interpolation would then return
    one node fewer than the competition's code."""
    return float(np.cumsum(np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1)))[-1])


def interpolate(points: ArrayLike, fewest: int = MIN_NODES, decimals: int = DECIMALS) -> Array:
    """Returns the competition's interpolated points, about one per metre, rounded to millimetres.

    Args:
        points: Control points ``(n, 2)`` or ``(n, 3)`` in metres, n >= 2.
        fewest: The minimum number of intervals between interpolated points; it takes effect on roads that
            are shorter than this number of metres.
        decimals: The number of decimals to round to.

    Returns:
        Points of shape ``(m, 2)`` or ``(m, 3)``. For some lengths the last point lies beyond the last control
        point, as in the competition's code, because ``arange`` overshoots by a rounding error.

    Raises:
        UsageError: There are fewer than two points, or two successive points are the same."""
    points = np.asarray(points, float)
    tck, _ = _spline(points)
    count = max(fewest, int(walked(points[:, :2])))
    u = np.arange(0, 1 + 1 / count, 1 / count)
    return np.asarray(np.round(np.stack(scipy.interpolate.splev(u, tck), axis=-1), decimals), float)


def radii(nodes: Array) -> Array:
    """Returns radii ``(n - 5,)`` in metres of the circles through nodes i, i+2, i+4 of ``(n, 2)``; infinite
    where the three nodes are collinear."""
    a, b, c = nodes[:-5], nodes[2:-3], nodes[4:-1]
    (ax, ay), (bx, by), (cx, cy) = a.T, b.T, c.T
    square = bx * bx + by * by
    p, q = (ax * ax + ay * ay - square) / 2, (square - cx * cx - cy * cy) / 2
    area = (ax - bx) * (by - cy) - (bx - cx) * (ay - by)
    bends = np.abs(area) >= STRAIGHT
    area = np.where(bends, area, 1.0)
    x = (p * (by - cy) - q * (ay - by)) / area
    y = ((ax - bx) * q - (bx - cx) * p) / area
    return np.where(bends, np.sqrt((x - ax) ** 2 + (y - ay) ** 2), np.inf)


@dataclass(frozen=True, eq=False)
class SplineCurve:
    """The plan view of a cubic spline, parametrised by arc length in plan. The control points may have
    heights."""

    tck: Tck
    knots: Array
    """The value of the spline parameter at each control point."""

    @classmethod
    def through(cls, points: ArrayLike) -> "SplineCurve":
        """Returns the curve through control points ``(n, 2)`` or ``(n, 3)`` in metres."""
        tck, knots = _spline(np.asarray(points, float))
        return cls(tck, knots)

    @cached_property
    def _arc(self) -> tuple[Array, Array]:
        """Returns values of the spline parameter and the arc length in metres up to each, by Gauss-Legendre
        quadrature."""
        u = np.unique(np.linspace(self.knots[:-1], self.knots[1:], _SPANS + 1).ravel())
        half = np.diff(u)[:, None] / 2
        inner = u[:-1, None] + half * (_NODES + 1)
        speed = np.hypot(*self._derivative(inner.ravel(), 1)[:2]).reshape(inner.shape)
        return u, np.r_[0.0, np.cumsum(half[:, 0] * (speed @ _WEIGHTS))]

    def _derivative(self, u: Array, order: int) -> Array:
        return np.array(scipy.interpolate.splev(u, self.tck, der=order))

    @property
    def length(self) -> float:
        """The arc length in plan in metres."""
        return float(self._arc[1][-1])

    @cached_property
    def stations(self) -> Array:
        """The arc length at each control point in metres, of shape ``(n,)``."""
        return self._reached(self.knots)

    def parameter(self, s: ArrayLike) -> Array:
        """Returns the parameter values of the spline at stations ``s``."""
        s = np.asarray(s, float)
        table_u, table_s = self._arc
        u = np.interp(s, table_s, table_u)
        for number in range(_NEWTON):
            missed = s - self._reached(u)
            u = np.asarray(np.clip(u + missed / self._speed(u), 0.0, 1.0))
            if number and np.abs(missed).max(initial=0.0) < _CLOSE:  # each step squares the error
                break
        return np.asarray(u, float)

    def _speed(self, u: Array) -> Array:
        flat = np.hypot(*self._derivative(np.ravel(u), 1)[:2])
        return np.asarray(np.maximum(flat, 1e-9)).reshape(np.shape(u))

    def _reached(self, u: Array) -> Array:
        """Returns the arc length at parameters ``u``: from the table, then by quadrature in the last span."""
        table_u, table_s = self._arc
        i = np.clip(np.searchsorted(table_u, u, side="right") - 1, 0, len(table_u) - 2)
        half = np.asarray((u - table_u[i]) / 2)[..., None]
        inner = table_u[i][..., None] + half * (_NODES + 1)
        return np.asarray(table_s[i] + half[..., 0] * (self._speed(inner) @ _WEIGHTS))

    def at(self, s: ArrayLike) -> Array:
        """Returns points of shape ``(..., 2)`` in metres."""
        return np.asarray(np.stack(scipy.interpolate.splev(self.parameter(s), self.tck)[:2], axis=-1), float)

    def heading(self, s: ArrayLike) -> Array:
        """Returns headings in radians, without jumps of 2 pi between successive stations."""
        dx, dy = self._derivative(self.parameter(s), 1)[:2]
        angle = np.arctan2(dy, dx)
        return np.asarray(np.unwrap(angle) if angle.ndim else angle)

    def curvature(self, s: ArrayLike) -> Array:
        """Returns curvatures in 1/m, positive to the left."""
        u = self.parameter(s)
        dx, dy = self._derivative(u, 1)[:2]
        ddx, ddy = self._derivative(u, 2)[:2] if self.tck[2] > 1 else (np.zeros_like(dx), np.zeros_like(dy))
        return np.asarray((dx * ddy - dy * ddx) / np.maximum(np.hypot(dx, dy), 1e-9) ** 3)


@dataclass(frozen=True, eq=False)
class SplineProfile:
    """The heights of a 3-D spline as a function of arc length in plan."""

    curve: SplineCurve

    def height(self, s: ArrayLike) -> Array:
        """Returns heights in metres."""
        return np.asarray(scipy.interpolate.splev(self.curve.parameter(s), self.curve.tck)[2])

    def grade(self, s: ArrayLike) -> Array:
        """Returns grades as ratios."""
        dx, dy, dz = self.curve._derivative(self.curve.parameter(s), 1)
        return np.asarray(dz / np.maximum(np.hypot(dx, dy), 1e-9))

    def vertical_curvature(self, s: ArrayLike) -> Array:
        """Returns the change of grade in 1/m, negative on a crest."""
        u = self.curve.parameter(s)
        dx, dy, dz = self.curve._derivative(u, 1)
        if self.curve.tck[2] == 1:
            return np.zeros_like(dx)
        ddx, ddy, ddz = self.curve._derivative(u, 2)
        run = np.maximum(np.hypot(dx, dy), 1e-9)
        return np.asarray((ddz - dz * (dx * ddx + dy * ddy) / run**2) / run**2)
