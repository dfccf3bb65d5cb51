"""Contains the counts of RoadGPT's thesis, which reports show beside ours. Source: its section 6.1."""

from typing import NamedTuple

NAME = "RoadGPT's thesis"
ROADS = 100  # of every prompt


class Counted(NamedTuple):
    """Of ``ROADS`` roads of one prompt: how many are valid, and on how many of these the car left."""

    valid: int
    left: int


LONG = "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn"
THESIS = {
    "a road": Counted(88, 1),
    "an uphill road with 3 turns": Counted(57, 2),
    LONG: Counted(37, 5),
}
"""Counts by prompt, in the order of the thesis' table."""
