"""Exports roads as Lanelet2 maps (.osm) with heights: a chain of lanelets for each lane.

Source: Lanelet2, documentation of its primitives and tags; F. Poggenhans et al., Lanelet2: A High-Definition
Map Framework for the Future of Automated Driving, ITSC 2018. Lanelet2's usual UTM projector converts
the geographic coordinates back to the metres of the map.
"""

from itertools import count
from pathlib import Path

from roadgpt.export.georeference import degrees
from roadgpt.export.lanelets import lanelet_sections
from roadgpt.export.markup import XmlElement
from roadgpt.export.poses import Poses
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.road.profile import Marking

UTM_SCALE = 0.9996  # of lengths in the middle of a UTM zone
DEGREE_DECIMALS = 12  # a tenth of a micrometre
TAGS = {
    "solid": {"type": "line_thin", "subtype": "solid"},
    "broken": {"type": "line_thin", "subtype": "dashed"},
    "none": {"type": "virtual"},
}
KEEP = {"visible": "true", "version": "1"}  # editors of OpenStreetMap refuse files without these


class Lanelet2:
    """Lanelet2 map with heights: each lane as a chain of lanelets, for planners and Autoware."""

    name = "lanelet2"
    suffix = ".osm"

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the map. ``poses`` is ignored, because Lanelet2 cannot hold a drive."""
        path.write_bytes(document(road, world).to_text().encode())


def document(road: Road, world: World) -> XmlElement:
    """Returns the XML document of the map.

    Bounds may point against the direction of traffic; programs that read Lanelet2 maps detect this.

    Raises:
        ExportError: The road has a number that is not finite.
    """
    map_ = _MapBuilder()
    limit = f"{world.limits.speed_limit * 3.6:.6g} km/h"
    for section in lanelet_sections(road, world):
        ways = {bound: map_.way(bound.points, bound.marking) for bound in section.bounds}
        for lane in section.lanes:
            inner, outer = section.bounds_of(lane)
            map_.lanelet(ways[inner], ways[outer], limit)
    root = XmlElement("osm", {"version": "0.6", "generator": "RoadGPT", "upload": "false"})
    return root.extended(*map_.nodes, *map_.ways, *map_.lanelets)


class _MapBuilder:
    """Collects nodes, ways and lanelets, each with a number of its own."""

    def __init__(self) -> None:
        self.nodes: list[XmlElement] = []
        self.ways: list[XmlElement] = []
        self.lanelets: list[XmlElement] = []
        self._numbers = count(1)
        self._ends: dict[tuple[float, ...], int] = {}

    def way(self, points: Array, marking: Marking) -> int:
        """Adds a way for the bound of a lane and returns its id.

        Ways that begin or end at the same point share a node, so that they are connected.
        """
        first, last = (tuple(points[n].tolist()) for n in (0, -1))
        known = [self._ends[first]] if first in self._ends else []
        nodes = [*known, *self._add_nodes(points[len(known) :])]
        self._ends.setdefault(first, nodes[0])
        self._ends[last] = nodes[-1]
        number = next(self._numbers)
        way = XmlElement("way", {"id": number, **KEEP})
        for node in nodes:
            way.add("nd", {"ref": node})
        self.ways.append(_tagged(way, TAGS[marking]))
        return number

    def _add_nodes(self, points: Array) -> list[int]:
        """Adds nodes with positions in degrees, and also in metres, for programs that read local_x and
        local_y; returns the ids of the nodes."""
        longitude, latitude = degrees(points[:, 0] / UTM_SCALE, points[:, 1] / UTM_SCALE)
        numbers = [next(self._numbers) for _ in points]
        for number, lon, lat, (x, y, z) in zip(
            numbers, longitude.tolist(), latitude.tolist(), points.tolist(), strict=True
        ):
            place = {"lat": f"{lat:.{DEGREE_DECIMALS}f}", "lon": f"{lon:.{DEGREE_DECIMALS}f}"}
            node = XmlElement("node", {"id": number, **KEEP, **place})
            self.nodes.append(_tagged(node, {"local_x": repr(x), "local_y": repr(y), "ele": repr(z)}))
        return numbers

    def lanelet(self, left: int, right: int, limit: str) -> None:
        """Adds the lanelet between two ways, given by their ids."""
        lanelet = XmlElement("relation", {"id": next(self._numbers), **KEEP})
        for role, way in (("left", left), ("right", right)):
            lanelet.add("member", {"type": "way", "ref": way, "role": role})
        kind = {"type": "lanelet", "subtype": "road", "location": "nonurban", "region": "de"}
        rules = {"one_way": "yes", "participant:vehicle": "yes", "speed_limit": limit}
        self.lanelets.append(_tagged(lanelet, kind | rules))


def _tagged(element: XmlElement, tags: dict[str, str]) -> XmlElement:
    for key, value in tags.items():
        element.add("tag", {"k": key, "v": value})
    return element
