"""Exports roads as ASAM OpenDRIVE 1.8, with only those elements that version 1.7 also defines.

Source: ASAM OpenDRIVE 1.8.1, user guide and XML schema.
"""

from pathlib import Path

from roadgpt.export.exporters.opendrive.heights import elevations
from roadgpt.export.exporters.opendrive.lanes import lanes, lateral_profile, speed_kmh
from roadgpt.export.exporters.opendrive.plan import geometries
from roadgpt.export.georeference import PROJECTION
from roadgpt.export.markup import XmlElement
from roadgpt.export.poses import Poses
from roadgpt.road import Road, World

ROAD = 1  # id of the one road in the file


class OpenDrive:
    """ASAM OpenDRIVE 1.8 with exact lines, arcs, spirals and parabolas, or fitted cubics for a spline."""

    name = "opendrive"
    suffix = ".xodr"

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the file. ``poses`` is ignored, because OpenDRIVE cannot hold a drive."""
        path.write_bytes(document(road, world).to_text().encode())


def document(road: Road, world: World) -> XmlElement:
    """Returns the XML document.

    Raises:
        ExportError: The road has a number that is not finite.
    """
    root = XmlElement("OpenDRIVE")
    root.extended(_header(road, world))
    body = root.add(
        "road", {"name": "road", "length": road.length, "id": str(ROAD), "junction": "-1", "rule": "RHT"}
    )
    body.add("type", {"s": 0, "type": "rural"}).add("speed", {"max": speed_kmh(world), "unit": "km/h"})
    body.add("planView").extended(*geometries(road.plan))
    body.add("elevationProfile").extended(*elevations(road))
    body.extended(*lateral_profile(road), lanes(road, world))
    return root


def _header(road: Road, world: World) -> XmlElement:
    """Returns the header: revision, bounds of lanes and shoulders, and the georeference. It has no date."""
    x, y = road.centreline()[:, :2].T
    reach = world.profile_of(road).reach
    header = XmlElement(
        "header",
        {
            "revMajor": 1,
            "revMinor": 8,
            "name": "road",
            "version": "1",
            "north": round(float(y.max()) + reach, 3),
            "south": round(float(y.min()) - reach, 3),
            "east": round(float(x.max()) + reach, 3),
            "west": round(float(x.min()) - reach, 3),
            "vendor": "RoadGPT",
        },
    )
    header.add("geoReference", raw=f"<![CDATA[{PROJECTION}]]>")
    return header
