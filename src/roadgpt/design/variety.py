"""Never two alike: how far apart two roads are when one is shifted, turned and mirrored onto the other.

The plans are compared at equal stations, told in two ways: at equal shares of both lengths, and at equal
distances from the start as far as the shorter one goes. As complex numbers, the best turn of one centred line
onto another is the phase of their inner product, so a thousand earlier roads take one product of matrices.
"""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.road import Design, Road, build

POINTS = 80  # at equal shares of the length
STEP = 6.0  # m between points at equal distances
MOST = 60  # of those: 360 m
ENOUGH = 5.5  # m RMS: two roads further apart than this are not alike
REMEMBERED = 1000  # designs whose shape is kept at hand, besides those of the row: 18 kB each
FIRST_ROOM = 64  # designs for which there is room at first

Complex = NDArray[np.complex128]


class PlanShape(NamedTuple):
    """One plan or many: points as x + iy, and what is needed to compare them."""

    shares: Complex
    """At equal shares of the length, centred; ``(POINTS,)`` or ``(m, POINTS)``."""
    spread: Array
    """Metres, root mean square of their distances from their centre; ``()`` or ``(m,)``."""
    metres: Complex
    """Every ``STEP`` metres from the start; ``(MOST,)`` or ``(m, MOST)``, 0 beyond the end."""
    reach: NDArray[np.intp]
    """Number of points of ``metres`` that lie on the road."""
    centres: Complex
    """Mean of the first 1, 2, ... points of ``metres``."""
    spreads: Array
    """Of the first 1, 2, ... of ``metres``: root mean square of their distances from that."""


def shape_of(s: Array, line: Complex) -> PlanShape:
    """Returns the shape of a line ``x + iy`` that was sampled at stations ``s`` (metres, from 0)."""
    shares = _at(s, line, np.linspace(0.0, float(s[-1]), POINTS))
    shares -= shares.mean()
    reach = min(MOST, int(s[-1] / STEP) + 1)
    metres = np.zeros(MOST, complex)
    metres[:reach] = _at(s, line, STEP * np.arange(float(reach)))
    metres[:reach] -= metres[:reach].mean()  # small numbers lose few digits
    first = np.arange(1.0, MOST + 1)
    centres = np.cumsum(metres) / first
    squares = np.cumsum(np.abs(metres) ** 2) / first - np.abs(centres) ** 2
    spread = np.sqrt((np.abs(shares) ** 2).mean())
    return PlanShape(shares, spread, metres, np.array(reach), centres, np.sqrt(np.maximum(squares, 0.0)))


def _at(s: Array, line: Complex, stations: Array) -> Complex:
    x, y = np.interp(stations, s, line.real), np.interp(stations, s, line.imag)
    return np.asarray(x + 1j * y, complex)


def nearest(shape: PlanShape, others: PlanShape, by_metres: bool) -> float:
    """Returns the distance in metres to the nearest of other shapes; infinite where none is similar.

    Two lines are at least as far apart as their spreads, so most need not be laid onto each other.

    Args:
        shape: of one road.
        others: of many.
        by_metres: count those as well that are alike only as far as the shorter one goes.
    """
    near = np.flatnonzero(np.abs(others.spread - shape.spread) < ENOUGH)
    some = others._replace(shares=others.shares[near], spread=others.spread[near])
    least = float(apart(shape, some).min(initial=inf))
    if by_metres and least >= ENOUGH and len(others.reach):
        near = np.flatnonzero(_at_least_by_metres(shape, others) < ENOUGH)
        some = others._replace(
            metres=others.metres[near],
            reach=others.reach[near],
            centres=others.centres[near],
            spreads=others.spreads[near],
        )
        least = float(apart_by_metres(shape, some).min(initial=inf))
    return least if least < ENOUGH else inf


def _at_least_by_metres(shape: PlanShape, others: PlanShape) -> Array:
    """A lower bound of the distances at equal distances: from all that both have, and from its first half."""
    n, row = np.minimum(shape.reach, others.reach), np.arange(len(others.reach))
    half = (n + 1) // 2
    whole = np.abs(others.spreads[row, n - 1] - shape.spreads[n - 1])
    start = np.abs(others.spreads[row, half - 1] - shape.spreads[half - 1]) * np.sqrt(half / n)
    return np.asarray(np.maximum(whole, start))


def apart(shape: PlanShape, others: PlanShape) -> Array:
    """Returns RMS distances in metres ``(m,)`` at equal shares, after the best shift, turn and mirror."""
    own, many = shape.shares, others.shares
    sizes = others.spread**2 + shape.spread**2
    # einsum, not @: sums in one order on every machine, and no threads for so small a product
    straight, mirrored = (np.abs(np.einsum("ij,j->i", many, other)) for other in (own.conj(), own))
    alike = np.maximum(straight, mirrored)
    return np.asarray(np.sqrt(np.maximum(sizes - 2 * alike / POINTS, 0.0)))


def apart_by_metres(shape: PlanShape, others: PlanShape) -> Array:
    """Returns the same distances at equal stations, as far as both roads go."""
    n, row = np.minimum(shape.reach, others.reach), np.arange(len(others.reach))
    own, centre = shape.centres[n - 1], others.centres[row, n - 1]
    sizes = shape.spreads[n - 1] ** 2 + others.spreads[row, n - 1] ** 2
    # both are 0 beyond their ends, so the sums go as far as the shorter one
    straight = np.abs(np.einsum("ij,j->i", others.metres, shape.metres.conj()) / n - centre * own.conj())
    mirrored = np.abs(np.einsum("ij,j->i", others.metres, shape.metres) / n - centre * own)
    return np.asarray(np.sqrt(np.maximum(sizes - 2 * np.maximum(straight, mirrored), 0.0)))


class Shapes:
    """Remembers the shapes of designs from draft to draft, as measured on their roads."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Design, PlanShape]] = {}
        self._row: list[Design] = []
        self._stack = _room_for(FIRST_ROOM)

    def of(self, designs: Sequence[Design]) -> PlanShape:
        """Returns the shapes of designs, stacked in order; a sequence that only grows is not stacked anew."""
        if len(self._known) > REMEMBERED + len(designs):
            own = {id(design) for design in designs}
            self._known = {key: known for key, known in self._known.items() if key in own}
        same = _alike(self._row, designs)
        if same < len(self._row) or len(designs) > len(
            self._stack.reach
        ):  # what was given out stays as it is
            before, self._stack = self._stack, _room_for(2 * max(len(designs), FIRST_ROOM))
            for new, old in zip(self._stack, before, strict=True):
                new[:same] = old[:same]
        for number in range(same, len(designs)):
            for rows, row in zip(self._stack, self._shape(designs[number]), strict=True):
                rows[number] = row
        self._row[same:] = designs[same:]
        return PlanShape._make(rows[: len(designs)] for rows in self._stack)

    def remember(self, design: Design, road: Road) -> None:
        """Stores the shape of the road that was built from a design."""
        samples = road.sample()
        self._known[id(design)] = (design, shape_of(samples.s, samples.x + 1j * samples.y))

    def _shape(self, design: Design) -> PlanShape:
        # by identity: hashing a whole design takes longer than all the rest, and the entry keeps it alive
        if id(design) not in self._known:
            self.remember(design, build(design))
        return self._known[id(design)][1]


def _room_for(designs: int) -> PlanShape:
    some = shape_of(np.array([0.0, 1.0]), np.array([0j, 1 + 0j]))
    return PlanShape._make(np.zeros((designs, *np.shape(column)), column.dtype) for column in some)


def _alike(one: Sequence[Design], other: Sequence[Design]) -> int:
    """How many of the first designs are the same ones."""
    pairs = enumerate(zip(one, other, strict=False))
    return next((at for at, (a, b) in pairs if a is not b), min(len(one), len(other)))
