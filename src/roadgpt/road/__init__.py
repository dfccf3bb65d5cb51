"""Roads: the World, the Design and the Road that is built from it. Main function: ``build``.

A Design is the blueprint that a designer writes and a person can read. A Road is 3-D geometry, evaluated with
``road.at(s, t)``: stations ``s`` run along the centre line, offsets ``t`` to its left, heights upwards.
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
