"""What RoadGPT's thesis counted, to stand beside what is counted here. Source: its section 6.1."""

from typing import NamedTuple

NAME = "RoadGPT's thesis"
ROADS = 100  # of every prompt


class Counted(NamedTuple):
    """Of the roads of a prompt: how many its own checks let pass, and on how many of those the car left."""

    valid: int
    left: int


LONG = "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn"
THESIS = {
    "a road": Counted(88, 1),
    "an uphill road with 3 turns": Counted(57, 2),
    LONG: Counted(37, 5),
}
"""By prompt, in the order of its table."""
