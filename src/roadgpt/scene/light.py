"""Models the light of sun and sky, and defines the colours of surfaces without a pattern, such as the car and
concrete. All colours are linear, without the gamma curve of the screen."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.scene.mesh import PLAIN

STEPS = 4096  # of the table of screen bytes
SUN_X, SUN_Y, SUN_Z = -0.460, -0.600, 0.6545
"""A unit vector towards the sun, which stands at an elevation of 41 degrees in the south-west."""
SUN = np.array([SUN_X, SUN_Y, SUN_Z])
AMBIENT, DIRECT = 0.42, 0.80
"""Brightness of the light from the sky, and of the light from the sun, each on a surface that fully faces
it."""
CONCRETE, PAINT, GLASS, TRIM, TYRE, RIM, GAP, TAIL, HEAD, PLATE, HIGH = range(PLAIN, PLAIN + 11)
WHITE, RED, YELLOW, GREEN, BLACK, DIM_RED, DIM_YELLOW, WATER = range(PLAIN + 11, PLAIN + 19)
_COLOURS = {
    CONCRETE: (158, 154, 148),
    PAINT: (36, 92, 165),
    GLASS: (30, 37, 44),
    TRIM: (34, 36, 40),
    TYRE: (38, 39, 41),
    RIM: (176, 180, 186),
    GAP: (28, 29, 31),
    TAIL: (128, 14, 16),
    HEAD: (224, 228, 232),
    PLATE: (232, 232, 226),
    HIGH: (70, 12, 14),
    WHITE: (230, 230, 226),
    RED: (190, 22, 30),
    YELLOW: (240, 186, 20),
    GREEN: (30, 150, 70),
    BLACK: (36, 38, 40),
    DIM_RED: (74, 22, 24),
    DIM_YELLOW: (82, 66, 22),
    WATER: (74, 108, 128),
}
_LIT = {GREEN: (0.02, 0.5, 0.16)}  # the light that a traffic light shows
GLOSS = {PAINT: 1.0, GLASS: 1.0, TAIL: 0.6, HEAD: 0.9, RIM: 0.5, TRIM: 0.15}
BRAKE = 0.03  # share of the pedal travel above which the brake lights are on
SHINING = {TAIL - PLAIN: (0.85, 0.035, 0.02), HIGH - PLAIN: (0.95, 0.05, 0.03)}


def daylight(normals: Array) -> Array:
    """Returns the brightness ``(...)`` of surfaces with unit normals ``(..., 3)``; it is about 1 on level
    ground."""
    sky = AMBIENT * (0.72 + 0.28 * normals[..., 2])
    return np.asarray(sky + DIRECT * np.maximum(normals @ SUN, 0.0) + 0.06)


def level_light() -> float:
    """Returns the brightness of level ground."""
    return float(daylight(np.array([0.0, 0.0, 1.0])))


@cache
def screen_table() -> NDArray[np.uint8]:
    """Returns the table ``(STEPS,)`` of screen bytes for linear light from 0 to 1, using the sRGB curve (IEC
    61966-2-1)."""
    light = np.arange(STEPS) / (STEPS - 1)
    curve = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.round(255 * curve).astype(np.uint8)


def linear(*colour: int) -> tuple[float, float, float]:
    """Returns the linear light of an sRGB screen colour with channels from 0 to 255."""
    c = np.array(colour) / 255
    light = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return float(light[0]), float(light[1]), float(light[2])


PALETTE = np.array(
    [[*linear(*_COLOURS[kind]), *_LIT.get(kind, (0.0, 0.0, 0.0))] for kind in sorted(_COLOURS)]
)
"""Shape (n, 6), one row for each type from PLAIN on: three columns of linear colour, and three of emitted
light."""
