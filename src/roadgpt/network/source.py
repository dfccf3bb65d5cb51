"""Reads roads, routes and designs from files, and makes roads from all kinds of designs."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from roadgpt.errors import UsageError
from roadgpt.network.design import NetworkDesign, is_network_design, read_network_design
from roadgpt.network.growing import build_route
from roadgpt.network.map_design import MapDesign, has_nodes, read_map_design
from roadgpt.network.map_growing import build_map
from roadgpt.network.network_json import legs_from_json, network_from_json
from roadgpt.network.route import Route
from roadgpt.road import Design, Geometry, Road, World, build, read_design
from roadgpt.road.source import read_blueprint as read_road_blueprint

AnyDesign = Design | NetworkDesign | MapDesign
"""A design of a road, of a route through junctions, or of a map with one route."""
Blueprint = AnyDesign | Road
"""Anything from which ``made_from`` makes a road."""


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


def made_from(blueprint: Blueprint, world: World, geometry: Geometry = "arcs") -> Road:
    """Returns the road that a blueprint describes, with lanes and banked bends of a World if it has none.

    Args:
        blueprint: A design with or without junctions, a map, or a road.
        world: The World, which gives the lanes where the blueprint has none.
        geometry: How a design without junctions becomes a road.

    Raises:
        UsageError: The road is too long, or ``geometry`` is not "arcs" for a design with junctions or a map;
            see also ``build_route`` and ``build_map``.
    """
    if isinstance(blueprint, (NetworkDesign, MapDesign)):
        if geometry != "arcs":
            raise UsageError("a route with junctions is built from arcs; leave out --geometry spline")
        return network_made_from(blueprint, world).on_ground()
    return world.lay(build(blueprint, geometry) if isinstance(blueprint, Design) else blueprint)


def network_made_from(design: NetworkDesign | MapDesign, world: World) -> Route:
    """Returns the route of a design with junctions or of a map; ``Route.on_ground`` is not applied to it.

    Raises:
        UsageError: The design cannot be built; see ``build_route`` and ``build_map``.
    """
    return build_map(design, world) if isinstance(design, MapDesign) else build_route(design, world)


def road_from_json(data: Mapping[str, Any]) -> Road:
    """Restores a road or a route from JSON data as returned by ``Road.to_json`` or ``Route.to_json``.

    A route gets shoulders to the edge of the ground; see ``Route.on_ground``.

    Raises:
        UsageError: A field is missing or of the wrong type, a number is not finite, the road is too long or
            too steep, or the route does not fit its network.
    """
    if "network" not in data:
        return Road.from_json(data)
    network = network_from_json(data["network"])
    return Route.along(network, legs_from_json(data.get("route"))).on_ground()
