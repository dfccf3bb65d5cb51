"""Names what a road can be made from, and makes networks from designs."""

from roadgpt.network.design import NetworkDesign
from roadgpt.network.growing import build_route
from roadgpt.network.map_design import MapDesign
from roadgpt.network.map_growing import build_map
from roadgpt.network.route import Route
from roadgpt.road import Design, Road, World

AnyDesign = Design | NetworkDesign | MapDesign
"""A design of a road, of a route through junctions, or of a map with one route."""
Blueprint = AnyDesign | Road
"""Anything from which ``made_from`` makes a road."""


def network_made_from(design: NetworkDesign | MapDesign, world: World) -> Route:
    """Returns the route of a design with junctions or of a map; ``Route.on_ground`` is not applied to it.

    Raises:
        UsageError: The design cannot be built; see ``build_route`` and ``build_map``.
    """
    return build_map(design, world) if isinstance(design, MapDesign) else build_route(design, world)
