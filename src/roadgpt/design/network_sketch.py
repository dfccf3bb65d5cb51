"""Sketches a route with its junctions as lines, to see quickly whether its parts keep clear of each other.

A sketch holds points about 2 m apart. The network that is built from the chosen draft is exact, and every
rule checks it again.
"""

import cmath
from collections.abc import Sequence
from math import pi, radians
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.design.layout import PlanLine
from roadgpt.network import JunctionDesign
from roadgpt.network.design import STUB
from roadgpt.network.growing import contact_distances
from roadgpt.network.ring import ring_width

Complex = NDArray[np.complex128]
STEP = 2.0  # m between points
MARGIN = 1.5  # m between the shoulders of roads that do not meet
POINTS = 24  # around a roundabout
AWAY = 12.0  # m from a contact, outwards, within which the arms of one junction may be near each other


class NetworkSketch(NamedTuple):
    """The parts of a route: points as x + iy in metres, from a start at the origin that heads along +x."""

    z: Complex
    """All points, ``(n,)``."""
    part: NDArray[np.intp]
    """The number of the road or junction to which each point belongs, ``(n,)``."""
    near: NDArray[np.bool_]
    """Shape (parts, parts): whether two parts meet, so that they may be near each other."""
    nodes: tuple[tuple[complex, float], ...]
    """The node of each junction, and the distance from it within which its arms may be near each other."""


def sketched(lines: Sequence[PlanLine], junctions: Sequence[JunctionDesign], width: float) -> NetworkSketch:
    """Returns the sketch of a route.

    Args:
        lines: the roads before, between and after the junctions.
        junctions: the junctions.
        width: width in metres of each lane.
    """
    pen = _Pen(lines[0], width)
    for junction, line in zip(junctions, lines[1:], strict=True):
        pen.pass_junction(junction, line)
    near = np.eye(len(pen.parts), dtype=bool)
    for a, b in pen.pairs:
        near[a, b] = True
    numbers = np.repeat(np.arange(len(pen.parts)), [len(z) for z in pen.parts])
    return NetworkSketch(np.concatenate(pen.parts), numbers, near, tuple(pen.nodes))


class _Pen:
    """Draws the parts of a sketch one after another, in driving order."""

    def __init__(self, line: PlanLine, width: float) -> None:
        self.parts: list[Complex] = [_thinned(line.z)]
        self.pairs: list[tuple[int, int]] = []
        self.nodes: list[tuple[complex, float]] = []
        self._width = width
        self._arrival, self._end, self._way = 0, complex(line.z[-1]), _way(line.z)

    def pass_junction(self, junction: JunctionDesign, line: PlanLine) -> None:
        """Draws a junction, its arms, and the road on which the route goes on."""
        directions = [pi, *(radians(arm.angle) for arm in junction.all_arms)]
        far, way = contact_distances(junction, directions, self._width), self._way
        node = self._end + way * far[0]
        self.nodes.append((node, max(far) + AWAY))
        here = [self._arrival]
        if junction.kind == "roundabout":
            around = np.exp(1j * np.linspace(0, 2 * pi, POINTS, endpoint=False))
            here.append(self._drawn(node + (junction.radius + ring_width(junction.radius) / 2) * around))
        for n, arm in enumerate(junction.all_arms):
            out = way * cmath.exp(1j * radians(arm.angle))
            start = node + out * far[n + 1]
            if n == junction.taken:
                self._arrival = self._drawn(start + out * _thinned(line.z))
                self._end, self._way = start + out * complex(line.z[-1]), out * _way(line.z)
                here.append(self._arrival)
            else:
                here.append(self._drawn(start + out * np.arange(0.0, arm.length or STUB, STEP)))
        self.pairs += [(a, b) for a in here for b in here]

    def _drawn(self, z: NDArray[Any]) -> int:
        self.parts.append(z)
        return len(self.parts) - 1


def _thinned(z: Complex) -> Complex:
    return np.append(z[: -1 : int(STEP)], z[-1])


def _way(z: Complex) -> complex:
    """Returns the direction of a line at its end, as a complex number of length 1."""
    step = complex(z[-1] - z[-2])
    return step / abs(step)


def is_clear(sketch: NetworkSketch, width: float, shoulder: float) -> bool:
    """Returns whether roads and junctions that do not meet keep their distance.

    Args:
        sketch: the sketch.
        width: width in metres of each lane.
        shoulder: width in metres of each shoulder.
    """
    apart = 2 * width + 2 * shoulder + MARGIN
    z, part = sketch.z, sketch.part
    of, others = np.nonzero(np.triu(np.abs(z[:, None] - z) < apart, 1))
    other_parts = part[of] != part[others]
    of, others = of[other_parts], others[other_parts]
    meet = sketch.near[part[of], part[others]]
    if not meet.all():
        return False
    for node, reach in sketch.nodes:
        inside = (np.abs(z[of] - node) < reach) & (np.abs(z[others] - node) < reach)
        of, others = of[~inside], others[~inside]
    return not len(of)
