"""Computes geographic coordinates of places on the map, for formats that require them.

The projection is that of OpenDRIVE files: transverse Mercator on WGS 84, x to the east; inverse series after
Snyder, Map Projections: A Working Manual (US Geological Survey Professional Paper 1395), pp. 60-64; accurate
to 0.1 mm within 10 km of the corner."""

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.export.exporters.opendrive import LATITUDE, LONGITUDE
from roadgpt.geometry.curve import Array

SEMI_MAJOR = 6_378_137.0  # m, WGS 84
FLATTENING = 1 / 298.257223563  # WGS 84
ROUNDS = 4  # Newton steps; each squares the error
_E2 = FLATTENING * (2 - FLATTENING)
_EP2 = _E2 / (1 - _E2)


def degrees(x: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
    """Returns longitudes and latitudes in degrees of points that are given in metres on the map."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    foot = _footpoint(y)
    sin, cos, tan = np.sin(foot), np.cos(foot), np.tan(foot)
    c, t = _EP2 * cos**2, tan**2
    across = SEMI_MAJOR / np.sqrt(1 - _E2 * sin**2)
    along = SEMI_MAJOR * (1 - _E2) / (1 - _E2 * sin**2) ** 1.5
    d = x / across
    latitude = foot - (across * tan / along) * (
        d**2 / 2 - (5 + 3 * t + 10 * c - 4 * c**2 - 9 * _EP2) * d**4 / 24
    )
    longitude = (
        d - (1 + 2 * t + c) * d**3 / 6 + (5 - 2 * c + 28 * t - 3 * c**2 + 8 * _EP2 + 24 * t**2) * d**5 / 120
    ) / cos
    return LONGITUDE + np.degrees(longitude), np.asarray(np.degrees(latitude), float)


def _meridian(latitude: Array) -> Array:
    e4, e6 = _E2**2, _E2**3
    return np.asarray(
        SEMI_MAJOR
        * (
            (1 - _E2 / 4 - 3 * e4 / 64 - 5 * e6 / 256) * latitude
            - (3 * _E2 / 8 + 3 * e4 / 32 + 45 * e6 / 1024) * np.sin(2 * latitude)
            + (15 * e4 / 256 + 45 * e6 / 1024) * np.sin(4 * latitude)
            - (35 * e6 / 3072) * np.sin(6 * latitude)
        )
    )


def _footpoint(y: Array) -> Array:
    start = np.radians(LATITUDE)
    foot = start + y / SEMI_MAJOR
    for _ in range(ROUNDS):
        along = SEMI_MAJOR * (1 - _E2) / (1 - _E2 * np.sin(foot) ** 2) ** 1.5
        foot = foot + (y - (_meridian(foot) - _meridian(start))) / along
    return np.asarray(foot)
