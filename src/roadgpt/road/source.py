"""Reads roads from files: RoadGPT's road files and designs, tests of other tools, tables and OpenDRIVE."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from scipy.spatial import cKDTree

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.reading import json_of, read_text
from roadgpt.road.builder import Geometry, build
from roadgpt.road.design import Design, read_design
from roadgpt.road.opendrive import ImportedRoad, read_opendrive
from roadgpt.road.points import SUFFIXES, plain, points_in, points_of_table
from roadgpt.road.road import Road
from roadgpt.road.world import World

ASTRAY = 1.5  # m; a control point farther than this from all points 1 m apart on a road is not on the road
OPENDRIVE = ".xodr"
LARGEST = 50_000_000  # bytes of a road file
SHAPES = (
    "a road, a design or a test written by roadgpt, an SBFT or SDC-Scissor test with road_points, "
    "a list of [x, y] or [x, y, z], a table of points (.csv), or an OpenDRIVE file (.xodr)"
)


T = TypeVar("T")


def _nothing(data: Any) -> None:
    """Knows no data."""


def read_road(path: str | Path, geometry: Geometry = "arcs") -> Road:
    """Returns the road in a road file or in the folder of a run.

    Args:
        path: The file, or a folder that holds ``road.json``.
        geometry: How a design becomes a road: "arcs" or "spline", as for ``roadgpt.build``.

    Raises:
        UsageError: The file cannot be read, is not valid, or holds no road.
    """
    blueprint, _ = read_blueprint(path)
    return build(blueprint, geometry) if isinstance(blueprint, Design) else blueprint


def read_blueprint(
    path: str | Path, others: Callable[[Any], tuple[T, tuple[str, ...]] | None] = _nothing
) -> tuple[Design | Road | T, tuple[str, ...]]:
    """Returns the Design or the Road in a file, and remarks on the file.

    Each remark is a sentence about something in the file that was changed, ignored or unusual.

    Args:
        path: The file, or a folder that holds ``road.json``.
        others: A function that is called first, with the parsed JSON of a file. If it knows the data, its
            result is returned; for all other data, it has to return None.

    Raises:
        UsageError: The file cannot be read, is not valid, or holds no road.
    """
    path = Path(path)
    if path.is_dir():
        path = path / "road.json"
    if path.suffix.lower() == OPENDRIVE:
        found = read_opendrive(path)
        return found.road, (*found.remarks, *_lanes_told(found))
    try:
        text = read_text(path, LARGEST, "a road file")
        is_table = path.suffix.lower() in SUFFIXES
        data = None if is_table else json_of(text)
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}; give the path of a road file") from error
    except ValueError as error:
        raise UsageError(f"{path} is not valid JSON ({error}); give {SHAPES}") from error
    try:
        if is_table:
            return Road.through(points_of_table(text)), ()
        if (found_by_others := others(data)) is not None:
            return found_by_others
        if isinstance(data, dict) and "starting_point" in data:
            return read_design(data)
        if isinstance(data, dict) and _is_test(data):
            return _test_road(data)
        return road_of(data), ()
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error


def _lanes_told(found: ImportedRoad) -> tuple[str, ...]:
    """Returns a remark on the lanes, speed limit and friction of an OpenDRIVE file that differ from those of
    the default World; no remark if none differ.
    """
    usual, own = World(), found.world(World())
    speed, friction = own.limits.speed_limit, own.site.friction
    told = {
        f"lanes of {own.section.lane_width:g} m": own.section.lane_width == usual.section.lane_width,
        f"a shoulder of {own.section.shoulder:g} m": own.section.shoulder == usual.section.shoulder,
        f"{speed * 3.6:.4g} km/h": math.isclose(speed, usual.limits.speed_limit),
        f"a friction of {friction:g}": friction == usual.site.friction,
    }
    others = [what for what, is_usual in told.items() if not is_usual]
    if not others:
        return ()
    return (f"its file says {', '.join(others)}; roadgpt import prints the options for this",)


def road_of(data: Any, geometry: Geometry = "arcs") -> Road:
    """Returns the road that parsed JSON describes.

    Args:
        data: The parsed JSON of a road file.
        geometry: How a design becomes a road, as in ``read_road``.

    Raises:
        UsageError: The data hold no road.
    """
    if isinstance(data, dict):
        if "pieces" in data or ("nodes" in data and not _has_widths(data["nodes"])):
            return Road.from_json(data)
        if "starting_point" in data:
            return build(read_design(data)[0], geometry)
        if _is_test(data):
            return _test_road(data)[0]
    points = points_in(data)
    if points is not None:
        return Road.through(points)
    raise UsageError(f"it holds no road; a road file is {SHAPES}")


def _has_widths(nodes: Any) -> bool:
    """Returns whether these are points in a format of another tool, for example with widths."""
    return isinstance(nodes, list) and plain(nodes) != nodes


def _is_test(data: dict[str, Any]) -> bool:
    return "pieces" not in data and ("road_points" in data or "interpolated_points" in data)


def _test_road(data: dict[str, Any]) -> tuple[Road, tuple[str, ...]]:
    """Returns the road of an SBFT test.

    The road has heights only if the test has interpolated points in 3-D that follow the control points.
    """
    dense, control = data.get("interpolated_points"), data.get("road_points")
    if not (isinstance(dense, list) and dense and isinstance(dense[0], list) and len(dense[0]) == 3):
        points: Any = dense if control is None else control
        return Road.through(plain(points) if isinstance(points, list) else points), ()
    road = Road.through(dense, control)
    if road.road_points is None or _follows(road, road.road_points):
        return road, ()
    return Road.through(road.road_points), (
        "interpolated_points do not follow road_points; the road_points are used, the heights ignored",
    )


def _follows(road: Road, control: Array) -> bool:
    """Returns whether the road passes every control point."""
    away, _ = cKDTree(road.centreline()[:, :2]).query(control)
    return bool(np.max(away) <= ASTRAY)
