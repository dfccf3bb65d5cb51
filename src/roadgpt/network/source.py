"""Reads roads, routes and designs from files of RoadGPT, tests of other tools, tables and OpenDRIVE files."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from roadgpt.errors import UsageError
from roadgpt.network.design import is_network_design, read_network_design
from roadgpt.network.map_design import AnyDesign, Blueprint, has_nodes, read_map_design
from roadgpt.network.road_or_route import made_from, road_from_json
from roadgpt.reading import json_of, read_text
from roadgpt.road import Geometry, ImportedRoad, Road, World, read_design, read_opendrive
from roadgpt.road.points import SUFFIXES, plain, points_in, points_of_table

ASTRAY = 1.5  # m; a control point farther than this from all points 1 m apart on a road is not on the road
OPENDRIVE = ".xodr"
LARGEST = 50_000_000  # bytes of a road file
SHAPES = (
    "a road, a design or a test written by roadgpt, an SBFT or SDC-Scissor test with road_points, "
    "a list of [x, y] or [x, y, z], a table of points (.csv), or an OpenDRIVE file (.xodr)"
)


def read_blueprint(path: str | Path) -> tuple[Blueprint, tuple[str, ...]]:
    """Returns the design or the road in a file, and remarks on the file.

    Each remark is a sentence about something in the file that was changed, ignored or unusual.

    Args:
        path: The file, or a folder that holds ``road.json``.

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
        return _blueprint_in(data)
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error


def read_road(path: str | Path, geometry: Geometry = "arcs", world: World | None = None) -> Road:
    """Returns the road of a road file, a design file or the folder of a run.

    Args:
        path: The file, or a folder that holds ``road.json``.
        geometry: How a design becomes a road: "arcs" or "spline", as for ``roadgpt.build``.
        world: The World, as for ``made_from``; None for the default World.

    Raises:
        UsageError: The file cannot be read, is not valid, or holds no road; see also ``made_from``.
    """
    return made_from(read_blueprint(path)[0], world or World(), geometry)


def read_any_design(data: Mapping[str, Any]) -> tuple[AnyDesign, tuple[str, ...]]:
    """Reads a dictionary in RoadGPT's JSON format, of a road, a route or a map; returns the design and
    remarks.

    Each remark is a sentence about a contradiction in the data or an unusual value.

    Raises:
        UsageError: A field is missing, misnamed, of the wrong type, out of range or contradicts another.
    """
    if isinstance(data, Mapping) and has_nodes(data):
        return read_map_design(data)
    return read_network_design(data) if is_network_design(data) else read_design(data)


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


def _blueprint_in(data: Any) -> tuple[Blueprint, tuple[str, ...]]:
    """Returns the design or the road in parsed JSON, and remarks. Raises UsageError if there is none."""
    if isinstance(data, dict):
        is_network = is_network_design(data) or has_nodes(data)
        if not is_network and "network" in data:
            return road_from_json(data), ()
        if is_network or "starting_point" in data:
            return read_any_design(data)
        if "pieces" not in data and ("road_points" in data or "interpolated_points" in data):
            return _test_road(data)
        if "pieces" in data or ("nodes" in data and not _has_widths(data["nodes"])):
            return Road.from_json(data), ()
    points = points_in(data)
    if points is None:
        raise UsageError(f"it holds no road; a road file is {SHAPES}")
    return Road.through(points), ()


def _has_widths(nodes: Any) -> bool:
    """Returns whether these are points in a format of another tool, for example with widths."""
    return isinstance(nodes, list) and plain(nodes) != nodes


def _test_road(data: dict[str, Any]) -> tuple[Road, tuple[str, ...]]:
    """Returns the road of an SBFT test, with heights only if it has 3-D points that follow its control
    points.
    """
    dense, control = data.get("interpolated_points"), data.get("road_points")
    if not (isinstance(dense, list) and dense and isinstance(dense[0], list) and len(dense[0]) == 3):
        points: Any = dense if control is None else control
        return Road.through(plain(points) if isinstance(points, list) else points), ()
    road = Road.through(dense, control)
    if road.road_points is None:
        return road, ()
    away, _ = cKDTree(road.centreline()[:, :2]).query(road.road_points)
    if np.max(away) <= ASTRAY:
        return road, ()
    return Road.through(road.road_points), (
        "interpolated_points do not follow road_points; the road_points are used, the heights ignored",
    )
