"""Defines what a description can ask of a junction on the route, and what its words mean.

Merges, exits of motorways, and places where lanes end, begin or are changed stand in one order with them.
"""

from collections.abc import Mapping
from typing import Literal, get_args

from pydantic import field_validator

from roadgpt.brief.amount import Amount, Frozen, span
from roadgpt.brief.words import Range

PlainKind = Literal["t_junction", "y_junction", "crossroads", "star", "roundabout"]
"""The kinds of junctions at which no road is a ramp."""
MapJunctionKind = Literal[PlainKind, "junction"]
JunctionKind = Literal[MapJunctionKind, "merge", "diverge", "lane_drop", "lane_gain", "lane_change"]
LaneKind = Literal["lane_drop", "lane_gain", "lane_change"]
RAMPS: tuple[JunctionKind, ...] = ("merge", "diverge")
LANE_KINDS: tuple[JunctionKind, ...] = get_args(LaneKind)
"""The kinds that are no junctions: the road goes on with other lanes, or the route changes its lane."""
Take = Literal[
    "left",
    "right",
    "straight",
    "back",
    "sharp_left",
    "sharp_right",
    "slight_left",
    "slight_right",
    "ramp",
    "main",
]
Side = Literal["left", "right"]
Way = Literal["left", "right", "straight"]
Control = Literal["priority", "yield", "stop", "lights", "none"]
IslandSize = Literal["mini", "normal", "large"]

NAMES: Mapping[JunctionKind, tuple[str, ...]] = {
    "t_junction": ("T-junction", "side road"),
    "y_junction": ("Y-junction", "fork"),
    "crossroads": ("crossroads", "intersection"),
    "star": ("star junction", "five-way junction"),
    "roundabout": ("roundabout", "traffic circle"),
    "junction": ("junction",),
    "merge": ("merge", "motorway entry"),
    "diverge": ("motorway exit", "off-ramp"),
    "lane_drop": ("lane drop", "end of a lane"),
    "lane_gain": ("lane gain", "additional lane"),
    "lane_change": ("lane change",),
}
"""The English words for each kind; RoadGPT's own texts use the first one.

A "junction" is of any kind but a roundabout, because the description names none.
"""
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
"""The number of arms of each kind, with the road on which the route arrives."""
SIZES: Mapping[IslandSize, Range] = {
    "mini": Range(13, 25),
    "normal": Range(26, 45),
    "large": Range(46, 70),
}
"""The outer diameter of a roundabout in metres, for words that say its size.

Mini: below 28 m is "compact" or "mini" in CD 116 Geometric design of roundabouts (National Highways); the
other limits are usual figures.
"""
ACROSS = Range(18, 70)
"""The outer diameters in metres with which roundabouts can be built."""
SKEW = 70.0  # degrees; crossroads whose roads are less apart are skew
SIDE = 25.0  # degrees; a smaller change of direction is straight on
TAKES: Mapping[Take, str] = {
    "left": "turn left",
    "right": "turn right",
    "straight": "go straight on",
    "back": "turn back the way it came",
    "sharp_left": "take the sharpest left",
    "sharp_right": "take the sharpest right",
    "slight_left": "bear slightly left",
    "slight_right": "bear slightly right",
    "ramp": "use the ramp",
    "main": "stay on the main road",
}
CONTROLS: Mapping[Control, str] = {
    "priority": "where the route has priority",
    "yield": "where the route has to give way",
    "stop": "with a stop sign for the route",
    "lights": "with traffic lights",
    "none": "without signs",
}
ABOUT = 5.0  # degrees, around an angle that is given as one number
BENDS = {"slight": Range(SIDE, 75), "sharp": Range(95, 180)}
"""How many degrees the route turns if it bears slightly, or turns sharply, to a side."""
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth")


def side_of(turn: float) -> Way:
    """Returns the side of a change of direction in degrees, left positive."""
    return "left" if turn > SIDE else "right" if turn < -SIDE else "straight"


def bends_as(take: Take | None, turn: float) -> bool:
    """Returns whether a change of direction in degrees is as slight or as sharp as a take such as
    "slight_left"; true for takes that say neither.
    """
    return abs(turn) in BENDS.get((take or "").partition("_")[0], Range())


def is_about(degrees: float, asked: Amount) -> bool:
    """Returns whether an angle is the required one, within ``ABOUT`` of a single number."""
    wanted, slack = span(asked), ABOUT if asked.exact else 0.0
    return degrees in Range(wanted.lo - slack, wanted.hi + slack)


class JunctionClause(Frozen):
    """A junction that the route passes; a field that is None sets no requirement."""

    kind: JunctionKind
    take: Take | None = None
    """Where the route goes on; in a fork, "left" and "right" are the leftmost and the rightmost way."""
    exit: Amount | None = None
    """The number of the exit at a roundabout, counted along the ring; the last one leads back."""
    arms: Amount | None = None
    """The number of roads that meet, with the one on which the route arrives."""
    ways: tuple[Way, ...] = ()
    """The sides to which one can leave, other than back; empty if the description does not say."""
    control: Control | None = None
    only_in: tuple[Way, ...] = ()
    """The sides on which a one-way road leads to the junction: nobody leaves on it."""
    only_out: tuple[Way, ...] = ()
    """The sides on which a one-way road leads away from the junction."""
    degrees: Amount | None = None
    """The change of direction of the route, in degrees, positive to either side."""
    angle: Amount | None = None
    """The angle in degrees between those two neighbouring arms that are the least apart."""
    skew: bool = False
    """Whether two neighbouring arms of a crossroads are less than 70 degrees apart."""
    size: IslandSize | None = None
    """The size of a roundabout, if the description gives a word."""
    radius: Amount | None = None
    """The radius of the central island of a roundabout in metres."""
    outer: Amount | None = None
    """The outer diameter of a roundabout in metres."""
    lanes: Amount | None = None
    """The number of lanes of a roundabout's ring."""
    side: Side | None = None
    """The side of the ramp of a merge or an exit, or of the lane that ends or begins."""
    length: Amount | None = None
    """The length in metres of the lane for acceleration or deceleration, or of the taper of a lane."""
    taper: Amount | None = None
    """The length in metres in which the lane for acceleration or deceleration ends or begins."""
    all_way: bool = False
    """Whether every arm has the sign or the light of the route."""
    others_stop: bool = False
    """Whether the roads that give way to the route have stop signs."""
    crosswalk: bool = False

    @field_validator("ways", "only_in", "only_out")
    @classmethod
    def _sorted(cls, ways: tuple[Way, ...]) -> tuple[Way, ...]:
        return tuple(sorted(ways, key=get_args(Way).index))

    @property
    def name(self) -> str:
        """The kind as text, such as "T-junction"."""
        return NAMES[self.kind][0]
