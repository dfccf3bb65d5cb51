"""Tells single roads and Routes apart, and makes a road from anything that describes one.

The packages that drive, judge and draw roads use these functions. Importing this module loads no module that
builds or describes networks; a single road needs none of those modules."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from roadgpt.errors import UsageError
from roadgpt.road import Design, Geometry, Road, World, build

if TYPE_CHECKING:
    from typing_extensions import TypeIs

    from roadgpt.network.map_design import Blueprint
    from roadgpt.network.route import Route


def is_route(road: Road) -> "TypeIs[Route]":
    """Returns whether a road is a Route: the network of a map, or a way through its junctions."""
    return road.is_route


def has_no_route(road: Road) -> bool:
    """Returns whether a road is a network through which no route was asked for."""
    return is_route(road) and not road.legs


def refuse_without_route(road: Road, what: str) -> None:
    """Raises UsageError if no route was asked for; ``what`` says what cannot be done then, as in "driven"."""
    if has_no_route(road):
        raise UsageError(
            f"a map without a route cannot be {what}; give it one, the nodes in driving order, such as "
            '"route": [1, 2, 4]'
        )


def made_from(blueprint: "Blueprint", world: World, geometry: Geometry = "arcs") -> Road:
    """Returns the road that a blueprint describes. The World gives the lanes and banked bends that it lacks;
    ``geometry`` says how a design without junctions becomes a road. Raises UsageError if the road is too
    long, or ``geometry`` is not "arcs" for a design with junctions or a map; see also ``build_route`` and
    ``build_map``."""
    if isinstance(blueprint, Design):
        return world.lay(build(blueprint, geometry))
    if isinstance(blueprint, Road):
        return world.lay(blueprint)
    from roadgpt.network.growing import network_made_from

    if geometry != "arcs":
        raise UsageError("a route with junctions is built from arcs; leave out --geometry spline")
    return network_made_from(blueprint, world).on_ground()


def road_from_json(data: Mapping[str, Any]) -> Road:
    """Restores a road or a route from JSON data as returned by ``to_json``. A route gets shoulders to the
    edge of the ground; see ``Route.on_ground``. Raises UsageError if a field is missing or of the wrong type,
    a number is not finite, the road is too long or too steep, or the route does not fit its network."""
    if "network" not in data:
        return Road.from_json(data)
    from roadgpt.network.network import legs_from_json, network_from_json
    from roadgpt.network.route import Route

    return Route.along(network_from_json(data["network"]), legs_from_json(data.get("route"))).on_ground()
