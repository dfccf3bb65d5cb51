"""The sun and the sky over every road; all colours are linear, before a screen's gamma."""

import numpy as np

from roadgpt.geometry.curve import Array

SUN_X, SUN_Y, SUN_Z = -0.460, -0.600, 0.6545
"""A unit vector towards the sun, which stands 41 degrees high in the south-west."""
SUN = np.array([SUN_X, SUN_Y, SUN_Z])
AMBIENT, DIRECT = 0.42, 0.80
"""Shares of the light that come from the sky and from the sun."""


def daylight(normals: Array) -> Array:
    """How much light falls on surfaces with unit normals ``(..., 3)``; about 1 on level ground."""
    sky = AMBIENT * (0.72 + 0.28 * normals[..., 2])
    return np.asarray(sky + DIRECT * np.maximum(normals @ SUN, 0.0) + 0.06)


def level_light() -> float:
    """On level ground."""
    return float(daylight(np.array([0.0, 0.0, 1.0])))
