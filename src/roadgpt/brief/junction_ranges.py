"""Defines what the words for junctions mean in numbers: how many arms, metres across or degrees."""

from collections.abc import Mapping

from roadgpt.brief.amount import Amount, span
from roadgpt.brief.junctions import LANE_KINDS, IslandSize, JunctionKind, Take, Way
from roadgpt.brief.ranges import Range

ARMS: Mapping[JunctionKind, Range] = {
    "t_junction": Range(3, 3),
    "y_junction": Range(3, 3),
    "crossroads": Range(4, 4),
    "star": Range(5, 6),
    "roundabout": Range(3, 6),
    "junction": Range(3, 6),
    "merge": Range(3, 3),
    "diverge": Range(3, 3),
    **dict.fromkeys(LANE_KINDS, Range(2, 2)),
}
"""The number of arms of each kind, including the road on which the route arrives."""
SIZES: Mapping[IslandSize, Range] = {
    "mini": Range(13, 25),
    "normal": Range(26, 45),
    "large": Range(46, 70),
}
"""The range of the outer diameter of a roundabout in metres, for each word for its size.

CD 116 Geometric design of roundabouts (National Highways) calls a roundabout of less than 28 m "compact" or
"mini"; the other limits are usual figures.
"""
ACROSS = Range(18, 70)
"""The outer diameters in metres with which roundabouts can be built."""
SKEW = 70.0  # degrees; crossroads with a smaller angle between two neighbouring arms are skew
SIDE = 25.0  # degrees; a smaller change of direction is straight on
ABOUT = 5.0  # degrees: the tolerance of an angle that is given as one number
BENDS = {"slight": Range(SIDE, 75), "sharp": Range(95, 180)}
"""How many degrees the route turns if it bears slightly, or turns sharply, to a side."""


def side_of(turn: float) -> Way:
    """Returns the way that corresponds to a change of direction in degrees, positive to the left. Changes of
    up to ``SIDE`` degrees are "straight".
    """
    return "left" if turn > SIDE else "right" if turn < -SIDE else "straight"


def bends_as(take: Take | None, turn: float) -> bool:
    """Returns whether a change of direction in degrees is as slight or as sharp as ``take``, such as
    "slight_left", requires; the sides are not compared.
    """
    return abs(turn) in BENDS.get((take or "").partition("_")[0], Range())


def is_about(degrees: float, asked: Amount) -> bool:
    """Returns whether an angle in degrees is as required; the tolerance of a single number is ``ABOUT``."""
    wanted, slack = span(asked), ABOUT if asked.exact else 0.0
    return degrees in Range(wanted.lo - slack, wanted.hi + slack)
