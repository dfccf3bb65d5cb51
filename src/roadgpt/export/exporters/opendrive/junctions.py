"""Writes a network: roads, junctions, roundabouts, signs and lights.

Source: ASAM OpenDRIVE 1.8.1, junctions.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache

from roadgpt.export.exporters.opendrive.boundaries import boundary
from roadgpt.export.exporters.opendrive.extent import bounds_of, reaches
from roadgpt.export.exporters.opendrive.lanes import LaneLinks, RoadParts
from roadgpt.export.exporters.opendrive.plan import Start, starts_of
from roadgpt.export.exporters.opendrive.roads import REVISION, RoadPlace, header, road_element
from roadgpt.export.exporters.opendrive.signals import Signals
from roadgpt.export.markup import XmlElement
from roadgpt.geometry import PieceCurve
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
    starts = starts_of([_curve(each) for each in network.roads])
    bounds = bounds_of(starts, [reaches(each.profile) for each in network.roads])
    signals, parts = Signals.of(network), RoadParts(world)
    root = XmlElement("OpenDRIVE").extended(header(bounds, revision))
    for member, own in zip(network.roads, starts, strict=True):
        made = road_element(member.road, member.id, parts, _place(network, member, own))
        root.extended(made.extended(*signals.on_road(member.id)))
    root.extended(*signals.controllers())
    for junction in network.junctions:
        made = XmlElement("junction", {"id": str(junction.id), "name": f"junction {junction.id}"})
        made.extended(*_connections(junction), *signals.of_junction(junction.id))
        if revision >= WITH_BOUNDARIES:
            made.extended(boundary(network, junction))
        root.extended(made)
    return root.extended(*_groups(network))


def _curve(member: NetworkRoad) -> PieceCurve:
    assert isinstance(member.road.plan, PieceCurve)
    return member.road.plan


def _place(network: Network, member: NetworkRoad, starts: Sequence[Start]) -> RoadPlace:
    """Returns where a road is in its network: its links, and the starts of its lines, arcs and spirals."""
    found = network.connection_of.get(member.id)
    if found is None:
        lanes = _continued_lanes(network, member)
        return RoadPlace(tuple(_links(network, member)), lane_links=lanes, starts=starts)
    connection = found[1]
    links = (_to_road("predecessor", connection.incoming), _to_road("successor", connection.outgoing))
    return RoadPlace(links, found[0].id, _lane_links(connection), starts)


def _links(network: Network, member: NetworkRoad) -> Iterator[XmlElement]:
    """Yields the links of a road outside junctions."""
    for name, end in (("predecessor", RoadEnd(member.id, "start")), ("successor", RoadEnd(member.id, "end"))):
        if (junction := network.junction_at.get(end)) is not None:
            yield XmlElement(name, {"elementType": "junction", "elementId": str(junction)})
        elif (found := network.continued_at.get(end)) is not None:
            yield _to_road(name, found.after if found.before == end else found.before)


@lru_cache(maxsize=1024)
def _to_road(name: str, end: RoadEnd) -> XmlElement:
    """Returns the link to the end of a road. All roads that are joined to this end share the element."""
    link = {"elementType": "road", "elementId": str(end.road), "contactPoint": end.contact}
    return XmlElement(name, link, is_shared=True)


def _continued_lanes(network: Network, member: NetworkRoad) -> LaneLinks:
    """Returns the links from the lanes of a road to the lanes that continue them outside junctions."""
    before: dict[int, int] = {}
    after: dict[int, int] = {}
    for end, links in ((RoadEnd(member.id, "start"), before), (RoadEnd(member.id, "end"), after)):
        if (found := network.continued_at.get(end)) is not None:
            links |= {b: a for a, b in found.lanes} if found.after == end else dict(found.lanes)
    return {lane: (before.get(lane), after.get(lane)) for lane in {*before, *after}}


def _lane_links(connection: Connection) -> dict[int, tuple[int, int]]:
    """Returns the lanes before and after each lane of a connecting road."""
    return {own: (before, after) for before, own, after in connection.lanes}


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
        for before, own, _ in each.lanes:
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
