"""Sums and clips piecewise cubic functions of the station, such as lane widths. Each function is a list of
rows; a row is a station and the cubic that begins there.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from roadgpt.geometry import CubicProfile, shifted
from roadgpt.geometry.elevation import Cubic

Row = tuple[float, Cubic]
"""A station in metres, and the cubic that begins there."""

SAME = 1e-12  # m; two constants closer than this are treated as equal
TOUCHES = 1e-9  # m by which a cubic may be beyond a limit, because of rounding
SHORTEST = 1e-6  # m between two stations


def combined(parts: Sequence[tuple[float, CubicProfile]], start: float, end: float) -> list[Row]:
    """Returns the sum of cubics, each times its factor, between two stations in metres, as rows."""
    inner = {s for _, each in parts for s in each.stations if start < s < end}
    stations = [start, *sorted(inner)]
    table = np.zeros((len(stations), 4))
    for factor, each in parts:
        table += factor * each.cubics(np.array(stations))
    return CubicProfile.of_table(stations, table).rows


def value_at(row: Row, s: float) -> float:
    """Returns the value that the cubic of a row has at station ``s``."""
    (a, b, c, d), u = row[1], s - row[0]
    return float(a + u * (b + u * (c + u * d)))


def constant(s: float, value: float) -> Row:
    """Returns a row with a constant cubic that begins at station ``s``."""
    return s, (value, 0.0, 0.0, 0.0)


def limited(rows: Sequence[Row], end: float, low: float, high: float) -> list[Row]:
    """Returns the rows with their values clamped to the range from ``low`` to ``high``. The last row ends at
    station ``end`` in metres. The result is exact: a row is cut where its cubic crosses a limit.
    """
    out: list[Row] = []
    ends = [*(s for s, _ in rows[1:]), end]
    for row, stop in zip(rows, ends, strict=True):
        for start, until in _cuts(row, stop, low, high):
            value = value_at(row, (start + until) / 2)
            if low - TOUCHES <= value <= high + TOUCHES:
                a, b, c, d = shifted(np.array(row[1]), start - row[0]).tolist()
                out.append((start, (a, b, c, d)) if start > row[0] else row)
            else:
                out.append(constant(start, low if value < low else high))
    return out


def _cuts(row: Row, end: float, low: float, high: float) -> list[tuple[float, float]]:
    """Returns the parts of a row inside which its cubic crosses no limit."""
    start, (a, b, c, d) = row
    reach = end - start
    swing = reach * (abs(b) + reach * (abs(c) + reach * abs(d)))
    if (low <= a - swing and a + swing <= high) or (b, c, d) == (0.0, 0.0, 0.0):
        return [(start, end)]
    places = {start, end}
    for limit in (low, high):
        for root in np.roots([d, c, b, a - limit]):
            if abs(root.imag) < TOUCHES and SHORTEST < root.real < reach - SHORTEST:
                places.add(start + float(root.real))
    return [*pairwise(sorted(places))]


def closed(rows: Sequence[Row], length: float) -> CubicProfile:
    """Converts the rows to a CubicProfile of a road of ``length`` metres. Beyond the end of the road, the
    profile keeps its last value. A constant row that repeats the row before is left out.
    """
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
