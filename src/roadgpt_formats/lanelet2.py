"""Exports roads and networks as Lanelet2 maps (.osm) with heights: a chain of lanelets for each lane.

Source: Lanelet2, documentation of its primitives and tags; F. Poggenhans et al., Lanelet2: A High-Definition
Map Framework for the Future of Automated Driving, ITSC 2018. Lanelet2's usual UTM projector converts
the geographic coordinates back to the metres of the map."""

from itertools import count, groupby
from math import cos, pi, sin
from pathlib import Path

import numpy as np

from roadgpt.export.ego import Poses
from roadgpt.export.exporters.opendrive.signals import SIGNS
from roadgpt.export.markup import XmlElement
from roadgpt.geometry.curve import Array
from roadgpt.network import Arm, Junction, Network, network_of
from roadgpt.network.markings import line_to_stop_at, place_of_sign
from roadgpt.road import Road, World
from roadgpt.road.profile import Marking
from roadgpt_formats.georeference import degrees
from roadgpt_formats.lanelets import LaneletBound, arms_of, lanelets_of

UTM_SCALE = 0.9996  # scale of lengths at the central meridian of a UTM zone
DEGREE_DECIMALS = 12  # a tenth of a micrometre
SAME = 0.01  # m; ends of bounds that are closer together are one point
TAGS: dict[Marking, dict[str, str]] = {
    "solid": {"type": "line_thin", "subtype": "solid"},
    "broken": {"type": "line_thin", "subtype": "dashed"},
    "double": {"type": "line_thin", "subtype": "solid_solid"},
    "none": {"type": "virtual"},
}
LIGHT = {"type": "traffic_light", "subtype": "red_yellow_green", "height": "0.9"}
SIGN_WIDTH, SIGN_HEIGHT = 0.6, 2.0  # m: width, and height of the lower edge above the road
Cell = tuple[int, int]
KEEP = {"visible": "true", "version": "1"}  # editors of OpenStreetMap refuse files without these


class Lanelet2:
    """Lanelet2 map with heights: each lane as a chain of lanelets, for planners and Autoware."""

    name = "lanelet2"
    suffix = ".osm"
    lacks = ("the land around",)
    holds_junctions = True

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the map. ``poses`` is ignored, because Lanelet2 cannot hold a drive."""
        path.write_bytes(document(road, world).to_text().encode())


def document(road: Road, world: World) -> XmlElement:
    """Returns the XML document of the map.

    Bounds may point against the direction of traffic; programs that read Lanelet2 maps detect this."""
    limits = world.limits
    map_ = _MapBuilder(f"{limits.speed_limit * 3.6:.6g} km/h" if limits.limit_stated else "")
    lanelets = sorted(lanelets_of(road, world), key=lambda each: (each.road, each.section, each.lane))
    ways: dict[LaneletBound, int] = {}
    for _, section in groupby(lanelets, key=lambda each: (each.road, each.section)):
        own = list(section)  # from right to left, as seen along the road
        for each in own:
            for bound in (each.right, each.left)[:: 1 if each.is_along else -1]:
                if bound not in ways:
                    ways[bound] = map_.way(bound.points, TAGS[bound.marking])
        for each in own:
            map_.lanelet(each.id, ways[each.left], ways[each.right])
    network = network_of(road, world)
    for junction, arm, incoming in arms_of(network, lanelets):
        if arm.control != "none":
            map_.signal(network, junction, arm, [each.id for each in incoming])
    root = XmlElement("osm", {"version": "0.6", "generator": "RoadGPT", "upload": "false"})
    return root.extended(*map_.nodes, *map_.ways, *map_.lanelets.values(), *map_.rules)


class _MapBuilder:
    def __init__(self, limit: str) -> None:
        self.nodes: list[XmlElement] = []
        self.ways: list[XmlElement] = []
        self.lanelets: dict[int, XmlElement] = {}
        """The lanelets by the ids that ``lanelets_of`` gives them."""
        self.rules: list[XmlElement] = []
        self._limit = limit
        self._numbers = count(1)
        self._ends: dict[Cell, list[tuple[Array, int]]] = {}
        """The end points of all ways with the ids of their nodes, by the grid cell in which they lie."""

    def way(self, points: Array, tags: dict[str, str]) -> int:
        """Adds a way and returns its id.

        Ways that begin or end at the same point share a node, so that they are connected."""
        begun, ended = self._at(points[0]), self._at(points[-1])
        inner = points[begun is not None : len(points) - (ended is not None)]
        made = self._add_nodes(inner)
        nodes = [*([] if begun is None else [begun]), *made, *([] if ended is None else [ended])]
        for known, point, node in ((begun, points[0], nodes[0]), (ended, points[-1], nodes[-1])):
            if known is None:
                self._ends.setdefault(_cell(point), []).append((point, node))
        return self._way(nodes, tags)

    def _at(self, point: Array) -> int | None:
        """Returns the id of the nearest end node of a way within SAME of a point; None if there is none."""
        cells = {_cell(point + (x, y, 0)) for x in (-SAME, SAME) for y in (-SAME, SAME)}
        ends = [end for cell in cells for end in self._ends.get(cell, ())]
        near = [(float(np.abs(place - point).max()), node) for place, node in ends]
        away, node = min(near, default=(2 * SAME, 0))
        return node if away <= SAME else None

    def _way(self, nodes: list[int], tags: dict[str, str]) -> int:
        number = next(self._numbers)
        own = [XmlElement("nd", {"ref": node}) for node in nodes]
        self.ways.append(_tagged(XmlElement("way", {"id": number, **KEEP}, own), tags))
        return number

    def _add_nodes(self, points: Array) -> list[int]:
        """Adds nodes at degrees, and also in metres, for programs that read local_x and local_y."""
        longitude, latitude = degrees(points[:, 0] / UTM_SCALE, points[:, 1] / UTM_SCALE)
        numbers = [next(self._numbers) for _ in points]
        for number, lon, lat, (x, y, z) in zip(
            numbers, longitude.tolist(), latitude.tolist(), points.tolist(), strict=True
        ):
            place = {"lat": f"{lat:.{DEGREE_DECIMALS}f}", "lon": f"{lon:.{DEGREE_DECIMALS}f}"}
            node = XmlElement("node", {"id": number, **KEEP, **place})
            self.nodes.append(_tagged(node, {"local_x": repr(x), "local_y": repr(y), "ele": repr(z)}))
        return numbers

    def lanelet(self, id_: int, left: int, right: int) -> None:
        """Adds the lanelet ``id_`` of ``lanelets_of``; ``left`` and ``right`` are the ids of its two ways."""
        lanelet = XmlElement("relation", {"id": next(self._numbers), **KEEP})
        for role, way in (("left", left), ("right", right)):
            lanelet.add("member", {"type": "way", "ref": way, "role": role})
        kind = {"type": "lanelet", "subtype": "road", "location": "nonurban", "region": "de"}
        rules = {"one_way": "yes", "participant:vehicle": "yes"}
        rules |= {"speed_limit": self._limit} if self._limit else {}
        self.lanelets[id_] = _tagged(lanelet, kind | rules)

    def signal(self, network: Network, junction: Junction, arm: Arm, incoming: list[int]) -> None:
        """Adds the sign or light of an arm, with its stop line if it has one, as a traffic rule for the
        lanelets with the ids ``incoming`` in ``lanelets_of``."""
        member, heading = network.road(arm.end.road), arm.direction + pi
        foot = member.road.at(*place_of_sign(member, arm.end.contact)) + (0.0, 0.0, SIGN_HEIGHT)
        to_left = np.array([-sin(heading), cos(heading), 0.0]) * SIGN_WIDTH / 2  # as drivers see it
        sign = {"type": "traffic_sign", "subtype": f"de{SIGNS[arm.control][0]}"}
        shown = LIGHT if arm.control == "lights" else sign
        board = self._way(self._add_nodes(np.round([foot + to_left, foot - to_left], 4)), shown)
        rule = XmlElement("relation", {"id": next(self._numbers), **KEEP})
        rule.add("member", {"type": "way", "ref": board, "role": "refers"})
        line = line_to_stop_at(network, junction, arm)
        if line is not None:
            way = self._way(self._add_nodes(np.round(line, 4)), {"type": "stop_line"})
            rule.add("member", {"type": "way", "ref": way, "role": "ref_line"})
        self.rules.append(_tagged(rule, {"type": "regulatory_element", "subtype": shown["type"]}))
        for each in incoming:
            # members must come before the tags
            link = {"type": "relation", "ref": rule.attributes["id"], "role": "regulatory_element"}
            self.lanelets[each].children.insert(2, XmlElement("member", link))


def _cell(point: Array) -> Cell:
    return int(np.floor(point[0])), int(np.floor(point[1]))


def _tagged(element: XmlElement, tags: dict[str, str]) -> XmlElement:
    return element.extended(*(XmlElement("tag", {"k": key, "v": value}) for key, value in tags.items()))
