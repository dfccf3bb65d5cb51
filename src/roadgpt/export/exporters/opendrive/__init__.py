"""Exports roads and networks as ASAM OpenDRIVE 1.8. Version 1.7 also defines all elements that are
written, except the boundaries of junctions.

Source: ASAM OpenDRIVE 1.8.1, user guide and XML schema."""

import json
from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path

from roadgpt import plugins
from roadgpt.export.ego import Poses
from roadgpt.export.exporters.opendrive.boundaries import boundary
from roadgpt.export.exporters.opendrive.lanes import LaneLinks, RoadParts, lateral_profile
from roadgpt.export.exporters.opendrive.reference_line import Start, bounds_of, geometries, reaches, starts_of
from roadgpt.export.exporters.opendrive.signals import Signals
from roadgpt.export.markup import Value, XmlElement
from roadgpt.geometry import PieceCurve
from roadgpt.network import Junction, Network, NetworkRoad, RoadEnd, legs_of, network_of, only_road
from roadgpt.network.landscape import ground_around
from roadgpt.road import Road, World

__all__ = ["LATITUDE", "LONGITUDE", "OpenDrive", "document"]

LATITUDE, LONGITUDE = 48.0, 9.0  # degrees, of the corner (0, 0)
PROJECTION = f"+proj=tmerc +lat_0={LATITUDE:g} +lon_0={LONGITUDE:g} +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m"
"""A geographic position of the map, as a PROJ string without +no_defs, which some programs do not understand.
It is arbitrary; 9 E is the centre of a UTM zone, so north on the map is also grid north."""
ROUTE, GROUND = ".route.json", ".ground.glb"
"""Suffix of the file that names the roads and lanes of a route: ``{"route": [[road, lane], ...]}``."""
REVISION = 8  # ASAM OpenDRIVE 1.8
WITH_BOUNDARIES = 8  # first minor revision in which a junction has a boundary


class OpenDrive:
    """ASAM OpenDRIVE 1.8 with exact lines, arcs, spirals and parabolas, or fitted cubics for a spline."""

    name = "opendrive"
    suffix = ".xodr"
    holds_junctions = True
    revision = REVISION

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the file, and beside it, with the suffix ``.route.json``, the roads and lanes to drive, in
        driving order. For a map without a route, this is an empty list. Land, which the format does not hold,
        is written beside it as a mesh, with the suffix ``.ground.glb``.

        ``poses`` is ignored, because OpenDRIVE cannot hold a drive."""
        path.write_bytes(document(road, world, self.revision).to_text().encode())
        if world.has_ground:
            land = plugins.find("exporters", "gltf")().land(road, world)
            path.with_suffix(GROUND).write_bytes(land)
        path.with_suffix(ROUTE).write_text(json.dumps({"route": legs_of(road, world)}) + "\n")


def document(road: Road, world: World, revision: int = REVISION) -> XmlElement:
    """Returns the XML document of the network of a road or a route. ``revision`` is the minor one of
    OpenDRIVE 1: 7, or 8 with the boundaries of junctions.

    If a number of the road is not finite, ``to_text`` of the document raises ExportError."""
    network, only = network_of(road, world), only_road(road, world)
    spans = ground_around(road, world).pavement.spans if world.has_ground else ()
    signals, parts = Signals(network, spans), RoadParts(world)
    if only is None:
        plans = [each.road.plan for each in network.roads]
        starts: list[list[Start] | None] = [
            *starts_of([each for each in plans if isinstance(each, PieceCurve)])
        ]
        bounds = bounds_of(
            [each for each in starts if each], [reaches(each.profile) for each in network.roads]
        )
    else:
        x, y, reach = *only.road.centreline()[:, :2].T, only.profile.reach
        starts, bounds = [None], (x.min() - reach, y.min() - reach, x.max() + reach, y.max() + reach)
    root = XmlElement("OpenDRIVE").extended(_header(bounds, revision))
    for member, own in zip(network.roads, starts, strict=True):
        made = _road(network, member, parts, own, is_only=only is not None)
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


def _header(bounds: Sequence[float], revision: int) -> XmlElement:
    """Returns the header, without a date; bounds are west, south, east and north of the lanes, in metres."""
    west, south, east, north = (round(float(value), 3) for value in bounds)
    box = {"north": north, "south": south, "east": east, "west": west}
    about: dict[str, Value] = {"revMajor": 1, "revMinor": revision, "name": "road", "version": "1"}
    made = XmlElement("header", {**about, **box, "vendor": "RoadGPT"})
    return made.with_texts(geoReference=f"<![CDATA[{PROJECTION}]]>")


def _road(
    network: Network, member: NetworkRoad, parts: RoadParts, starts: Sequence[Start] | None, is_only: bool
) -> XmlElement:
    """Returns the element ``road``. ``starts`` are those of the pieces of the reference line; None if they
    have not been computed yet."""
    road, junction = member.road, -1 if member.junction is None else member.junction
    name, rule = "road" if is_only else f"road {member.id}", "LHT" if member.profile.left_hand else "RHT"
    own: dict[str, Value] = {"name": name, "length": road.length, "id": str(member.id)}
    body = XmlElement("road", {**own, "junction": str(junction), "rule": rule})
    if not is_only:
        body.add("link").extended(*_links(network, member))
    body.extended(parts.road_type)
    body.add("planView").extended(*geometries(road.plan, starts))
    lanes = parts.lanes(road, _lane_links(network, member), is_inside=junction >= 0)
    return body.extended(parts.heights(road), *lateral_profile(road), lanes)


def _links(network: Network, member: NetworkRoad) -> Iterator[XmlElement]:
    way = network.connection_of.get(member.id)
    if way is not None:
        yield _to_road("predecessor", way[1].incoming)
        yield _to_road("successor", way[1].outgoing)
        return
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


def _lane_links(network: Network, member: NetworkRoad) -> LaneLinks:
    if (way := network.connection_of.get(member.id)) is not None:
        return {own: (before, after) for before, own, after in way[1].lanes}
    before: dict[int, int] = {}
    after: dict[int, int] = {}
    for end, links in ((RoadEnd(member.id, "start"), before), (RoadEnd(member.id, "end"), after)):
        if (found := network.continued_at.get(end)) is not None:
            links |= {b: a for a, b in found.lanes} if found.after == end else dict(found.lanes)
    return {lane: (before.get(lane), after.get(lane)) for lane in {*before, *after}}


def _connections(junction: Junction) -> Iterator[XmlElement]:
    for number, each in enumerate(junction.connections):
        roads = {"incomingRoad": str(each.incoming.road), "connectingRoad": str(each.road)}
        links = [XmlElement("laneLink", {"from": before, "to": own}) for before, own, _ in each.lanes]
        yield XmlElement("connection", {"id": str(number), **roads, "contactPoint": "start"}, links)
