"""Exports roads and networks as ASAM OpenDRIVE 1.8. Version 1.7 also defines all elements that are
written, except the boundaries of junctions.

Source: ASAM OpenDRIVE 1.8.1, user guide and XML schema."""

import json
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path

from roadgpt.export.ego import Poses
from roadgpt.export.exporters.opendrive.boundaries import boundary
from roadgpt.export.exporters.opendrive.lanes import LaneLinks, RoadParts, lateral_profile
from roadgpt.export.exporters.opendrive.reference_line import Start, bounds_of, geometries, reaches, starts_of
from roadgpt.export.exporters.opendrive.signals import Signals
from roadgpt.export.georeference import PROJECTION
from roadgpt.export.markup import XmlElement
from roadgpt.geometry import PieceCurve
from roadgpt.network import Junction, Network, NetworkRoad, RoadEnd, Route
from roadgpt.road import Road, World

__all__ = ["ROAD", "OpenDrive", "document"]

ROUTE = ".route.json"
"""Suffix of the file that names the roads and lanes of a route: ``{"route": [[road, lane], ...]}``."""
REVISION = 8  # ASAM OpenDRIVE 1.8
WITH_BOUNDARIES = 8  # first minor revision in which a junction has a boundary
ROAD = 1  # id of the road if the file has only one


class OpenDrive:
    """ASAM OpenDRIVE 1.8 with exact lines, arcs, spirals and parabolas, or fitted cubics for a spline."""

    name = "opendrive"
    suffix = ".xodr"
    holds_junctions = True
    revision = REVISION

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the file, and beside it, with the suffix ``.route.json``, the roads and lanes to drive, in
        driving order. For a map without a route, this is an empty list.

        ``poses`` is ignored, because OpenDRIVE cannot hold a drive."""
        path.write_bytes(document(road, world, self.revision).to_text().encode())
        if isinstance(road, Route):
            legs = road.to_route_json()
        else:
            profile = world.profile_of(road)
            legs = {"route": [[ROAD, profile.along_ids[profile.driven]]]}
        path.with_suffix(ROUTE).write_text(json.dumps(legs) + "\n")


def document(road: Road, world: World, revision: int = REVISION) -> XmlElement:
    """Returns the XML document of a road, or of the network of a route. ``revision`` is the minor one of
    OpenDRIVE 1: 7, or 8 with the boundaries of junctions.

    If a number of the road is not finite, ``to_text`` of the document raises ExportError."""
    if isinstance(road, Route):
        return _network_document(road.network, world, revision)
    x, y = road.centreline()[:, :2].T
    reach = world.profile_of(road).reach
    bounds = (x.min() - reach, y.min() - reach, x.max() + reach, y.max() + reach)
    return XmlElement("OpenDRIVE").extended(_header(bounds, revision), _road(road, ROAD, RoadParts(world)))


def _header(bounds: Sequence[float], revision: int) -> XmlElement:
    """Returns the header, without a date; bounds are west, south, east and north of the lanes, in metres."""
    west, south, east, north = (round(float(value), 3) for value in bounds)
    made = XmlElement(
        "header",
        {
            "revMajor": 1,
            "revMinor": revision,
            "name": "road",
            "version": "1",
            "north": north,
            "south": south,
            "east": east,
            "west": west,
            "vendor": "RoadGPT",
        },
    )
    made.add("geoReference", raw=f"<![CDATA[{PROJECTION}]]>")
    return made


def _road(
    road: Road,
    number: int,
    parts: RoadParts,
    links: Iterable[XmlElement] | None = None,
    junction: int = -1,
    lane_links: LaneLinks | None = None,
    starts: Sequence[Start] | None = None,
) -> XmlElement:
    """Returns the element ``road`` with its geometry and its lanes.

    Args:
        road: The road.
        number: The id of the road.
        parts: Creates the elements that the roads of the file share.
        links: The elements ``predecessor`` and ``successor``; None for a single road.
        junction: The id of the junction to which a connecting road belongs; -1 for any other road.
        lane_links: The links from lanes of the road to lanes of other roads.
        starts: The starts of the pieces of the reference line; None if they have not been computed yet."""
    body = XmlElement(
        "road",
        {
            "name": "road" if links is None else f"road {number}",
            "length": road.length,
            "id": str(number),
            "junction": str(junction),
            "rule": "LHT" if parts.world.profile_of(road).left_hand else "RHT",
        },
    )
    if links is not None:
        body.add("link").extended(*links)
    body.extended(parts.road_type)
    body.add("planView").extended(*geometries(road.plan, starts))
    lanes = parts.lanes(road, lane_links, is_inside=junction >= 0)
    return body.extended(parts.heights(road), *lateral_profile(road), lanes)


def _network_document(network: Network, world: World, revision: int) -> XmlElement:
    starts = starts_of([_curve(each) for each in network.roads])
    bounds = bounds_of(starts, [reaches(each.profile) for each in network.roads])
    signals, parts = Signals(network), RoadParts(world)
    root = XmlElement("OpenDRIVE").extended(_header(bounds, revision))
    for member, own in zip(network.roads, starts, strict=True):
        links, inside, lane_links = _place(network, member)
        made = _road(
            member.road, member.id, parts, links=links, junction=inside, lane_links=lane_links, starts=own
        )
        root.extended(made.extended(*signals.on_road(member.id)))
    root.extended(*signals.controllers())
    for junction in network.junctions:
        made = XmlElement("junction", {"id": str(junction.id), "name": f"junction {junction.id}"})
        made.extended(*_connections(junction), *signals.of_junction(junction.id))
        if revision >= WITH_BOUNDARIES:
            made.extended(boundary(network, junction))
        root.extended(made)
    for n, ring in enumerate(network.roundabouts, 1):
        group = root.add("junctionGroup", {"name": f"roundabout {n}", "id": str(n), "type": "roundabout"})
        for inside in ring.junctions:
            group.add("junctionReference", {"junction": str(inside)})
    return root


def _curve(member: NetworkRoad) -> PieceCurve:
    assert isinstance(member.road.plan, PieceCurve)
    return member.road.plan


def _place(network: Network, member: NetworkRoad) -> tuple[Iterable[XmlElement], int, LaneLinks]:
    """Returns where a road is in its network: ``links``, ``junction`` and ``lane_links`` as in ``_road``."""
    found = network.connection_of.get(member.id)
    if found is None:
        return _links(network, member), -1, _continued_lanes(network, member)
    junction, way = found
    links = _to_road("predecessor", way.incoming), _to_road("successor", way.outgoing)
    return links, junction.id, {own: (before, after) for before, own, after in way.lanes}


def _links(network: Network, member: NetworkRoad) -> Iterator[XmlElement]:
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
    before: dict[int, int] = {}
    after: dict[int, int] = {}
    for end, links in ((RoadEnd(member.id, "start"), before), (RoadEnd(member.id, "end"), after)):
        if (found := network.continued_at.get(end)) is not None:
            links |= {b: a for a, b in found.lanes} if found.after == end else dict(found.lanes)
    return {lane: (before.get(lane), after.get(lane)) for lane in {*before, *after}}


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
