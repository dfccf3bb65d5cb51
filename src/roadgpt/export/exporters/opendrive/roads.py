"""Writes the header of an OpenDRIVE file, and one road."""

from collections.abc import Sequence
from dataclasses import dataclass

from roadgpt.export.exporters.opendrive.lanes import (
    LaneLinks,
    RoadParts,
    lateral_profile,
)
from roadgpt.export.exporters.opendrive.plan import Start, geometries
from roadgpt.export.georeference import PROJECTION
from roadgpt.export.markup import XmlElement
from roadgpt.road import Road

REVISION = 8  # ASAM OpenDRIVE 1.8


def header(bounds: Sequence[float], revision: int = REVISION) -> XmlElement:
    """Returns the element ``header`` with revision, bounds and georeference, but without a date.

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


@dataclass(frozen=True)
class RoadPlace:
    """Where a road is in a network."""

    links: Sequence[XmlElement] = ()
    """The elements ``predecessor`` and ``successor``: the roads or junctions before and after the road."""
    junction: int = -1
    """The id of the junction to which a connecting road belongs; -1 for any other road."""
    lane_links: LaneLinks | None = None
    """The links from lanes of the road to lanes of other roads."""
    starts: Sequence[Start] | None = None
    """The starts of the pieces of the reference line; None if they have not been computed yet."""


def road_element(road: Road, number: int, parts: RoadParts, place: RoadPlace | None = None) -> XmlElement:
    """Returns the element ``road`` with its geometry and its lanes.

    Args:
        road: The road.
        number: The id of the road.
        parts: Creates the elements that the roads of the file share.
        place: Where the road is in its network; None for a single road.
    """
    body = XmlElement(
        "road",
        {
            "name": "road" if place is None else f"road {number}",
            "length": road.length,
            "id": str(number),
            "junction": "-1" if place is None else str(place.junction),
            "rule": "LHT" if parts.world.profile_of(road).left_hand else "RHT",
        },
    )
    if place is not None:
        body.add("link").extended(*place.links)
    else:
        place = RoadPlace()
    body.extended(parts.road_type)
    body.add("planView").extended(*geometries(road.plan, place.starts))
    lanes = parts.lanes(road, place.lane_links, is_inside=place.junction >= 0)
    return body.extended(parts.heights(road), *lateral_profile(road), lanes)
