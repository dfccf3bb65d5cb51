"""Projects points onto a plane curve: finds the nearest station and the lateral offset of each point."""

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry.curve import Array, PlanCurve

STEP = 1.0  # m between the stations that the search starts from
ROUNDS = 8  # Newton steps; each squares the error


def project(curve: PlanCurve, points: ArrayLike) -> tuple[Array, Array]:
    """Returns the stations ``s`` and offsets ``t`` (positive to the left) in metres of points ``(..., 2)``.

    A point beyond an end of the curve is projected onto that end. Its offset is then measured perpendicular
    to the curve; the distance beyond the end is ignored.
    """
    points = np.asarray(points, float)
    flat = points.reshape(-1, 2)
    s = _nearest(curve, flat)
    for _ in range(ROUNDS):
        along, across = _local(curve, s, flat)
        s = np.clip(s + along / np.maximum(1 - curve.curvature(s) * across, 0.05), 0.0, curve.length)
    _, across = _local(curve, s, flat)
    return s.reshape(points.shape[:-1]), across.reshape(points.shape[:-1])


def _nearest(curve: PlanCurve, flat: Array) -> Array:
    stations = np.linspace(0.0, curve.length, max(2, int(curve.length / STEP) + 1))
    on = curve.at(stations)
    best = np.empty(len(flat), int)
    for first in range(0, len(flat), 512):  # blocks keep the distance table small
        some = flat[first : first + 512]
        apart = (some[:, None, 0] - on[None, :, 0]) ** 2 + (some[:, None, 1] - on[None, :, 1]) ** 2
        best[first : first + 512] = np.argmin(apart, axis=1)
    return stations[best]


def _local(curve: PlanCurve, s: Array, flat: Array) -> tuple[Array, Array]:
    """Returns how far the points lie ahead of, and to the left of, the curve's frame at ``s``."""
    away = flat - curve.at(s)
    heading = curve.heading(s)
    cos, sin = np.cos(heading), np.sin(heading)
    return away[:, 0] * cos + away[:, 1] * sin, away[:, 1] * cos - away[:, 0] * sin
