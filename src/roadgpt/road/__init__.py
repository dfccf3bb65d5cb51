"""Defines the World, the Design and the Road that is built from a Design. Main function: ``build``.

A Design is a human-readable list of segments, written by a designer plug-in. A Road is 3-D geometry. Its
method ``road.at(s, t)`` returns a point: the station ``s`` is the distance along the centre line, and the
offset ``t`` is the distance from the centre line, positive to the left."""

from typing import TYPE_CHECKING, Any

from roadgpt.later import load, names_of

if TYPE_CHECKING:
    from roadgpt.road.builder import build, in_short_segments
    from roadgpt.road.design import Design, Segment, read_design
    from roadgpt.road.profile import Edges, Profile
    from roadgpt.road.road import Road, Samples
    from roadgpt.road.world import ORACLES, CrossSection, Geometry, Limits, Site, World

_OFFERED = {
    "builder": "build in_short_segments",
    "design": "Design Segment read_design",
    "profile": "Edges Profile",
    "road": "Road Samples",
    "world": "ORACLES CrossSection Geometry Limits Site World",
}
__all__ = names_of(_OFFERED)


def __getattr__(name: str) -> Any:
    return load(__name__, _OFFERED, name)
