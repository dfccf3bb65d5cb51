"""Height profiles: steady grades joined by parabolas, and cubics as files of other tools have them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry.curve import Array


@dataclass(frozen=True, eq=False)
class GradeProfile:
    """Starts at height ``z0``; the grade runs linearly between its values at the stations.

    Args:
        z0: height at the first station, metres.
        stations: rising, metres; at least two.
        grades: slope at each station, as ratios.

    Raises:
        ValueError: the stations do not rise, or are not as many as the grades.
    """

    z0: float
    stations: tuple[float, ...]
    grades: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.stations) < 2 or len(self.stations) != len(self.grades):
            raise ValueError("a profile needs two or more stations and as many grades")
        if any(b <= a for a, b in zip(self.stations, self.stations[1:], strict=False)):
            raise ValueError("the stations of a profile must rise")

    @cached_property
    def _table(self) -> tuple[Array, Array, Array, Array]:
        """Per stretch: station, height and grade at its start, and change of grade per metre."""
        s, g = np.array(self.stations), np.array(self.grades)
        rise = np.diff(s) * (g[1:] + g[:-1]) / 2
        z = self.z0 + np.r_[0.0, np.cumsum(rise)]
        return s[:-1], z[:-1], g[:-1], np.diff(g) / np.diff(s)

    def _place(self, s: ArrayLike) -> tuple[Array, np.ndarray]:
        s = np.asarray(s, float)
        start = self._table[0]
        index = np.clip(np.searchsorted(start, s, side="right") - 1, 0, len(start) - 1)
        return s - start[index], index

    def height(self, s: ArrayLike) -> Array:
        """Heights in metres."""
        u, i = self._place(s)
        _, z, g, dg = self._table
        return np.asarray(z[i] + u * (g[i] + u * dg[i] / 2))

    def grade(self, s: ArrayLike) -> Array:
        """Slopes, as ratios."""
        u, i = self._place(s)
        _, _, g, dg = self._table
        return np.asarray(g[i] + u * dg[i])

    def vertical_curvature(self, s: ArrayLike) -> Array:
        """Change of slope in 1/m, negative on a crest."""
        _, i = self._place(s)
        return np.asarray(self._table[3][i])


@dataclass(frozen=True, eq=False)
class CubicProfile:
    """Heights as cubics of the distance from each station: OpenDRIVE's elevation.

    Args:
        stations: rising, metres; each cubic reaches to the next, the last one on and on.
        coefficients: of each cubic, constant first: a + b u + c u^2 + d u^3.

    Raises:
        ValueError: there is no station, they do not rise, or are not as many as the cubics.
    """

    stations: tuple[float, ...]
    coefficients: tuple[tuple[float, float, float, float], ...]

    def __post_init__(self) -> None:
        if not self.stations or len(self.stations) != len(self.coefficients):
            raise ValueError("a profile needs stations and as many cubics")
        if any(b <= a for a, b in zip(self.stations, self.stations[1:], strict=False)):
            raise ValueError("the stations of a profile must rise")
        if any(len(cubic) != 4 for cubic in self.coefficients):
            raise ValueError("a cubic has four coefficients")

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        return np.array(self.stations), np.array(self.coefficients)

    def _place(self, s: ArrayLike) -> tuple[Array, Array]:
        """Distance from its station, and the cubic's coefficients ``(4, ...)``, for each of ``s``."""
        s = np.asarray(s, float)
        start, table = self._table
        index = np.clip(np.searchsorted(start, s, side="right") - 1, 0, len(start) - 1)
        return s - start[index], np.moveaxis(table[index], -1, 0)

    def cubics(self, s: ArrayLike) -> Array:
        """The cubics ``(n, 4)`` of the distance from stations ``s``, ``(n,)``."""
        u, table = self._place(s)
        return shifted(np.moveaxis(table, 0, -1), u)

    def height(self, s: ArrayLike) -> Array:
        """Heights in metres."""
        u, (a, b, c, d) = self._place(s)
        return np.asarray(a + u * (b + u * (c + u * d)))

    def grade(self, s: ArrayLike) -> Array:
        """Slopes, as ratios."""
        u, (_, b, c, d) = self._place(s)
        return np.asarray(b + u * (2 * c + 3 * u * d))

    def vertical_curvature(self, s: ArrayLike) -> Array:
        """Change of slope in 1/m, negative on a crest."""
        u, (_, _, c, d) = self._place(s)
        return np.asarray(2 * c + 6 * u * d)


def shifted(cubics: Array, u: ArrayLike) -> Array:
    """The same cubics ``(..., 4)``, constant first, told from places ``u`` ``(...)`` farther on."""
    u = np.asarray(u, float)
    a, b, c, d = np.moveaxis(cubics, -1, 0)
    rows = [a + u * (b + u * (c + u * d)), b + u * (2 * c + 3 * u * d), c + 3 * u * d, d]
    return np.stack(rows, axis=-1)
