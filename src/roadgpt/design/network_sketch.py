"""Sketches a route with its junctions as lines, to see quickly whether its parts keep clear of each other.

A sketch holds points about 2 m apart. The network that is built from the chosen draft is exact, and every
rule checks it again."""

import cmath
from collections.abc import Sequence
from math import pi, radians
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.design.layout import PlanLine
from roadgpt.geometry.nearness import Complex, meeting
from roadgpt.network import JunctionDesign
from roadgpt.network.building import lines_at_ramp, ring_width
from roadgpt.network.design import STUB, PlaceDesign, RampDesign
from roadgpt.network.growing import contact_distances, profiles_of_arms
from roadgpt.road import Profile

STEP = 2.0  # m between points
MARGIN = 1.5  # m between the shoulders of roads that do not meet
POINTS = 24  # number of points around a roundabout
AWAY = 12.0  # m from a contact, outwards, within which the arms of one junction may be near each other


class NetworkSketch(NamedTuple):
    """The parts of a route as points; the route starts at the origin and heads along +x."""

    z: Complex  # the points of all parts, x + iy in metres, ``(n,)``
    part: NDArray[np.intp]  # the number of the road or junction to which each point belongs, ``(n,)``
    near: NDArray[np.bool_]
    """Shape (parts, parts): whether two parts meet, so that they may be near each other where they meet."""
    joined: NDArray[np.bool_]
    """Shape (parts, parts): whether two parts are roads that continue each other or meet at a small angle, so
    that they may be near each other anywhere."""
    reach: NDArray[np.float64]
    """The distance in metres from each point to the outer edge of the shoulder of its road, ``(n,)``."""
    nodes: tuple[tuple[complex, float], ...]
    """For each junction, its node as x + iy in metres, and the distance in metres from the node within which
    the arms may be near each other."""


def sketched(
    lines: Sequence[PlanLine], places: Sequence[PlaceDesign], profiles: Sequence[Profile]
) -> NetworkSketch:
    """Returns the sketch of a route. ``lines`` and ``profiles`` are the centre lines and cross-sections of
    the roads before, between and after ``places``."""
    pen = _Pen(lines[0], profiles[0].reach)
    for number, (place, line) in enumerate(zip(places, lines[1:], strict=True)):
        around = profiles[number], profiles[number + 1]
        if isinstance(place, JunctionDesign):
            pen.pass_junction(place, line, around)
        elif isinstance(place, RampDesign):
            pen.pass_ramp(place, line, around)
        else:
            pen.go_on(line, around[1].reach)
    near, joined = (np.eye(len(pen.parts), dtype=bool) for _ in range(2))
    for pairs, table in ((pen.pairs, near), (pen.joined, joined)):
        for a, b in pairs:
            table[a, b] = table[b, a] = True
    numbers = np.repeat(np.arange(len(pen.parts)), [len(z) for z in pen.parts])
    reach = np.array(pen.reaches)[numbers]
    return NetworkSketch(np.concatenate(pen.parts), numbers, near | joined, joined, reach, tuple(pen.nodes))


class _Pen:
    """Draws the parts of a sketch one after another, in driving order."""

    def __init__(self, line: PlanLine, reach: float) -> None:
        self.parts: list[Complex] = [_thinned(line.z)]
        self.reaches = [reach]
        self.pairs: list[tuple[int, int]] = []
        self.joined: list[tuple[int, int]] = []
        self.nodes: list[tuple[complex, float]] = []
        self._arrival, self._end, self._way = 0, complex(line.z[-1]), _way(line.z)
        self._before: int | None = None  # the part that the last one continues

    def go_on(self, line: PlanLine, reach: float) -> None:
        """Draws a road that continues the one on which the route has arrived."""
        way, here = self._way, self._continued()
        self._before = self._arrival
        self._arrival = self._drawn(self._end + way * _thinned(line.z), reach)
        self._end, self._way = self._end + way * complex(line.z[-1]), way * _way(line.z)
        self.joined += [(part, self._arrival) for part in here]

    def _continued(self) -> list[int]:
        """Returns the last part and the one before that it continues, which may be short."""
        return [self._arrival, *([] if self._before is None else [self._before])]

    def pass_ramp(self, ramp: RampDesign, line: PlanLine, profiles: tuple[Profile, Profile]) -> None:
        """Draws a merge or an exit, the road that the route does not take there, and its next road."""
        here = self._continued()
        on_route, beside = lines_at_ramp(ramp)
        at, way = self._end, self._way
        widest = max(profile.reach for profile in profiles)
        parts = [self._drawn(at + way * np.array(each), widest) for each in (on_route, beside)]
        self._before, self._arrival, self._end = self._arrival, parts[0], at + way * on_route[-1]
        self._way = way * (on_route[-1] - on_route[-2]) / abs(on_route[-1] - on_route[-2])
        here += parts
        self.go_on(line, profiles[1].reach)
        here.append(self._arrival)
        self.joined += [(a, b) for a in here for b in here]

    def pass_junction(
        self, junction: JunctionDesign, line: PlanLine, profiles: tuple[Profile, Profile]
    ) -> None:
        """Draws a junction, its arms, and the road on which the route goes on."""
        directions = [pi, *(radians(arm.angle) for arm in junction.all_arms)]
        arms = [profiles[0], *profiles_of_arms(junction, *profiles)]
        far, way = contact_distances(junction, directions, arms), self._way
        node = self._end + way * far[0]
        self.nodes.append((node, max(far) + AWAY))
        here = [self._arrival]
        if junction.kind == "roundabout":
            around = np.exp(1j * np.linspace(0, 2 * pi, POINTS, endpoint=False))
            half = ring_width(junction.radius, junction.ring_lanes) / 2
            shoulder = max(arm.shoulder_width for arm in arms)
            here.append(self._drawn(node + (junction.radius + half) * around, half + shoulder))
        for n, arm in enumerate(junction.all_arms):
            out = way * cmath.exp(1j * radians(arm.angle))
            start = node + out * far[n + 1]
            if n == junction.taken:
                self._arrival = self._drawn(start + out * _thinned(line.z), profiles[1].reach)
                self._end, self._way = start + out * complex(line.z[-1]), out * _way(line.z)
                here.append(self._arrival)
            else:
                stub = start + out * np.arange(0.0, arm.length or STUB, STEP)
                here.append(self._drawn(stub, arms[n + 1].reach))
        self._before = None
        self.pairs += [(a, b) for a in here for b in here]

    def _drawn(self, z: NDArray[Any], reach: float) -> int:
        self.parts.append(z)
        self.reaches.append(reach)
        return len(self.parts) - 1


def _thinned(z: Complex) -> Complex:
    return np.append(z[: -1 : int(STEP)], z[-1])


def _way(z: Complex) -> complex:
    step = complex(z[-1] - z[-2])
    return step / abs(step)


def is_clear(sketch: NetworkSketch) -> bool:
    """Returns whether all parts of a sketch keep clear of each other, except where they meet."""
    z, part, reach = sketch.z, sketch.part, sketch.reach
    start = np.zeros(len(z))  # the station of all points, so that each pair of points counts
    first = np.searchsorted(part, np.arange(len(sketch.near) + 1))
    may_meet = np.triu(_boxes_touch(sketch, first[:-1]) & ~sketch.joined)
    for number in np.flatnonzero(may_meet.any(axis=1)).tolist():
        own, those = slice(first[number], first[number + 1]), np.flatnonzero(may_meet[number][part])
        apart = reach[own].max() + reach[those].max() + MARGIN
        one, other = meeting(z[own], start[own], z[those], start[those], apart, neighbours=-1.0)
        is_near = np.abs(z[own][one] - z[those[other]]) < reach[own][one] + reach[those[other]] + MARGIN
        one, other = one[is_near], other[is_near]
        if not sketch.near[number, part[those[other]]].all():
            return False
        here, there = z[own][one], z[those[other]]
        for node, away in sketch.nodes:
            is_outside = (np.abs(here - node) >= away) | (np.abs(there - node) >= away)
            here, there = here[is_outside], there[is_outside]
        if len(here):
            return False
    return True


def _boxes_touch(sketch: NetworkSketch, first: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Returns whether the boxes around two parts touch, each as wide as its road and half the margin.
    ``first`` are the indices of the first point of each part; the shape is (parts, parts)."""
    half = sketch.reach[first] + MARGIN / 2
    touch = np.ones_like(sketch.near)
    for values in (sketch.z.real, sketch.z.imag):
        low, high = np.minimum.reduceat(values, first) - half, np.maximum.reduceat(values, first) + half
        touch &= (low[:, None] <= high) & (low <= high[:, None])
    return touch
