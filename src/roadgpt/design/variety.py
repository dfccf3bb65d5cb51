"""Measures how much two roads differ, so that no two roads of a campaign are alike.

The distance between two roads is the root mean square distance between their points after one road is
shifted, rotated and, if that helps, mirrored to bring them as close as possible. Points are compared in two
ways: at equal fractions of both lengths, and at equal distances from the start as far as the shorter road
goes. With points as complex numbers, the best rotation is the phase of an inner product, so one matrix
product compares a road with a thousand others."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex
from roadgpt.road import Design, Road, build

POINTS = 80  # at equal shares of the length
STEP = 6.0  # m between points at equal distances
MOST = 60  # points at equal distances: 360 m
ENOUGH = 5.5  # m RMS: two roads with a smaller distance are alike
REMEMBERED = 1000  # designs whose shape is kept besides those asked for: 18 kB each
FIRST_ROOM = 64  # designs for which memory is reserved at first


class PlanShape(NamedTuple):
    """The shape of one plan, or of ``m`` stacked plans: points as x + iy, and values that speed up
    comparisons."""

    shares: Complex
    """Points at equal fractions of the length, relative to their mean; ``(POINTS,)`` or ``(m, POINTS)``."""
    spread: Array
    """Root mean square of the distances in metres of ``shares`` from their mean; ``()`` or ``(m,)``."""
    metres: Complex
    """Points every ``STEP`` metres from the start, 0 beyond the end; ``(MOST,)`` or ``(m, MOST)``."""
    reach: NDArray[np.intp]  # number of points of ``metres`` that lie on the road
    centres: Complex
    """Means of the first 1, 2, ... points of ``metres``; ``(MOST,)`` or ``(m, MOST)``."""
    spreads: Array
    """Root mean squares of the distances in metres of the first 1, 2, ... points from their mean."""


def shape_of(s: Array, line: Complex) -> PlanShape:
    """Returns the shape of a plan from its points ``line``, x + iy at stations ``s`` in metres, ``(n,)``."""
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
    """Returns the distance in metres to the nearest of other shapes; infinite if it is 5.5 m or more. Shapes
    are compared at equal fractions of their lengths. If none is nearer than 5.5 m and ``by_metres`` is True,
    they are also compared at equal distances from the start, up to the end of the shorter road."""
    least = float(apart(shape, others).min(initial=inf))
    if by_metres and least >= ENOUGH:
        least = float(apart_by_metres(shape, others).min(initial=inf))
    return least if least < ENOUGH else inf


def apart(shape: PlanShape, others: PlanShape) -> Array:
    """Returns the RMS distances in metres to other roads at equal fractions of the length, ``(m,)``."""
    own, many = shape.shares, others.shares
    sizes = others.spread**2 + shape.spread**2
    # einsum, not @: sums in one order on every machine, and no threads for so small a product
    straight, mirrored = (np.abs(np.einsum("ij,j->i", many, other)) for other in (own.conj(), own))
    alike = np.maximum(straight, mirrored)
    return np.asarray(np.sqrt(np.maximum(sizes - 2 * alike / POINTS, 0.0)))


def apart_by_metres(shape: PlanShape, others: PlanShape) -> Array:
    """Returns the RMS distances in metres to other roads at equal distances from the start, ``(m,)``, up to
    the end of the shorter road."""
    n, row = np.minimum(shape.reach, others.reach), np.arange(len(others.reach))
    own, centre = shape.centres[n - 1], others.centres[row, n - 1]
    sizes = shape.spreads[n - 1] ** 2 + others.spreads[row, n - 1] ** 2
    # both are 0 beyond their ends, so the sums go as far as the shorter one
    straight = np.abs(np.einsum("ij,j->i", others.metres, shape.metres.conj()) / n - centre * own.conj())
    mirrored = np.abs(np.einsum("ij,j->i", others.metres, shape.metres) / n - centre * own)
    return np.asarray(np.sqrt(np.maximum(sizes - 2 * np.maximum(straight, mirrored), 0.0)))


class Shapes:
    """Caches the shape of each design's road, so that each road is built and sampled only once."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Design, PlanShape]] = {}
        self._row: list[Design] = []
        self._stack = _room_for(FIRST_ROOM)

    def of(self, designs: Sequence[Design]) -> PlanShape:
        """Returns the shapes of designs, stacked in order. If designs were only appended since the last call,
        only the new ones are stacked."""
        if len(self._known) > REMEMBERED + len(designs):
            own = {id(design) for design in designs}
            self._known = {key: known for key, known in self._known.items() if key in own}
        same = _alike(self._row, designs)
        # arrays that were returned before must not change
        if same < len(self._row) or len(designs) > len(self._stack.reach):
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
    def rows(length: int) -> Complex:
        return np.zeros((designs, length), complex)

    numbers, reach = np.zeros(designs), np.zeros(designs, np.intp)
    return PlanShape(rows(POINTS), numbers, rows(MOST), reach, rows(MOST), np.zeros((designs, MOST)))


def _alike(one: Sequence[Design], other: Sequence[Design]) -> int:
    """Returns the number of designs at the start of both sequences that are the same objects."""
    pairs = enumerate(zip(one, other, strict=False))
    return next((at for at, (a, b) in pairs if a is not b), min(len(one), len(other)))
