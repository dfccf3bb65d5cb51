"""Joins roads to networks, with junctions, roundabouts and routes. Main function: ``build_route``.

A Design describes a route with the junctions that it passes, or a map and a route through the map, or none;
``build_route`` makes a Route from it. A Route is a Road whose centre line follows the reference lines of its
roads, one after another. ``route.network`` is the Network, with all roads, connecting roads, junctions and
roundabouts.

Most roads lead through no junctions. The functions of ``road_or_route``, which are used for all roads, are
loaded at once. The modules that build and describe networks are loaded when a name in them is first used."""

from typing import TYPE_CHECKING, Any

from roadgpt.later import load, names_of
from roadgpt.network.road_or_route import (
    is_route,
    legs_of,
    made_from,
    network_of,
    only_road,
    refuse_other_lane,
    refuse_without_route,
    road_from_json,
)

if TYPE_CHECKING:
    from roadgpt.network.growing import build_route
    from roadgpt.network.maps import ImportedMap, ImportedRoad, read_map, read_opendrive
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
    from roadgpt.network.source import read_road, read_source

_OFFERED = {
    "growing": "build_route",
    "maps": "ImportedMap ImportedRoad read_map read_opendrive",
    "network": "Arm Connection Continuation Junction LaneLink Leg Network NetworkRoad RoadEnd Roundabout",
    "road_or_route": "is_route legs_of made_from network_of only_road refuse_other_lane "
    "refuse_without_route road_from_json",
    "route": "Passage Route",
    "source": "read_road read_source",
}
__all__ = names_of(_OFFERED)


def __getattr__(name: str) -> Any:
    return load(__name__, _OFFERED, name)
