"""Exports roads and networks as ASAM OpenDRIVE 1.8. Except for the boundaries of junctions, only elements
that version 1.7 also defines are written.

Source: ASAM OpenDRIVE 1.8.1, user guide and XML schema.
"""

import json
from pathlib import Path

from roadgpt.export.exporters.opendrive.junctions import network_document
from roadgpt.export.exporters.opendrive.lanes import RoadParts
from roadgpt.export.exporters.opendrive.roads import REVISION, header, road_element
from roadgpt.export.markup import XmlElement
from roadgpt.export.poses import Poses
from roadgpt.network import Route
from roadgpt.road import Road, World

ROAD = 1  # id of the road if the file has only one
ROUTE = ".route.json"
"""Suffix of the file that names the roads and lanes of a route: ``{"route": [[road, lane], ...]}``."""


class OpenDrive:
    """ASAM OpenDRIVE 1.8 with exact lines, arcs, spirals and parabolas, or fitted cubics for a spline."""

    name = "opendrive"
    suffix = ".xodr"
    holds_junctions = True

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the file, and beside it ``NAME.route.json`` with the roads and lanes to drive. For a map
        without a route, this is an empty list.

        ``poses`` is ignored, because OpenDRIVE cannot hold a drive.
        """
        write(road, path, world)


def write(road: Road, path: Path, world: World, revision: int = REVISION) -> None:
    """Writes the file of a road or network, and a file with the roads and lanes to drive, in driving order.

    Args:
        road: The road, or the route through a network.
        path: The file to write.
        world: The World, which defines friction, speed limit, and the lanes of a road without its own
            cross-section.
        revision: The minor revision of OpenDRIVE 1: 7, or 8 with the boundaries of junctions.

    Raises:
        ExportError: The road has a number that is not finite.
    """
    path.write_bytes(document(road, world, revision).to_text().encode())
    path.with_suffix(ROUTE).write_text(json.dumps(_legs(road, world)) + "\n")


def _legs(road: Road, world: World) -> dict[str, list[list[int]]]:
    """Returns the content of the file with the roads and lanes to drive."""
    if isinstance(road, Route):
        return road.to_route_json()
    profile = world.profile_of(road)
    return {"route": [[ROAD, profile.along_ids[profile.driven]]]}


def document(road: Road, world: World, revision: int = REVISION) -> XmlElement:
    """Returns the XML document of a road, or of the network of a route.

    If a number of the road is not finite, ``to_text`` of the document raises ExportError.
    """
    if isinstance(road, Route):
        return network_document(road.network, world, revision)
    root = XmlElement("OpenDRIVE")
    x, y = road.centreline()[:, :2].T
    reach = world.profile_of(road).reach
    bounds = (x.min() - reach, y.min() - reach, x.max() + reach, y.max() + reach)
    return root.extended(header(bounds, revision), road_element(road, ROAD, RoadParts(world)))
