"""Approximates a smooth function of ``s`` by cubics, within a tolerance."""

from collections.abc import Callable

import numpy as np

from roadgpt.geometry.curve import Array

SHORTEST = 0.02  # m; the shortest cubic, at a cusp of a spline
BETWEEN = (0.25, 0.5, 0.75)  # where a cubic is compared with the function

Function = Callable[[Array], Array]
"""A function that returns values ``(n, d)`` at stations ``(n,)``."""


def cubics(value: Function, slope: Function, breaks: Array, tolerance: float) -> tuple[Array, Array]:
    """Returns stations ``(n + 1,)`` and the coefficients ``(n, 4, d)`` of the cubics between them.

    The cubics have the values and slopes of the function at the stations.

    Args:
        value: The function to approximate, smooth between the breaks.
        slope: The derivative of ``value`` with respect to s.
        breaks: Increasing stations at which a cubic must begin or end, including both ends of the range.
        tolerance: Greatest distance between cubic and function, in the unit of the values.
    """
    stations = np.asarray(breaks, float)
    while True:
        found = _between(stations, value(stations), slope(stations))
        lengths = np.diff(stations)
        far = np.zeros(len(lengths), bool)
        for share in BETWEEN:
            away = value(stations[:-1] + share * lengths) - at(found, share * lengths)
            far |= np.sqrt((away**2).sum(axis=-1)) > tolerance
        far &= lengths > SHORTEST
        if not far.any():
            return stations, found
        middles = (stations[:-1] + lengths / 2)[far]
        stations = np.sort(np.r_[stations, middles])


def at(coefficients: Array, u: Array) -> Array:
    """Evaluates cubics ``(n, 4, d)`` to values ``(n, d)``: cubic i at distance ``u[i]`` from its start."""
    a, b, c, d = (coefficients[:, i] for i in range(4))
    u = u[:, None]
    return np.asarray(a + u * (b + u * (c + u * d)))


def _between(stations: Array, values: Array, slopes: Array) -> Array:
    """Returns the cubics that have these values and slopes at the stations (Hermite interpolation)."""
    length = np.diff(stations)[:, None]
    rise = np.diff(values, axis=0) / length
    c = (3 * rise - 2 * slopes[:-1] - slopes[1:]) / length
    d = (slopes[:-1] + slopes[1:] - 2 * rise) / length**2
    return np.stack([values[:-1], slopes[:-1], c, d], axis=1)
