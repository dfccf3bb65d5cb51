"""Writes a network: its roads, its junctions, roundabouts, signs and lights.

Source: ASAM OpenDRIVE 1.8.1, junctions.
"""

from collections.abc import Iterator, Sequence

from roadgpt.export.exporters.opendrive.boundaries import boundary
from roadgpt.export.exporters.opendrive.roads import REVISION, RoadLink, header, road_element
from roadgpt.export.exporters.opendrive.signals import Signals
from roadgpt.export.markup import XmlElement
from roadgpt.network import Connection, Junction, Network, NetworkRoad, RoadEnd
from roadgpt.road import World

WITH_BOUNDARIES = 8  # first minor revision in which a junction has a boundary


def network_document(network: Network, world: World, revision: int = REVISION) -> XmlElement:
    """Returns the XML document of a network.

    Args:
        network: The network.
        world: The World, which gives the speed limit and the friction.
        revision: The minor revision of OpenDRIVE 1: 7, or 8 with the boundaries of junctions.
    """
    (west, south), (east, north) = network.bounds()
    reach = max(each.profile.reach - each.profile.paved_reach for each in network.roads)
    bounds = (west - reach, south - reach, east + reach, north + reach)
    signals = Signals.of(network)
    root = XmlElement("OpenDRIVE").extended(header(bounds, revision))
    for member in network.roads:
        root.extended(_road(network, member, world).extended(*signals.on_road(member.id)))
    root.extended(*signals.controllers())
    for junction in network.junctions:
        made = XmlElement("junction", {"id": str(junction.id), "name": f"junction {junction.id}"})
        made.extended(*_connections(junction), *signals.of_junction(junction.id))
        if revision >= WITH_BOUNDARIES:
            made.extended(boundary(network, junction))
        root.extended(made)
    return root.extended(*_groups(network))


def _road(network: Network, member: NetworkRoad, world: World) -> XmlElement:
    found = network.connection_of.get(member.id)
    if found is None:
        return road_element(member.road, member.id, world, list(_links(network, member)))
    connection = found[1]
    links = [
        _to_road("predecessor", connection.incoming),
        _to_road("successor", connection.outgoing),
    ]
    return road_element(member.road, member.id, world, links, found[0].id, _lane_links(connection))


def _links(network: Network, member: NetworkRoad) -> Iterator[RoadLink]:
    """Yields the links of a road outside junctions."""
    for name, end in (("predecessor", RoadEnd(member.id, "start")), ("successor", RoadEnd(member.id, "end"))):
        if (junction := network.junction_at.get(end)) is not None:
            yield name, {"elementType": "junction", "elementId": str(junction)}


def _to_road(name: str, end: RoadEnd) -> RoadLink:
    return name, {"elementType": "road", "elementId": str(end.road), "contactPoint": end.contact}


def _lane_links(connection: Connection) -> dict[int, tuple[int, int]]:
    """Returns the lanes before and after each lane of a connecting road."""
    sign = -1 if connection.outgoing.contact == "start" else 1
    return {own: (before, sign * abs(own)) for before, own in connection.lanes}


def _connections(junction: Junction) -> Iterator[XmlElement]:
    for number, each in enumerate(junction.connections):
        made = XmlElement(
            "connection",
            {
                "id": str(number),
                "incomingRoad": str(each.incoming.road),
                "connectingRoad": str(each.road),
                "contactPoint": "start",
            },
        )
        for before, own in each.lanes:
            made.add("laneLink", {"from": before, "to": own})
        yield made


def _groups(network: Network) -> Iterator[XmlElement]:
    """Yields a group of junctions for each roundabout."""
    for number, ring in enumerate(network.roundabouts, 1):
        group = XmlElement(
            "junctionGroup", {"name": f"roundabout {number}", "id": str(number), "type": "roundabout"}
        )
        yield group.extended(*_references(ring.junctions))


def _references(junctions: Sequence[int]) -> Iterator[XmlElement]:
    for number in junctions:
        yield XmlElement("junctionReference", {"junction": str(number)})
