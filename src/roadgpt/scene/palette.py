"""Defines the colours of surfaces without a pattern, such as the car and concrete. The numbers of these
surface types start at PLAIN."""

import numpy as np

from roadgpt.scene.mesh import PLAIN
from roadgpt.scene.textures import linear

CONCRETE, PAINT, GLASS, TRIM, TYRE, RIM, GAP, TAIL, HEAD, PLATE, HIGH = range(PLAIN, PLAIN + 11)
WHITE, RED, YELLOW, GREEN, BLACK, DIM_RED, DIM_YELLOW = range(PLAIN + 11, PLAIN + 18)

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
}
_LIT = {GREEN: (0.02, 0.5, 0.16)}  # the light that a traffic light shows
PALETTE = np.array(
    [[*linear(*_COLOURS[kind]), *_LIT.get(kind, (0.0, 0.0, 0.0))] for kind in sorted(_COLOURS)]
)
"""Shape (n, 6), one row for each type from PLAIN on: three columns of linear colour, and three of emitted
light."""
GLOSS = {PAINT: 1.0, GLASS: 1.0, TAIL: 0.6, HEAD: 0.9, RIM: 0.5, TRIM: 0.15}
BRAKE = 0.03  # share of the pedal travel above which the brake lights are on
SHINING = {TAIL - PLAIN: (0.85, 0.035, 0.02), HIGH - PLAIN: (0.95, 0.05, 0.03)}
