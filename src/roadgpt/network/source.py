"""Reads roads, routes and designs from files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from roadgpt.network.blueprint import AnyDesign, Blueprint
from roadgpt.network.design import is_network_design, read_network_design
from roadgpt.network.map_design import has_nodes, read_map_design
from roadgpt.network.road_or_route import made_from, road_from_json
from roadgpt.road import Geometry, Road, World, read_design
from roadgpt.road.source import read_blueprint as read_road_blueprint


def read_blueprint(path: str | Path) -> tuple[Blueprint, tuple[str, ...]]:
    """Returns the design or the road in a file, and remarks on the file.

    Each remark is a sentence about something in the file that was changed, ignored or unusual.

    Raises:
        UsageError: The file cannot be read, is not valid, or holds no road.
    """
    return read_road_blueprint(path, _of_network)


def _of_network(data: Any) -> tuple[Blueprint, tuple[str, ...]] | None:
    """Returns the design with junctions, the map or the route in parsed JSON; None if it holds none."""
    if is_network_design(data) or has_nodes(data):
        return read_any_design(data)
    if isinstance(data, Mapping) and "network" in data:
        return road_from_json(data), ()
    return None


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
