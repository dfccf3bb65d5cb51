"""Changes the curvature and the grade of a road piece by piece, and builds the changed road.

A change makes some samples of a road longer or shorter and changes their curvature or grade; the road after
these samples moves accordingly. The changed road is built for one drive only, so it may leave the map or
overlap itself.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple, Self

import numpy as np

from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.road import Road

STEP = 0.5  # m, between samples
STRAIGHT = 1 / 250  # 1/m; a road that bends less is called straight


class Bend(NamedTuple):
    """A bend: the indices of its first and last sample."""

    first: int
    last: int


@dataclass(frozen=True, eq=False)
class Alignment:
    """Curvature and grade of a road at its samples; all arrays have shape ``(n,)``."""

    steps: Array
    """Distance from each sample to the one before, metres; 0 for the first."""
    curvature: Array
    """1/m, positive to the left; it changes linearly between samples."""
    grade: Array
    """Grade as a ratio; it changes linearly between samples."""

    @classmethod
    def of(cls, road: Road) -> Self:
        """Samples a road about every half metre."""
        stations = np.linspace(0.0, road.length, int(np.ceil(road.length / STEP)) + 1)
        return cls(np.diff(stations, prepend=0.0), road.curvature(stations), road.grade(stations))

    @property
    def stations(self) -> Array:
        """Stations of the samples, metres."""
        return np.cumsum(self.steps)

    def bends(self) -> list[Bend]:
        """Returns the bends in driving order. A bend is a longest possible sequence of samples that all curve
        to the same side, with a radius below 250 m.
        """
        side = np.where(np.abs(self.curvature) > STRAIGHT, np.sign(self.curvature), 0.0)
        edges = [0, *(np.flatnonzero(np.diff(side)) + 1), len(side)]
        pieces = pairwise(edges)
        return [Bend(int(first), int(end) - 1) for first, end in pieces if side[first]]

    def widened(self, bend: Bend, factor: float) -> Self:
        """Returns a copy with radius and length of a bend times ``factor``; the bend turns as many
        degrees as before."""
        curvature = self.curvature.copy()
        curvature[bend.first : bend.last + 1] /= factor
        return replace(self.shortened(bend, factor), curvature=curvature)

    def shortened(self, bend: Bend, factor: float) -> Self:
        """Returns a copy with the length of a bend times ``factor``; below 1, the bend turns less."""
        steps = self.steps.copy()
        steps[bend.first + 1 : bend.last + 1] *= factor
        return replace(self, steps=steps)

    def eased(self, around: Bend, length: float) -> Self:
        """Returns a copy in which the curvature changes more slowly around a bend: each value is replaced by
        the mean over ``length`` metres, from ``length`` metres before the bend to ``length`` metres after it.
        """
        count = 2 * round(length / STEP / 2)
        padded = np.pad(self.curvature, count // 2, mode="edge")
        mean = np.convolve(padded, np.ones(count + 1) / (count + 1), "valid")
        near = slice(max(0, around.first - count), around.last + count + 1)
        curvature = self.curvature.copy()
        curvature[near] = mean[near]
        return replace(self, curvature=curvature)

    def with_straight(self, bend: Bend, length: float) -> Self:
        """Returns a copy with a straight of ``length`` metres inserted before a bend."""
        count, at = round(length / STEP), bend.first
        straight = self.curvature.copy()
        straight[at] = 0.0
        return replace(
            self,
            steps=np.insert(self.steps, at + 1, np.full(count, STEP)),
            curvature=np.insert(straight, at, np.zeros(count)),
            grade=np.insert(self.grade, at, np.full(count, self.grade[at])),
        )

    def levelled(self, factor: float) -> Self:
        """Returns a copy in which all grades are multiplied by ``factor``."""
        return replace(self, grade=self.grade * factor)

    def road(self, like: Road) -> Road:
        """Builds the road, with the same start position, start heading and start height as ``like``."""
        x, y = like.plan.at(np.array(0.0))
        bends = self.curvature
        plan = PieceCurve(
            float(x),
            float(y),
            float(like.plan.heading(np.array(0.0))),
            tuple(
                Piece(float(length), float(k0), float(k1))
                for length, k0, k1 in zip(self.steps[1:], bends[:-1], bends[1:], strict=True)
            ),
        )
        height = float(like.elevation.height(np.array(0.0)))
        return Road(plan, GradeProfile(height, tuple(self.stations), tuple(self.grade)))
