"""Names the painted lines of a road, for formats that draw each line as an object of its own."""

from typing import Literal, NamedTuple

import numpy as np

from roadgpt.geometry.curve import Array
from roadgpt.road import Edges, Profile
from roadgpt.road.profile import LINE

SAME = 1e-9  # m
Place = Literal["left", "right", "middle", "between"]
ORDER: tuple[Place, ...] = ("left", "right", "middle", "between")


class NamedLine(NamedTuple):
    """One painted line."""

    number: int
    """Index of the line in the result of ``Profile.markings``."""
    place: Place
    """Position of the line: "left" or "right" edge of the carriageway, "middle" for the centre line, or
    "between" two lanes.
    """
    is_broken: bool
    edges: Edges
    """The offsets in metres of the left and right edges of the line, at the stations passed to
    ``named_lines``.
    """


def named_lines(profile: Profile, s: Array) -> list[NamedLine]:
    """Returns the painted lines of a road at stations ``s`` along the whole road: first the edge lines, then
    the centre line, then lines between lanes.
    """
    carriageway = profile.edges(s)
    found = []
    for number, (marking, edges) in enumerate(profile.markings(s)):
        place: Place = "between"
        if np.abs(edges.left - carriageway.left).max() < SAME:
            place = "left"
        elif np.abs(edges.right - carriageway.right).max() < SAME:
            place = "right"
        elif np.abs(edges.left - LINE / 2).max() < SAME:
            place = "middle"
        found.append(NamedLine(number, place, marking == "broken", edges))
    return sorted(found, key=lambda line: ORDER.index(line.place))
