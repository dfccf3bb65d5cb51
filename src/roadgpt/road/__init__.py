"""Defines the World, the Design and the Road that is built from a Design. Main function: ``build``.

A Design is a human-readable list of segments, written by a designer plug-in. A Road is 3-D geometry. Its
method ``road.at(s, t)`` returns a point: the station ``s`` is the distance along the centre line, and the
offset ``t`` is the distance from the centre line, positive to the left."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from roadgpt.road.builder import Geometry, build, in_short_segments
from roadgpt.road.design import Design, Segment, read_design
from roadgpt.road.profile import Edges, Profile
from roadgpt.road.road import Road, Samples, moved
from roadgpt.road.world import ORACLES, CrossSection, Limits, Site, World

if TYPE_CHECKING:
    from roadgpt.road.opendrive import ImportedRoad, read_opendrive

__all__ = [
    "ORACLES",
    "CrossSection",
    "Design",
    "Edges",
    "Geometry",
    "ImportedRoad",
    "Limits",
    "Profile",
    "Road",
    "Samples",
    "Segment",
    "Site",
    "World",
    "build",
    "in_short_segments",
    "moved",
    "read_design",
    "read_opendrive",
]


def __getattr__(name: str) -> Any:
    if name in ("ImportedRoad", "read_opendrive"):  # most commands read no OpenDRIVE files
        return getattr(import_module("roadgpt.road.opendrive"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
