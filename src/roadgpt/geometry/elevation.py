"""Defines two types of elevation profile: constant grades joined by parabolas, and piecewise cubics."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from operator import ge

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry.curve import Array, Number, before, placed

ROUNDING = 1e-6  # m, or rad: a cubic this little beyond a limit is at the limit
Cubic = tuple[float, float, float, float]
"""The coefficients (a, b, c, d) of a + b u + c u^2 + d u^3."""
Row = tuple[float, Cubic]
"""A station in metres, and the cubic that begins there."""
SHORTEST = 1e-6  # m between two stations
SAME = 1e-12  # m; two constants closer than this are treated as equal


@dataclass(frozen=True, eq=False)
class GradeProfile:
    """A profile that starts at height ``z0`` and whose grade changes linearly between given stations.

    Before the first and after the last station, the parabola of the nearest interval goes on.

    Args:
        z0: Height at the first station in metres.
        stations: At least two increasing stations in metres.
        grades: The grade at each station as a ratio."""

    z0: float
    stations: tuple[float, ...]
    grades: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.stations) < 2 or len(self.stations) != len(self.grades):
            raise ValueError("a profile needs two or more stations and the same number of grades")
        if any(map(ge, self.stations, self.stations[1:])):
            raise ValueError("the stations of a profile must increase")

    @classmethod
    def of(cls, z0: float, knots: Sequence[tuple[float, float]]) -> "GradeProfile":
        """Returns the profile that starts at height ``z0`` and has these knots (station, grade)."""
        return cls(z0, tuple(s for s, _ in knots), tuple(grade for _, grade in knots))

    @classmethod
    def level(cls, length: float, z0: float = 0.0) -> "GradeProfile":
        """Returns the profile of a level road of this length, both in metres."""
        return cls(z0, (0.0, length), (0.0, 0.0))

    @property
    def knots(self) -> list[tuple[float, float]]:
        """Each station, with the grade there."""
        return [*zip(self.stations, self.grades, strict=True)]

    @cached_property
    def _table(self) -> tuple[Array, Array, Array, Array]:
        """Returns station, height, grade and change of grade per metre at the start of each interval."""
        s, g = np.array(self.stations), np.array(self.grades)
        steps = s[1:] - s[:-1]
        z = self.z0 + before(steps * (g[1:] + g[:-1]) / 2)
        return s[:-1], z, g[:-1], (g[1:] - g[:-1]) / steps

    def at(self, s: float) -> tuple[float, float]:
        """Returns the height in metres and the grade as a ratio at one station, without the overhead of
        arrays."""
        last = max(bisect_right(self.stations[:-1], s) - 1, 0)
        knots = self.knots[: last + 2]
        rises = [(s1 - s0) * (g1 + g0) / 2 for (s0, g0), (s1, g1) in pairwise(knots[:-1])]
        (start, grade), (end, after) = knots[-2:]
        u, change = s - start, (after - grade) / (end - start)
        return self.z0 + sum(rises) + u * (grade + u * change / 2), grade + u * change

    def height(self, s: ArrayLike) -> Array:
        """Returns heights in metres."""
        u, i = placed(s, self._table[0])
        _, z, g, dg = self._table
        return np.asarray(z[i] + u * (g[i] + u * dg[i] / 2))

    def grade(self, s: ArrayLike) -> Array:
        """Returns grades as ratios."""
        u, i = placed(s, self._table[0])
        _, _, g, dg = self._table
        return np.asarray(g[i] + u * dg[i])

    def vertical_curvature(self, s: ArrayLike) -> Array:
        """Returns the change of grade in 1/m, negative on a crest."""
        _, i = placed(s, self._table[0])
        return np.asarray(self._table[3][i])


@dataclass(frozen=True)
class CubicProfile:
    """Heights in metres, given by one cubic polynomial from each station on, as in OpenDRIVE's ``elevation``.

    Widths, offsets and angles along a road are also given in this form.

    Args:
        stations: Increasing stations in metres. Each cubic applies up to the next station. The last cubic
            has no end, and the first one also applies before the first station.
        coefficients: The coefficients (a, b, c, d) of each cubic a + b u + c u^2 + d u^3, where ``u`` is the
            distance from the station at which the cubic begins.

    Raises:
        ValueError: There is no station, the stations do not increase, their number differs from the number
            of cubics, or a cubic does not have four coefficients."""

    stations: tuple[float, ...]
    coefficients: tuple[Cubic, ...]

    def __post_init__(self) -> None:
        if not self.stations or len(self.stations) != len(self.coefficients):
            raise ValueError("a profile needs stations and the same number of cubics")
        if any(map(ge, self.stations, self.stations[1:])):
            raise ValueError("the stations of a profile must increase")
        if any(len(cubic) != 4 for cubic in self.coefficients):
            raise ValueError("a cubic has four coefficients")

    @classmethod
    def of_rows(cls, rows: Sequence[tuple[float, Cubic]]) -> "CubicProfile":
        """Returns the profile with these stations, each with the cubic that begins there."""
        return cls(tuple(s for s, _ in rows), tuple(cubic for _, cubic in rows))

    @classmethod
    def of_table(cls, stations: Sequence[float], table: Array) -> "CubicProfile":
        """Returns the profile with a cubic at each station; ``table`` has their coefficients, ``(n, 4)``."""
        return cls(tuple(stations), tuple((a, b, c, d) for a, b, c, d in table.tolist()))

    @classmethod
    def constant(cls, height: float) -> "CubicProfile":
        """Returns the profile with this height in metres everywhere."""
        return cls((0.0,), ((height, 0.0, 0.0, 0.0),))

    @classmethod
    def smooth(cls, knots: Sequence[tuple[float, float]]) -> "CubicProfile":
        """Returns a profile that passes through one or more knots (station, height) in metres and has a grade
        of 0 at each of them. The height is constant after the last knot."""
        if any(s1 <= s0 for (s0, _), (s1, _) in pairwise(knots)):
            raise ValueError("the stations of the knots must increase")
        rows = []
        for (s0, start), (s1, end) in pairwise(knots):
            n, change = s1 - s0, end - start
            rows.append((start, 0.0, 3 * change / n**2 + 0.0, -2 * change / n**3 + 0.0))
        rows.append((knots[-1][1], 0.0, 0.0, 0.0))
        return cls(tuple(s for s, _ in knots), tuple(rows))

    @classmethod
    def through(cls, stations: Array, heights: Array, grades: Array) -> "CubicProfile":
        """Returns the profile with these heights in metres and grades at two or more stations."""
        step = np.diff(stations)
        mean = np.diff(heights) / step
        first, last = grades[:-1], grades[1:]
        table = [
            heights[:-1],
            first,
            (3 * mean - 2 * first - last) / step,
            (first + last - 2 * mean) / step**2,
        ]
        return cls.of_table(stations[:-1].tolist(), np.stack(table, axis=-1))

    @property
    def rows(self) -> list[tuple[float, Cubic]]:
        """Each station, with the cubic that begins there."""
        return [*zip(self.stations, self.coefficients, strict=True)]

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """Returns the stations ``(n,)`` and the coefficients of the cubics, ``(4, n)``."""
        return np.array(self.stations), np.array(self.coefficients).T.copy()

    def _place(self, s: ArrayLike) -> tuple[Array, Array]:
        """Returns the distance of each ``s`` from the start of its cubic, and the coefficients ``(4, ...)``
        of that cubic."""
        starts, table = self._table
        u, index = placed(s, starts)
        return u, table[:, index]

    @cached_property
    def negative(self) -> "CubicProfile":
        """The profile with the sign of every height changed."""
        rows = tuple((0.0 - a, 0.0 - b, 0.0 - c, 0.0 - d) for a, b, c, d in self.coefficients)
        return CubicProfile(self.stations, rows)

    def cubics(self, s: ArrayLike) -> Array:
        """Returns the coefficients ``(n, 4)`` of the cubics that apply at stations ``s`` of shape ``(n,)``.
        Each cubic is rewritten as a function of the distance from its station in ``s``."""
        u, table = self._place(s)
        a, b, c, d = table
        return np.stack(_moved(a, b, c, d, u), axis=-1)

    def cubic(self, s: float) -> Cubic:
        """Returns the coefficients of ``cubics`` at one station, without the overhead of arrays."""
        n = max(bisect_right(self.stations, s) - 1, 0)
        return _moved(*self.coefficients[n], s - self.stations[n])

    def extremes(self) -> tuple[float, float]:
        """Returns the smallest and the largest height in metres between the first and the last station."""
        found = self._peaks()
        return min(found)[0], max(found)[0]

    def beyond(self, low: float, high: float) -> tuple[float, float] | None:
        """Returns the station and the height that lies farthest outside a range; None if none is outside by
        more than ``ROUNDING``. Whatever clamps or checks asks this, so nothing clamped is ever refused."""
        away, height, s = max((max(low - z, z - high), z, s) for z, s in self._peaks())
        return (s, height) if away > ROUNDING else None

    def _peaks(self) -> list[tuple[float, float]]:
        found = [(self.coefficients[-1][0], self.stations[-1])]
        for start, end, (a, b, c, d) in zip(
            self.stations, self.stations[1:], self.coefficients, strict=False
        ):
            for u in (0.0, *(u for u in _roots(3 * d, 2 * c, b) if 0 < u < end - start), end - start):
                found.append((a + u * (b + u * (c + u * d)), start + u))
        return found

    def height(self, s: ArrayLike) -> Array:
        """Returns heights in metres."""
        u, (a, b, c, d) = self._place(s)
        return np.asarray(a + u * (b + u * (c + u * d)))

    def grade(self, s: ArrayLike) -> Array:
        """Returns grades as ratios."""
        u, (_, b, c, d) = self._place(s)
        return np.asarray(b + u * (2 * c + 3 * u * d))

    def vertical_curvature(self, s: ArrayLike) -> Array:
        """Returns the change of grade in 1/m, negative on a crest."""
        u, (_, _, c, d) = self._place(s)
        return np.asarray(2 * c + 6 * u * d)


def _roots(a: float, b: float, c: float) -> tuple[float, ...]:
    """Returns the real roots of a u^2 + b u + c; an empty tuple if a and b are 0."""
    if a == 0:
        return () if b == 0 else (-c / b,)
    square = b * b - 4 * a * c
    if square < 0:
        return ()
    q = -(b + math.copysign(math.sqrt(square), b)) / 2
    return (q / a,) if q == 0 else (q / a, c / q)


def shifted(cubics: Array, u: ArrayLike) -> Array:
    """Returns the coefficients ``(..., 4)`` of cubics after their origin is moved forward by ``u``. The
    constant coefficient comes first, in ``cubics`` and in the result."""
    a, b, c, d = (cubics[..., n] for n in range(4))
    return np.stack(_moved(a, b, c, d, np.asarray(u, float)), axis=-1)


def _moved(a: Number, b: Number, c: Number, d: Number, u: Number) -> tuple[Number, Number, Number, Number]:
    return a + u * (b + u * (c + u * d)), b + u * (2 * c + 3 * u * d), c + 3 * u * d, d


def value_at(row: Row, s: float) -> float:
    """Returns the value that the cubic of a row has at station ``s``."""
    (a, b, c, d), u = row[1], s - row[0]
    return float(a + u * (b + u * (c + u * d)))


def constant(s: float, value: float) -> Row:
    """Returns a row with a constant cubic that begins at station ``s``."""
    return s, (value, 0.0, 0.0, 0.0)


def closed(rows: Sequence[Row], length: float) -> CubicProfile:
    """Converts the rows to a CubicProfile of a road of ``length`` metres. Beyond the end of the road, the
    profile keeps its last value. A constant row that repeats the row before is left out."""
    kept: list[Row] = []
    for row in rows:
        if kept and row[0] >= length - SHORTEST:
            break
        if kept and row[0] - kept[-1][0] < SHORTEST:
            kept.pop()
        repeats = kept and _is_constant(kept[-1]) and _is_constant(row)
        if not (repeats and abs(kept[-1][1][0] - row[1][0]) < SAME):
            kept.append(row)
    if not _is_constant(kept[-1]):
        kept.append(constant(length, value_at(kept[-1], length)))
    return CubicProfile.of_rows(kept)


def _is_constant(row: Row) -> bool:
    return not any(row[1][1:])
