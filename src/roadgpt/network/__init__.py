"""Joins roads to networks, with junctions, roundabouts and routes. Main function: ``build_route``.

A NetworkDesign describes a route with the junctions that it passes; ``build_route`` makes a Route from it. A
MapDesign describes a whole map and a route through the map, or none; ``build_map`` makes a Route from it. A
Route is a Road whose centre line follows the reference lines of its roads, one after another.
``route.network`` is the Network, with all roads, connecting roads, junctions and roundabouts.
"""

from roadgpt.network.design import JunctionDesign, NetworkDesign, is_network_design, read_network_design
from roadgpt.network.growing import build_route, passing_length
from roadgpt.network.map_design import MapDesign, MapNode, read_map_design
from roadgpt.network.map_growing import build_map
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
from roadgpt.network.passages import Passage
from roadgpt.network.route import Route, has_no_route, refuse_without_route
from roadgpt.network.source import (
    AnyDesign,
    Blueprint,
    made_from,
    network_made_from,
    read_any_design,
    read_blueprint,
    read_road,
    road_from_json,
)

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
    "made_from",
    "network_made_from",
    "passing_length",
    "read_any_design",
    "read_blueprint",
    "read_map_design",
    "read_network_design",
    "read_road",
    "refuse_without_route",
    "road_from_json",
]
