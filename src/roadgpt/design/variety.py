"""Never two alike: how far apart two roads are when one is shifted, turned and mirrored onto the other.

The plans are compared at equal stations, told in two ways: at equal shares of both lengths, and at equal
distances from the start as far as the shorter one goes. As complex numbers, the best turn of one centred line
onto another is the phase of their inner product, so a thousand earlier roads take one product of matrices.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.road import Design, build

POINTS = 80  # at equal shares of the length
STEP = 6.0  # m between points at equal distances
MOST = 60  # of those: 360 m
ENOUGH = 5.5  # m RMS: two roads further apart than this are not alike
REMEMBERED = 5000  # designs whose shape is kept at hand

Complex = NDArray[np.complex128]


class Shape(NamedTuple):
    """A plan, or many: points as x + iy."""

    shares: Complex
    """At equal shares of the length, centred; ``(POINTS,)`` or ``(m, POINTS)``."""
    metres: Complex
    """Every ``STEP`` metres from the start; ``(MOST,)`` or ``(m, MOST)``, 0 beyond the end."""
    reach: NDArray[np.intp]
    """How many of ``metres`` lie on the road."""


def shape_of(s: Array, line: Complex) -> Shape:
    """The shape of a line ``x + iy`` that was sampled at stations ``s`` (metres, from 0)."""
    shares = _at(s, line, np.linspace(0.0, float(s[-1]), POINTS))
    reach = min(MOST, int(s[-1] / STEP) + 1)
    metres = np.zeros(MOST, complex)
    metres[:reach] = _at(s, line, STEP * np.arange(float(reach)))
    return Shape(shares - shares.mean(), metres, np.array(reach))


def _at(s: Array, line: Complex, stations: Array) -> Complex:
    x, y = np.interp(stations, s, line.real), np.interp(stations, s, line.imag)
    return np.asarray(x + 1j * y, complex)


def apart(shape: Shape, others: Shape) -> Array:
    """RMS distances in metres ``(m,)`` at equal shares, after the best shift, turn and mirror."""
    own, many = shape.shares, others.shares
    sizes = (np.abs(many) ** 2).sum(axis=1) + float((np.abs(own) ** 2).sum())
    # einsum, not @: sums in one order on every machine, and no threads for so small a product
    straight, mirrored = (np.abs(np.einsum("ij,j->i", many, other)) for other in (own.conj(), own))
    alike = np.maximum(straight, mirrored)
    return np.asarray(np.sqrt(np.maximum(sizes - 2 * alike, 0.0) / POINTS))


def apart_by_metres(shape: Shape, others: Shape) -> Array:
    """The same at equal distances, as far as both roads go."""
    n = np.minimum(shape.reach, others.reach)
    # sums of products up to there, with the means taken out
    row, last = np.arange(len(n)), n - 1
    own, many = shape.metres, others.metres
    own_mean = np.cumsum(own)[last] / n
    mean = np.cumsum(many, axis=1)[row, last] / n

    def size(points: Complex, centre: Complex) -> Array:
        upto = np.cumsum(np.abs(points) ** 2, axis=-1)
        return np.asarray((upto[last] if points.ndim == 1 else upto[row, last]) - n * np.abs(centre) ** 2)

    straight = np.abs(np.cumsum(many * own.conj(), axis=1)[row, last] - n * mean * own_mean.conj())
    mirrored = np.abs(np.cumsum(many * own, axis=1)[row, last] - n * mean * own_mean)
    squares = size(own, own_mean) + size(many, mean) - 2 * np.maximum(straight, mirrored)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0) / n))


class Shapes:
    """Shapes of designs, remembered from draft to draft."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Design, Shape]] = {}

    def of(self, designs: Sequence[Design]) -> Shape:
        """Shapes of designs, in their order, stacked."""
        if len(self._known) > REMEMBERED + len(designs):
            self._known.clear()
        rows = [self._shape(design) for design in designs]
        if not rows:
            return Shape(np.empty((0, POINTS), complex), np.empty((0, MOST), complex), np.empty(0, int))
        shares, metres, reach = zip(*rows, strict=True)
        return Shape(np.array(shares), np.array(metres), np.array(reach))

    def remember(self, design: Design, shape: Shape) -> None:
        """Keeps the shape of a design that was just drafted."""
        self._known[id(design)] = (design, shape)

    def _shape(self, design: Design) -> Shape:
        # by identity: hashing a whole design takes longer than all the rest, and the entry keeps it alive
        known = self._known.get(id(design))
        if known is None:
            samples = build(design).sample()
            known = (design, shape_of(samples.s, samples.x + 1j * samples.y))
            self._known[id(design)] = known
        return known[1]
