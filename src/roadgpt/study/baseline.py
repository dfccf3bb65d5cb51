"""Contains results of RoadGPT's thesis (section 6.1) for reports: how many roads were valid, and on how many
of them the car left its lane."""

from typing import NamedTuple

NAME = "RoadGPT's thesis"
ROADS = 100  # of every prompt


class Counted(NamedTuple):
    """The results of the thesis for one prompt, from which it made 100 roads.

    ``valid`` is the number of valid roads, and ``left`` the number of valid roads on which the car left its
    lane.
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
