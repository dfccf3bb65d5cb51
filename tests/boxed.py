"""Boxes of road users as shapely wants them, worked out without the code under test."""

from collections.abc import Sequence

import numpy as np


def corners(state: Sequence[float] | np.ndarray, size: Sequence[float]) -> np.ndarray:
    """The corners ``(4, 2)`` of a box whose middle and heading are those of a state x, y, z, heading."""
    x, y, _, heading = (float(each) for each in state[:4])
    turn, half = np.exp(1j * heading), complex(size[0] / 2, size[1] / 2)
    places = complex(x, y) + turn * np.array([-half, half.conjugate(), half, -half.conjugate()])
    return np.column_stack([places.real, places.imag])
