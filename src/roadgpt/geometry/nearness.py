"""Finds the places at which points, or other parts of the same line, come near to a line in the plane."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.geometry.curve import Array, PlanCurve

Complex = NDArray[np.complex128]
Indices = NDArray[np.intp]
BLOCK = 128  # points that are compared at once
STEP = 1.0  # m between the stations that the search starts from
ROUNDS = 8  # Newton steps; each squares the error


def meeting(
    z: Complex, s: Array, earlier: Complex, earlier_s: Array, apart: float, neighbours: float
) -> tuple[Indices, Indices]:
    """Returns pairs of points that are closer than ``apart`` metres, as two arrays of indices: of the points
    in ``z``, on a line, and of the points in ``earlier``, on an earlier part of the line.

    Points are x + iy in metres, ``(n,)`` and ``(m,)``, each with its station in metres; ``earlier`` may be
    ``z``, to compare a line with itself. A pair counts only if the point in ``z`` is more than ``neighbours``
    metres farther along the line. Both arrays returned have the shape ``(number of pairs,)``."""
    blocks = [
        _near_block(z[first : first + BLOCK], s[first : first + BLOCK], earlier, earlier_s, apart, neighbours)
        for first in range(0, len(z), BLOCK)
    ]
    of_z = [at + number * BLOCK for number, (at, _) in enumerate(blocks)]
    return np.concatenate(of_z), np.concatenate([at for _, at in blocks])


def _near_block(
    z: Complex, s: Array, earlier: Complex, earlier_s: Array, apart: float, neighbours: float
) -> tuple[Indices, Indices]:
    """Compares a few successive points with the earlier points in the rectangle around them."""
    x, y = earlier.real, earlier.imag
    near_x = (x > z.real.min() - apart) & (x < z.real.max() + apart)
    here = np.flatnonzero(near_x & (y > z.imag.min() - apart) & (y < z.imag.max() + apart))
    dx, dy = z.real[:, None] - x[here], z.imag[:, None] - y[here]
    near = dx * dx + dy * dy < apart * apart
    of_z, of_earlier = np.nonzero(near & (s[:, None] - earlier_s[here] > neighbours))
    return of_z, here[of_earlier]


def project(curve: PlanCurve, points: ArrayLike) -> tuple[Array, Array]:
    """Returns the stations ``s`` and offsets ``t`` (positive to the left) in metres of points ``(..., 2)``. A
    point beyond an end of the curve is projected onto that end. Its offset is then measured perpendicular to
    the curve; the distance beyond the end is ignored."""
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
