"""Models the light of sun and sky; all colours are linear, without the gamma curve of the screen."""

import numpy as np

from roadgpt.geometry.curve import Array

SUN_X, SUN_Y, SUN_Z = -0.460, -0.600, 0.6545
"""A unit vector towards the sun, which stands at an elevation of 41 degrees in the south-west."""
SUN = np.array([SUN_X, SUN_Y, SUN_Z])
AMBIENT, DIRECT = 0.42, 0.80
"""Brightness of the light from the sky, and of the light from the sun, each on a surface that fully faces
it."""


def daylight(normals: Array) -> Array:
    """Returns the brightness ``(...)`` of surfaces with unit normals ``(..., 3)``; it is about 1 on level
    ground."""
    sky = AMBIENT * (0.72 + 0.28 * normals[..., 2])
    return np.asarray(sky + DIRECT * np.maximum(normals @ SUN, 0.0) + 0.06)


def level_light() -> float:
    """Returns the brightness of level ground."""
    return float(daylight(np.array([0.0, 0.0, 1.0])))
