"""Reads the points of roads from file formats of other tools.

    SBFT tests             {"road_points": [[x, y], ...]}
    SDC-Scissor's tests    the same, or with [x, y, z, width], or "interpolated_road_points"
    SensoDat's tests       [{"road_points": [{"x": ..., "y": ...}, ...]}, ...]
    AsFault and DeepJanus  [[x, y, z, width], ...], alone or as "nodes", "sample_nodes" or "control_nodes"
    tables                 .csv and .tsv, with a header that names x and y, or without one

All values are in metres. Widths are not used, because lane widths are defined by the World. If points have a
height and a width, and all heights are equal, the heights are not used either, since they only state the
ground height of the simulator's map. Sentences say so."""

import csv
import math
from typing import Any

from roadgpt.errors import UsageError

KEYS = (
    "road_points",
    "interpolated_road_points",
    "interpolated_points",
    "sample_nodes",
    "control_nodes",
    "nodes",
    "points",
    "polyline",
    "coordinates",
)
INSIDE = ("m1", "road", "test", "seed")  # keys whose value may be an object with one of KEYS
SUFFIXES = (".csv", ".tsv")
DELIMITERS = (";", "\t", ",")
X = ("x", "x_m", "pos_x", "east", "easting")
Y = ("y", "y_m", "pos_y", "north", "northing")
Z = ("z", "z_m", "pos_z", "height", "elevation", "altitude")
DEGREES = {"lat", "lon", "lng", "latitude", "longitude"}
WITH_WIDTH = 4  # numbers of a point
MOST_ROWS = 200_000  # of a table
WIDTHS = "the width of its points is not used"


Points = tuple[list[Any], tuple[str, ...]]
"""Points [x, y] or [x, y, z] in metres, not checked yet, and sentences about what was not taken."""


def points_in(data: Any) -> Points | None:
    """Returns the road points in parsed JSON; None if there are none. Of several lists of points in a
    dictionary, the one whose key comes first in ``KEYS`` is returned."""
    if isinstance(data, dict):
        found = [key for key in KEYS if isinstance(data.get(key), list) and data[key]]
        if found:
            points, remarks = plain(data[found[0]])
            others = f"{found[0]} are taken, not {', '.join(found[1:])}"
            return points, (others, *remarks) if found[1:] else remarks
        held = (points_in(data[key]) for key in INSIDE if isinstance(data.get(key), dict))
        return next((points for points in held if points is not None), None)
    return plain(data) if isinstance(data, list) else None


def plain(points: list[Any]) -> Points:
    """Returns points of any supported format as lists [x, y] or [x, y, z], and others unchanged."""
    if all(isinstance(point, dict) and {"x", "y"} <= point.keys() for point in points):
        ordered = sorted(points, key=_number)
        remarks = () if ordered == points else ("its points are sorted by sequenceNumber",)
        return [[point[name] for name in ("x", "y", "z") if name in point] for point in ordered], remarks
    if all(isinstance(point, (list, tuple)) and len(point) == WITH_WIDTH for point in points):
        is_level = len({point[2] for point in points if isinstance(point[2], (int, float))}) <= 1
        level = "the height of its points is the same everywhere, and it is not used; " if is_level else ""
        return [list(point[: 2 if is_level else 3]) for point in points], (level + WIDTHS,)
    return points, ()


def _number(point: dict[str, Any]) -> float:
    number = point.get("sequenceNumber", 0)
    return float(number) if isinstance(number, (int, float)) else 0.0


def points_of_table(text: str) -> Points:
    """Returns the points in the text of a .csv or .tsv table: [x, y] or [x, y, z] for each row. Raises
    UsageError if it has no columns for x and y, or a cell is not a number."""
    lines = [line for line in text.lstrip("\ufeff").splitlines() if line.strip() and line.lstrip()[0] != "#"]
    if len(lines) > MOST_ROWS:
        raise UsageError(f"the table has {len(lines):,} rows; give {MOST_ROWS:,} at most, a metre apart")
    if not lines:
        raise UsageError("the table is empty; give one row with x and y for each point")
    delimiter = next((one for one in DELIMITERS if one in lines[0]), None)
    try:
        rows = list(csv.reader(lines, delimiter=delimiter)) if delimiter else [line.split() for line in lines]
    except csv.Error as error:
        raise UsageError(f"the table cannot be read ({error}); write it again") from error
    rows = [[cell.strip() for cell in row] for row in rows]
    has_head = any(_value(cell, delimiter) is None for cell in rows[0])
    columns = _named(rows[0]) if has_head else _first(rows[0])
    body = rows[1:] if has_head else rows
    points = [[_cell(row, c, n, delimiter) for c in columns] for n, row in enumerate(body, 1 + has_head)]
    if len(points) < 2:
        raise UsageError("a road needs two points or more; give a row for each")
    if not has_head and len(rows[0]) == WITH_WIDTH:
        return plain([[*point, 0.0] for point in points])
    others = [name for column, name in enumerate(rows[0]) if column not in columns] if has_head else []
    return points, (f"its columns {', '.join(others)} are not used",) if others else ()


def _named(head: list[str]) -> list[int]:
    names = [cell.lower() for cell in head]
    found = [next((i for i, name in enumerate(names) if name in known), None) for known in (X, Y, Z)]
    if found[0] is None or found[1] is None:
        if DEGREES & {*names}:
            raise UsageError("points in degrees on the Earth cannot be used; give x and y in metres")
        raise UsageError(f"no column of the table is called x or y; there are: {', '.join(head)}")
    return [column for column in found if column is not None]


def _first(row: list[str]) -> list[int]:
    if not 2 <= len(row) <= WITH_WIDTH:
        raise UsageError(
            f"the table has {len(row)} columns and no header; name them x, y, z in the first row"
        )
    return list(range(min(len(row), 3)))


def _cell(row: list[str], column: int, number: int, delimiter: str | None) -> float:
    text = row[column] if column < len(row) else ""
    value = _value(text, delimiter)
    if value is None:
        raise UsageError(f"row {number} of the table has '{text[:40]}' instead of a number; correct it")
    return value


def _value(text: str, delimiter: str | None) -> float | None:
    """Returns the finite number that a text states; None if it states none. Between semicolons or tabs, a
    decimal comma is accepted."""
    try:
        value = float(text.replace(",", ".") if delimiter in (";", "\t") else text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
