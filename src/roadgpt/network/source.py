"""Reads roads, routes and designs from files of RoadGPT, tests of other tools, tables and OpenDRIVE files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy
from pydantic import ValidationError

from roadgpt.errors import UsageError, command_line
from roadgpt.network.maps import ImportedMap, is_map_file, read_opendrive, reader_of
from roadgpt.network.road_or_route import made_from, road_from_json
from roadgpt.network.route import Route
from roadgpt.reading import json_of, read_json, read_text
from roadgpt.road import Design, Geometry, Road, World, read_design
from roadgpt.road.design import first_error, is_design
from roadgpt.road.points import SUFFIXES, plain, points_in, points_of_table

ASTRAY = 1.5  # m; a control point farther than this from all points 1 m apart on a road is not on the road
LINES = ".jsonl"
LARGEST = 50_000_000  # bytes of a road file
MAP = 2  # roads; a file with fewer is no map
SHAPES = (
    "a road, a design or a test written by roadgpt, an SBFT or SDC-Scissor test with road_points, "
    "a list of [x, y] or [x, y, z], a table of points (.csv), or an OpenDRIVE file (.xodr)"
)
OF_FILE = ("map_size", "lane_width", "shoulder", "speed_limit", "limit_stated", "friction")
"""The fields of a World that a road file may state for its road, as ``world``."""
OF_RUN = ("road.json", "design.json")  # files of a run, which has its World in run.json
NAMES = ("_id", "id", "name", "test_id")  # keys of a test that may hold its name


class RoadSource(NamedTuple):
    """What a road file holds. ``remarks`` are sentences about what was changed, ignored or unusual in it.
    ``world`` has the fields of a World that it states: ``OF_FILE``, of a run also its scene. ``name`` is the
    id of a road in OpenDRIVE, whose name is the ``label``, or the name of the test or file."""

    blueprint: Design | Road
    remarks: tuple[str, ...]
    world: Mapping[str, Any]
    name: str
    label: str = ""
    is_ours: bool = False


def read_source(path: str | Path) -> RoadSource:
    """Reads the design or the road in a file, or in a folder that holds ``road.json``, such as that of a run,
    with what the file states about its World: ``World().changed(**source.world)``. Raises UsageError if the
    file cannot be read, is not valid, holds no road or several."""
    found = read_sources(path)
    if len(found) > 1:
        advice = f"to write each into a file of its own: {command_line('import', path)}"
        raise UsageError(f"{path}: it holds {len(found):,} roads; {advice}")
    if isinstance(found[0], UsageError):
        raise found[0]
    return found[0]


def read_sources(path: str | Path, wanted: str | None = None) -> list[RoadSource | UsageError]:
    """Reads all roads of a file, those of the name ``wanted``, or one of an OpenDRIVE file; see
    ``read_opendrive``. An OpenDRIVE file with several roads is read as a map without a route, unless one road
    is wanted. A list of tests (.json), or one test in each line (.jsonl), holds several; those that
    are not valid are returned as errors. Raises UsageError if the file cannot be read or has no such road."""
    path = Path(path, "road.json") if Path(path).is_dir() else Path(path)
    ending, card, world = path.suffix.lower(), path.with_name("run.json"), {}
    text = ""
    try:
        text = "<" if is_map_file(path) else read_text(path, LARGEST, "a road file")
        if text.lstrip()[:1] == "<":
            return [_of_map(path, wanted)]
        if ending == LINES:
            text = "[" + ",\n".join(line for line in text.splitlines() if line.strip()) + "]"
        data = text if ending in SUFFIXES else json_of(text)
        if path.name in OF_RUN and card.is_file():
            said = World.model_validate(read_json(card, LARGEST)["request"]["world"])
            of_run = said.with_heights_in(path.parent, path.parent.parent.parent).values()
            world = {name: of_run[name] for name in (*OF_FILE, "scene", "ground") if of_run[name] != ""}
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror}; give the path of a road file") from error
    except (ValueError, LookupError, TypeError) as error:
        if text.lstrip()[:1] == "<":  # a fault of the reader
            raise
        raise UsageError(f"{path} is not valid JSON ({error}); give {SHAPES}") from error
    tests = [(_name(data) or path.stem, data)]
    if isinstance(data, list) and any(map(_is_test, data)):
        tests = [(_name(each) or str(number), each) for number, each in enumerate(data, 1)]
    found = [source_in(name, each, world, path) for name, each in tests if wanted in (None, name)]
    if not found:
        raise UsageError(f"{path}: there is no road {wanted} in it")
    return found


def _of_map(path: Path, wanted: str | None) -> RoadSource:
    if wanted is None and (found := map_in(path)) is not None:
        values, told = found.world_values()
        return RoadSource(Route.along(found.network, ()), (*found.remarks, *told), values, path.stem)
    road = read_opendrive(path, wanted)
    return RoadSource(road.road, road.remarks, road.world_values, road.id, road.name)


def map_in(path: Path) -> ImportedMap | None:
    """Returns the map in a file; None if the file has a single road, which is read by itself."""
    reader = reader_of(path)
    return reader.read_map(path) if reader.count_roads(path) >= MAP else None


def _is_test(data: Any) -> bool:
    has_points = isinstance(data, dict) and points_in(data) is not None
    return has_points or (isinstance(data, list) and bool(data) and isinstance(data[0], (list, dict)))


def _name(test: Any) -> str:
    held = [test[key] for key in NAMES if key in test] if isinstance(test, dict) else []
    found = [each.get("$oid") if isinstance(each, dict) else each for each in held]
    return next((str(each) for each in found if isinstance(each, (str, int)) and str(each)), "")


def source_in(name: str, data: Any, world: Mapping[str, Any], path: Path) -> RoadSource | UsageError:
    """Returns what the data of a road file hold, or the error if they hold no road; ``world`` is what is
    stated where they state none, and ``path`` that of the file."""
    is_ours = isinstance(data, dict) and ("world" in data or points_in(data) is None)
    try:
        if isinstance(data, dict) and "world" in data:
            world = _checked(data["world"])
            data = {key: value for key, value in data.items() if key != "world"}
        if path.suffix.lower() in SUFFIXES:
            points, remarks = points_of_table(data)
            return RoadSource(Road.through(points), remarks, world, name, is_ours=is_ours)
        read = _blueprint_in(data)
    except UsageError as error:
        which = f" (road {name})" if name != path.stem else ""
        return UsageError(f"{path}{which}: {error}")
    return RoadSource(*read, world, name, is_ours=is_ours)


def _checked(world: Any) -> Mapping[str, Any]:
    if not isinstance(world, dict) or not world.keys() <= {*OF_FILE}:
        raise UsageError(f"its world is not an object with {', '.join(OF_FILE)} or some of them; correct it")
    try:
        World().changed(**world)
    except ValidationError as error:
        raise UsageError(f"its world cannot be read: {first_error(error)}") from error
    return world


def read_road(path: str | Path, geometry: Geometry = "arcs", world: World | None = None) -> Road:
    """Returns the road of a road file, a design file or the folder of a run. ``geometry`` is as for
    ``roadgpt.build``, and ``world`` as for ``made_from``; None for the default World with what the file
    states. Raises UsageError if the file cannot be read, is not valid, or holds no road."""
    source = read_source(path)
    return made_from(source.blueprint, world or World().changed(**source.world), geometry)


def _blueprint_in(data: Any) -> tuple[Design | Road, tuple[str, ...]]:
    if isinstance(data, dict):
        if "network" in data:
            return road_from_json(data), ()
        if is_design(data):
            return read_design(data)
        if "pieces" not in data and ("road_points" in data or "interpolated_points" in data):
            return _test_road(data)
        nodes = data.get("nodes")
        has_widths = isinstance(nodes, list) and plain(nodes)[0] != nodes
        if "pieces" in data or ("nodes" in data and not has_widths):
            return Road.from_json(data), ()
    points, remarks = points_in(data) or (None, ())
    if points is None:
        raise UsageError(f"it holds no road; a road file is {SHAPES}")
    return Road.through(points), remarks


def _test_road(data: dict[str, Any]) -> tuple[Road, tuple[str, ...]]:
    """Returns the road of an SBFT test, with heights if its 3-D points follow its control points."""
    dense, control = data.get("interpolated_points"), data.get("road_points")
    if not (isinstance(dense, list) and dense and isinstance(dense[0], list) and len(dense[0]) == 3):
        points: Any = dense if control is None else control
        points, remarks = plain(points) if isinstance(points, list) else (points, ())
        return Road.through(points), remarks
    road = Road.through(dense, control)
    if road.road_points is None:
        return road, ()
    away, _ = scipy.spatial.cKDTree(road.centreline()[:, :2]).query(road.road_points)
    if np.max(away) <= ASTRAY:
        return road, ()
    return Road.through(road.road_points), (
        "interpolated_points do not follow road_points; the road_points are used, the heights ignored",
    )
