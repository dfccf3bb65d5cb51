"""Defines the World, the Design and the Road that is built from a Design. Main function: ``build``.

A Design is a human-readable list of segments, written by a designer plug-in. A Road is 3-D geometry. Its
method ``road.at(s, t)`` returns the point at station ``s``, the distance along the centre line, and offset
``t``, the distance to the left of the centre line.
"""

from roadgpt.road.builder import Geometry, build
from roadgpt.road.design import Design, Segment, read_design
from roadgpt.road.moving import moved
from roadgpt.road.opendrive import ImportedRoad, read_opendrive
from roadgpt.road.profile import Edges, Profile
from roadgpt.road.road import Road, Samples
from roadgpt.road.short_segments import in_short_segments
from roadgpt.road.source import read_blueprint, read_road
from roadgpt.road.world import World

__all__ = [
    "Design",
    "Edges",
    "Geometry",
    "ImportedRoad",
    "Profile",
    "Road",
    "Samples",
    "Segment",
    "World",
    "build",
    "in_short_segments",
    "moved",
    "read_blueprint",
    "read_design",
    "read_opendrive",
    "read_road",
]
