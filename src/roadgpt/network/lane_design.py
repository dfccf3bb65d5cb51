"""Defines the parts of a NetworkDesign that say how many lanes there are, and where this changes.

    "lanes": {"forward": 2, "backward": 0, "width": 3.5, "centre": "solid", "edge": "broken"}
    "junction1": {"after": 1, "kind": "merge", "take": "ramp", "length": 150,
                  "lanes": {"forward": 2, "backward": 0}}
    "junction2": {"after": 2, "kind": "lane_drop", "length": 60}

Merges, exits and places where lanes change are numbered together with the junctions, in driving order.
"""

import math
from typing import Annotated, Literal

from pydantic import Field, StrictBool

from roadgpt.brief.junctions import LaneKind, Side
from roadgpt.brief.words import MOST_LANES
from roadgpt.road.design import MAX_SEGMENTS, OTHER_DIRECTION, FrozenFields
from roadgpt.road.profile import Marking

ACCELERATION = 130.0  # m, length of an acceleration or deceleration lane without its taper
RAMP_TAPER = 60.0  # m, length of the taper of such a lane: RAA 2008, entries and exits
MEDIAN = 2.0  # m, width of a median
TAPER = 60.0  # m, length of the taper of a lane that ends or begins
LEAST_WIDTH = 1.5  # m; where a lane is narrower than this, no car can drive in it

RARE = {"divided": False, "edge": "solid"}
"""Fields of a LanesDesign that are written only if they differ from these values."""
After = Annotated[int, Field(ge=1, le=MAX_SEGMENTS)]
LaneLength = Annotated[float, Field(ge=10, le=2000, allow_inf_nan=False)]


class LanesDesign(FrozenFields):
    """The lanes of a road."""

    forward: Annotated[int, Field(ge=1, le=MOST_LANES)] = 1
    """Number of lanes in the direction of the route, one or more."""
    backward: Annotated[int, Field(ge=0, le=MOST_LANES)] = 1
    """Number of oncoming lanes; 0 for a one-way road."""
    width: Annotated[float, Field(ge=2, le=10, allow_inf_nan=False)] = 4.0
    """Width of every lane in metres."""
    centre: Marking | None = None
    """The line between the directions; None for a broken line with one lane each way, else a solid one."""
    divided: StrictBool = False
    """Whether a median separates the directions."""
    edge: Literal["solid", "broken", "none"] = "solid"
    """The line at the outer edge of the lanes of each direction."""


class RampDesign(FrozenFields):
    """A merge, where a ramp joins a road, or a diverge, where a ramp leaves a road."""

    after: After
    """Number of segments of the route before this place."""
    kind: Literal["merge", "diverge"]
    take: Literal["ramp", "main"]
    """The road from which the route comes (merge) or to which it goes (diverge)."""
    length: LaneLength = ACCELERATION
    """Length in metres of the acceleration or deceleration lane, without its taper."""
    taper: LaneLength = RAMP_TAPER
    """Length in metres of the taper in which this lane ends or begins."""
    side: Side | None = None
    """The side of the ramp; None for the side on which traffic drives."""
    lanes: LanesDesign | None = None
    """The lanes of the road behind this place, if the route takes the ramp; None for two one-way lanes behind
    a merge, and for one behind a diverge. On the main road, the lanes stay the same.
    """

    def mirrored(self) -> "RampDesign":
        """Returns the ramp with left and right exchanged."""
        side = None if self.side is None else OTHER_DIRECTION[self.side]
        return self.model_copy(update={"side": side})


class LanesChangeDesign(FrozenFields):
    """A place where a lane ends or begins, or where the route changes to the next lane."""

    after: After
    """Number of segments of the route before this place."""
    kind: LaneKind
    side: Side = "right"
    """Whether the leftmost or the rightmost lane ends or begins, or the side to which the route changes."""
    length: LaneLength = TAPER
    """Length in metres of the taper in which the lane ends or begins; not used for a lane change."""
    lanes: LanesDesign | None = None
    """The lanes of the road behind this place; None for the lanes of the road before it, less the lane that
    ends or plus the lane that begins.
    """

    def mirrored(self) -> "LanesChangeDesign":
        """Returns the place with left and right exchanged."""
        return self.model_copy(update={"side": OTHER_DIRECTION[self.side]})


def narrow_part(taper: float, width: float) -> float:
    """Returns the length in metres on which a lane that ends or begins is narrower than ``LEAST_WIDTH``. The
    lane's width is a cubic that changes between 0 and ``width`` metres over ``taper`` metres and is level at
    both ends. ``width`` is at least ``LEAST_WIDTH``.
    """
    return taper * (0.5 - math.sin(math.asin(1 - 2 * LEAST_WIDTH / width) / 3))
