"""Sketches a route with its junctions as lines, to see quickly whether its parts keep clear of each other.

A sketch holds points about 2 m apart. The network that is built from the chosen draft is exact, and every
rule checks it again."""

import cmath
from collections.abc import Sequence
from math import pi, radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.junctions import RINGS
from roadgpt.design.layout import PlanLine
from roadgpt.geometry.nearness import Complex, meeting
from roadgpt.network.building import lines_at_ramp, ring_width
from roadgpt.network.growing import contact_distances, profiles_of_arms
from roadgpt.road import Profile
from roadgpt.road.design import STUB, JunctionDesign, PlaceDesign, RampDesign

STEP = 2.0  # m between points
MARGIN = 1.5  # m between the shoulders of roads that do not meet
POINTS = 24  # number of points around a roundabout
ROUNDING = 1e-6  # m
AWAY = 12.0  # m from a contact, outwards, within which the arms of one junction may be near each other


def sketched(
    lines: Sequence[PlanLine], places: Sequence[PlaceDesign], profiles: Sequence[Profile]
) -> tuple[Complex, float] | None:
    """Returns the sketch of a route that starts at the origin and heads along +x: its points, x + iy in
    metres, ``(n,)``, and the greatest distance in metres from a point to the outer edge of the shoulder of
    its road. None as soon as two parts overlap where they do not meet. ``lines`` and ``profiles`` are the
    centre lines and cross-sections of the roads before, between and after ``places``."""
    pen = _Pen(lines[0], profiles[0].reach)
    for number, (place, line) in enumerate(zip(places, lines[1:], strict=True)):
        around = profiles[number], profiles[number + 1]
        if isinstance(place, JunctionDesign):
            pen.pass_junction(place, line, around)
        elif isinstance(place, RampDesign):
            pen.pass_ramp(place, line, around)
        else:
            pen.go_on(line, around[1].reach)
        if not pen.keeps_clear():
            return None
    return (np.concatenate(pen.parts), max(pen.reaches)) if pen.meets_at_nodes_only() else None


class _Pen:
    """Draws the parts of a sketch, roads and roundabouts, one after another in driving order."""

    def __init__(self, line: PlanLine, reach: float) -> None:
        self.parts: list[Complex] = []
        """The points of each part."""
        self.reaches: list[float] = []
        """The distance in metres from the points of each part to the outer edge of the shoulder."""
        self.near: set[tuple[int, int]] = set()
        """Parts that meet at a junction, so that they may be near each other there."""
        self.joined: set[tuple[int, int]] = set()
        """Roads that continue each other or meet at a small angle, and so may be near each other anywhere."""
        self.nodes: list[tuple[complex, float]] = []
        """For each junction, its node as x + iy in metres, and the distance in metres from the node within
        which the arms may be near each other."""
        self._boxes: list[tuple[float, float, float, float]] = []
        self._looked_at = self._drawn(_thinned(line.z), reach) + 1
        self._at_nodes: list[tuple[int, int]] = []
        self._arrival, self._end, self._way = 0, complex(line.z[-1]), _way(line.z)
        self._before: int | None = None  # the part that the last one continues

    def go_on(self, line: PlanLine, reach: float) -> None:
        """Draws a road that continues the one on which the route has arrived."""
        here = self._continued()
        self._before = self._arrival
        self._draw_road(line, self._end, self._way, reach)
        self.joined |= {(part, self._arrival) for part in here}

    def _draw_road(self, line: PlanLine, start: complex, way: complex, reach: float) -> None:
        self._arrival = self._drawn(start + way * _thinned(line.z), reach)
        self._end, self._way = start + way * complex(line.z[-1]), way * _way(line.z)

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
        self.joined |= {(a, b) for a in here for b in here}

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
        if junction.kind in RINGS:
            around = np.exp(1j * np.linspace(0, 2 * pi, POINTS, endpoint=False))
            half = ring_width(junction.radius, junction.ring_lanes) / 2
            shoulder = max(arm.shoulder_width for arm in arms)
            here.append(self._drawn(node + (junction.radius + half) * around, half + shoulder))
        for n, arm in enumerate(junction.all_arms):
            out = way * cmath.exp(1j * radians(arm.angle))
            start = node + out * far[n + 1]
            if n == junction.taken:
                self._draw_road(line, start, out, profiles[1].reach)
                here.append(self._arrival)
            else:
                stub = start + out * np.arange(0.0, arm.length or STUB, STEP)
                here.append(self._drawn(stub, arms[n + 1].reach))
        self._before = None
        self.near |= {(a, b) for a in here for b in here}

    def _drawn(self, z: NDArray[Any], reach: float) -> int:
        self.parts.append(z)
        self.reaches.append(reach)
        half, x, y = reach + MARGIN / 2, z.real, z.imag
        box = float(x.min()) - half, float(x.max()) + half, float(y.min()) - half, float(y.max()) + half
        self._boxes.append(box)
        return len(self.parts) - 1

    def keeps_clear(self) -> bool:
        """Returns whether the parts that are new since the last call keep clear of all that they do not meet.
        Parts that meet are looked at by ``meets_at_nodes_only``, when all nodes are known."""
        for new in range(self._looked_at, len(self.parts)):
            left, right, low, high = self._boxes[new]
            for part, (left_of, right_of, low_of, high_of) in enumerate(self._boxes[:new]):
                touch = left <= right_of and left_of <= right and low <= high_of and low_of <= high
                if not touch or (part, new) in self.joined:
                    continue
                if (part, new) in self.near:
                    self._at_nodes.append((part, new))
                elif len(self._close(part, new)[0]):
                    return False
        self._looked_at = len(self.parts)
        return True

    def meets_at_nodes_only(self) -> bool:
        """Returns whether all parts that meet at a junction keep clear of each other elsewhere."""
        for pair in self._at_nodes:
            here, there = self._close(*pair)
            for node, away in self.nodes:
                is_outside = (np.abs(here - node) >= away) | (np.abs(there - node) >= away)
                here, there = here[is_outside], there[is_outside]
            if len(here):
                return False
        return True

    def _close(self, one: int, other: int) -> tuple[Complex, Complex]:
        """Returns the pairs of points of two parts whose roads overlap or have less than ``MARGIN`` between
        them."""
        z, there, apart = self.parts[one], self.parts[other], self.reaches[one] + self.reaches[other] + MARGIN
        # the station of all points is 0, so that each pair of points counts
        pairs = meeting(z, np.zeros(len(z)), there, np.zeros(len(there)), apart + ROUNDING, neighbours=-1.0)
        here, there = z[pairs[0]], there[pairs[1]]
        is_near = np.abs(here - there) < apart
        return here[is_near], there[is_near]


def _thinned(z: Complex) -> Complex:
    return np.append(z[: -1 : int(STEP)], z[-1])


def _way(z: Complex) -> complex:
    step = complex(z[-1] - z[-2])
    return step / abs(step)
