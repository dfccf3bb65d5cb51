"""Joins roads to networks, with junctions, roundabouts and routes. Main function: ``build_route``.

A NetworkDesign describes a route with the junctions that it passes; ``build_route`` makes a Route from it. A
MapDesign describes a whole map and a route through the map, or none; ``build_map`` makes a Route from it. A
Route is a Road whose centre line follows the reference lines of its roads, one after another.
``route.network`` is the Network, with all roads, connecting roads, junctions and roundabouts.

Most roads lead through no junctions. The functions of ``road_or_route``, which are used for all roads, are
loaded at once. The modules that build and describe networks are loaded when a name in them is first used."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from roadgpt.network.road_or_route import (
    has_no_route,
    is_route,
    made_from,
    refuse_without_route,
    road_from_json,
)

if TYPE_CHECKING:
    from roadgpt.network.design import JunctionDesign, NetworkDesign, is_network_design, read_network_design
    from roadgpt.network.growing import build_map, build_route, network_made_from, passing_length
    from roadgpt.network.map_design import AnyDesign, Blueprint, MapDesign, MapNode, read_map_design
    from roadgpt.network.network import (
        Arm,
        Connection,
        Continuation,
        Junction,
        LaneLink,
        Leg,
        Network,
        NetworkRoad,
        RoadEnd,
        Roundabout,
    )
    from roadgpt.network.route import Passage, Route
    from roadgpt.network.source import read_any_design, read_road, read_source

__all__ = [
    "AnyDesign",
    "Arm",
    "Blueprint",
    "Connection",
    "Continuation",
    "Junction",
    "JunctionDesign",
    "LaneLink",
    "Leg",
    "MapDesign",
    "MapNode",
    "Network",
    "NetworkDesign",
    "NetworkRoad",
    "Passage",
    "RoadEnd",
    "Roundabout",
    "Route",
    "build_map",
    "build_route",
    "has_no_route",
    "is_network_design",
    "is_route",
    "made_from",
    "network_made_from",
    "passing_length",
    "read_any_design",
    "read_map_design",
    "read_network_design",
    "read_road",
    "read_source",
    "refuse_without_route",
    "road_from_json",
]

_LATER = {
    "design": "JunctionDesign NetworkDesign is_network_design read_network_design",
    "growing": "build_map build_route network_made_from passing_length",
    "map_design": "AnyDesign Blueprint MapDesign MapNode read_map_design",
    "network": "Arm Connection Continuation Junction LaneLink Leg Network NetworkRoad RoadEnd Roundabout",
    "route": "Passage Route",
    "source": "read_any_design read_road read_source",
}
"""The names that are loaded when they are first used, by the module that defines them."""


def __getattr__(name: str) -> Any:
    for module, names in _LATER.items():
        if name in names.split():
            return getattr(import_module(f"roadgpt.network.{module}"), name)
    raise AttributeError(f"roadgpt.network has no '{name}'; it offers {', '.join(__all__)}")
