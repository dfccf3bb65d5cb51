"""Contains the counts of RoadGPT's thesis, which reports show beside the new ones. Source: its section
6.1."""

from typing import NamedTuple

NAME = "RoadGPT's thesis"
ROADS = 100  # of every prompt


class Counted(NamedTuple):
    """The counts of one prompt, of which the thesis made 100 roads.

    ``valid`` is the number of valid roads, and ``left`` the number of these on which the car left its lane.
    """

    valid: int
    left: int


LONG = "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn"
THESIS = {
    "a road": Counted(88, 1),
    "an uphill road with 3 turns": Counted(57, 2),
    LONG: Counted(37, 5),
}
"""The counts of each prompt, in the order of the thesis' table."""
