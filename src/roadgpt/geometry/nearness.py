"""Finds the points at which a line in the plane comes near to itself. Main function: ``meeting``."""

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array

Complex = NDArray[np.complex128]
Indices = NDArray[np.intp]
BLOCK = 128  # points that are compared at once


def meeting(
    z: Complex, s: Array, earlier: Complex, earlier_s: Array, apart: float, neighbours: float
) -> tuple[Indices, Indices]:
    """Returns pairs of points that are closer than ``apart`` metres, as two arrays of indices: of the points
    in ``z``, on a line, and of the points in ``earlier``, on an earlier part of the line.

    Points are x + iy in metres, ``(n,)`` and ``(m,)``, each with its station in metres; ``earlier`` may be
    ``z``, to compare a line with itself. A pair counts only if the point in ``z`` is more than ``neighbours``
    metres farther along the line. Both arrays returned have the shape ``(number of pairs,)``.
    """
    blocks = [
        _near_block(z[first : first + BLOCK], s[first : first + BLOCK], earlier, earlier_s, apart, neighbours)
        for first in range(0, len(z), BLOCK)
    ]
    of_z = [at + number * BLOCK for number, (at, _) in enumerate(blocks)]
    return np.concatenate(of_z), np.concatenate([at for _, at in blocks])


def _near_block(
    z: Complex, s: Array, earlier: Complex, earlier_s: Array, apart: float, neighbours: float
) -> tuple[Indices, Indices]:
    """Returns the pairs as ``meeting`` does, for a few points that follow each other: only earlier points in
    the rectangle around them are compared with them.
    """
    x, y = earlier.real, earlier.imag
    near_x = (x > z.real.min() - apart) & (x < z.real.max() + apart)
    here = np.flatnonzero(near_x & (y > z.imag.min() - apart) & (y < z.imag.max() + apart))
    dx, dy = z.real[:, None] - x[here], z.imag[:, None] - y[here]
    near = dx * dx + dy * dy < apart * apart
    of_z, of_earlier = np.nonzero(near & (s[:, None] - earlier_s[here] > neighbours))
    return of_z, here[of_earlier]
