"""Writes the header of an OpenDRIVE file, and one road."""

from collections.abc import Mapping, Sequence

from roadgpt.export.exporters.opendrive.heights import elevations
from roadgpt.export.exporters.opendrive.lanes import LaneLinks, lanes, lateral_profile, speed_kmh
from roadgpt.export.exporters.opendrive.plan import geometries
from roadgpt.export.georeference import PROJECTION
from roadgpt.export.markup import Value, XmlElement
from roadgpt.road import Road, World

REVISION = 8  # ASAM OpenDRIVE 1.8

RoadLink = tuple[str, Mapping[str, Value]]
"""The name and the attributes of an element ``predecessor`` or ``successor``."""


def header(bounds: Sequence[float], revision: int = REVISION) -> XmlElement:
    """Returns the header: revision, bounds and georeference. It has no date.

    Args:
        bounds: The smallest x and y and the largest x and y of all lanes, in metres.
        revision: The minor revision of OpenDRIVE 1.
    """
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


def road_element(
    road: Road,
    number: int,
    world: World,
    links: Sequence[RoadLink] | None = None,
    junction: int = -1,
    lane_links: LaneLinks | None = None,
) -> XmlElement:
    """Returns the element ``road`` with its geometry and its lanes.

    Args:
        road: The road.
        number: Its id.
        world: The World, which gives lanes, speed limit and friction.
        links: The roads or junctions before and after it, for a road of a network; None for a single road.
        junction: The id of the junction to which a connecting road belongs; -1 for any other road.
        lane_links: The links of the lanes of a connecting road.
    """
    body = XmlElement(
        "road",
        {
            "name": "road" if links is None else f"road {number}",
            "length": road.length,
            "id": str(number),
            "junction": str(junction),
            "rule": "RHT",
        },
    )
    if links is not None:
        body.add("link").extended(*(XmlElement(name, attributes) for name, attributes in links))
    body.add("type", {"s": 0, "type": "rural"}).add("speed", {"max": speed_kmh(world), "unit": "km/h"})
    body.add("planView").extended(*geometries(road.plan))
    body.add("elevationProfile").extended(*elevations(road))
    return body.extended(*lateral_profile(road), lanes(road, world, lane_links))
