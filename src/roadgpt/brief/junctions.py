"""Defines what a description can ask of a junction on the route, and of a map of roads.

Merges, motorway exits, lane drops, lane gains and lane changes are listed together with the junctions, in
driving order."""

from collections.abc import Mapping
from typing import Self, get_args

from pydantic import Field, ValidationInfo, field_validator, model_validator

from roadgpt.brief.amount import Amount, Frozen, about, exactly, span
from roadgpt.brief.ranges import Range
from roadgpt.language.names import (
    Control,
    IslandSize,
    JunctionKind,
    LaneKind,
    MapJunctionKind,
    RampKind,
    Side,
    Take,
    Way,
)
from roadgpt.language.table import ROADS

RAMPS: tuple[JunctionKind, ...] = get_args(RampKind)
LANE_KINDS: tuple[JunctionKind, ...] = get_args(LaneKind)
"""The kinds that are not junctions: a lane ends, a lane begins, or the route changes to another lane."""
NAMES: Mapping[JunctionKind, tuple[str, ...]] = {
    kind: tuple(row["names"]) for kind, row in ROADS["junctions"].items()
}
"""The English words for each kind; RoadGPT's own texts use the first one."""
RINGS: tuple[JunctionKind, ...] = ("roundabout", "turning_circle")
"""The kinds that have a ring around an island, on which one can turn back."""
MAP = "map"
ROUTE = "route"
LONGEST_ROUTE = 12  # junctions
ONE = exactly(1)
SIGNS: Mapping[Control, str] = {name: row["names"][0] for name, row in ROADS["controls"].items()}
"""The signs or lights at the junctions of a map, in words."""


class JunctionClause(Frozen):
    """A junction that the route passes; a field that is None sets no requirement."""

    kind: JunctionKind
    take: Take | None = Field(None, validate_default=True)
    """Where the route goes on; at a fork, "left" and "right" are the leftmost and the rightmost way."""
    exit: Amount | None = None
    """The number of the exit at a roundabout, counted in driving direction; the last exit leads back."""
    arms: Amount | None = None
    """The number of roads that meet, including the road on which the route arrives."""
    ways: tuple[Way, ...] = ()
    """The sides to which a car can leave, other than back; empty if the description does not say."""
    control: Control | None = None
    only_in: tuple[Way, ...] = ()
    """The sides with a one-way road that leads to the junction; no car can leave on this road."""
    only_out: tuple[Way, ...] = ()
    """The sides with a one-way road that leads away from the junction."""
    degrees: Amount | None = None
    """The angle by which the route turns, in degrees, positive both to the left and to the right."""
    angle: Amount | None = None
    """The smallest angle between two neighbouring arms, in degrees."""
    skew: bool = False
    """Whether two neighbouring arms of a crossroads are less than 70 degrees apart."""
    size: IslandSize | None = None
    """The size of a roundabout, if the description gives a word such as "mini" for it."""
    radius: Amount | None = None
    """The radius of the central island of a roundabout in metres."""
    outer: Amount | None = None
    """The outer diameter of a roundabout in metres."""
    lanes: Amount | None = None
    """The number of lanes of a roundabout's ring."""
    side: Side | None = None
    """The side of the ramp of a merge or an exit, or of the lane that ends or begins."""
    length: Amount | None = None
    """The length in metres: at a merge or an exit, of the acceleration or deceleration lane; where a lane of
    the road ends or begins, of its taper."""
    taper: Amount | None = None
    """The length in metres of the taper of the acceleration or deceleration lane."""
    all_way: bool = False
    """Whether every arm has the same sign or traffic light as the arm on which the route arrives."""
    others_stop: bool = False
    """Whether the roads that give way to the route have stop signs."""
    crosswalk: bool = False
    island: bool = False
    """Whether a crosswalk away from junctions has an island in the middle of the road."""
    turn_lanes: tuple[Way, ...] = ()
    """The sides, left or right, for which the road of arrival has an additional lane that only turns there.
    """
    turn_length: Amount | None = None
    """The length in metres in which a turn lane has more than 0.9 of its full width."""

    @field_validator("take", mode="before")
    @classmethod
    def _turns_back(cls, take: Take | None, info: ValidationInfo) -> Take | None:
        return take or ("back" if info.data.get("kind") == "turning_circle" else None)

    @field_validator("ways", "only_in", "only_out", "turn_lanes")
    @classmethod
    def _sorted(cls, ways: tuple[Way, ...]) -> tuple[Way, ...]:
        return tuple(sorted(ways, key=get_args(Way).index))

    @property
    def name(self) -> str:
        """The kind as text, such as "T-junction"."""
        return NAMES[self.kind][0]


class JunctionCount(Frozen):
    """A number of junctions of one kind."""

    kind: MapJunctionKind
    count: Amount = ONE
    control: Control | None = None
    """The sign or light of these junctions; None if they have the sign or light of the map."""


class MapClause(Frozen):
    """A map of roads: either a grid of blocks, or junctions of some kinds joined by roads."""

    columns: Amount | None = None
    """The number of blocks of a grid from west to east."""
    rows: Amount | None = None
    """The number of blocks of a grid from south to north."""
    length: Amount | None = None
    """The distance in metres between neighbouring junctions."""
    junctions: tuple[JunctionCount, ...] = ()
    blocks: Amount | None = None
    """The number of areas that the roads between junctions enclose; a grid has columns and rows instead."""
    dead_ends: Amount | None = None
    """The number of dead ends; a road that leads out of the map also counts as a dead end."""
    signed: tuple[JunctionCount, ...] = ()
    """The junctions of a grid with signs or lights of their own; each has a control."""
    control: Control | None = None
    """The sign or light of all junctions that have none of their own."""
    route: tuple[Way, ...] = Field((), max_length=LONGEST_ROUTE)
    """Where the route goes at the junctions that it passes, in driving order; if empty, it is random."""

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        is_grid = self.columns is not None and self.rows is not None
        if is_grid == bool(self.junctions) or (self.columns is None) != (self.rows is None):
            raise ValueError(
                "a map has either columns and rows of blocks, as in map columns=3 rows=2, or kinds of "
                "junctions, as in map crossroads x3"
            )
        if self.signed and not (is_grid and all(each.control for each in self.signed)):
            raise ValueError(
                "the kinds of junctions of a grid say which of them have signs of their own; give a sign "
                "behind each kind, as in map columns=2 rows=2; junction x2 lights"
            )
        if is_grid and self.blocks is not None:
            raise ValueError("the blocks of a grid are columns and rows, so leave blocks= out of the plan")
        if self.junctions and all(each.control for each in self.junctions):
            raise ValueError("if every kind of junction has a control, the last one's is that of the map")
        return self

    def ends_of_tree(self, arms: float) -> Range:
        """Returns how many dead ends the map may have. ``arms`` is the number of arms that are free if the
        junctions are joined as a tree without blocks; each block uses two of these arms."""
        blocks = span(self.blocks)
        enclosing = Range(arms - 2 * blocks.hi, arms - 2 * max(blocks.lo, 0))
        asked = span(self.dead_ends)
        return Range(max(asked.lo, enclosing.lo), min(asked.hi, enclosing.hi))

    def control_of(self, junctions: JunctionCount) -> Control | None:
        """Returns the sign or light that these junctions of the map must have; None if that is open."""
        return junctions.control or self.control


FORMS: Mapping[JunctionKind, str] = {kind: row["form"] for kind, row in ROADS["junctions"].items()}
TAKES: Mapping[JunctionKind, tuple[Take, ...]] = {
    kind: tuple(row.get("takes", [take for take in get_args(Take) if take not in ("ramp", "main")]))
    for kind, row in ROADS["junctions"].items()
}
"""Where a route can go on at each kind; "back" is possible only at a roundabout or a turning circle."""
ARMS: Mapping[JunctionKind, Range] = {kind: Range(*row["arms"]) for kind, row in ROADS["junctions"].items()}
"""The number of arms of each kind, including the road on which the route arrives."""
SIZES: Mapping[IslandSize, Range] = {size: Range(*ends) for size, ends in ROADS["islands"].items()}
"""The range of the outer diameter of a roundabout in metres, for each word for its size."""
ACROSS = Range(18, 70)
"""The outer diameters in metres with which roundabouts can be built."""
SKEW = 70.0  # degrees; crossroads with a smaller angle between two neighbouring arms are skew
SIDE = 25.0  # degrees; a smaller change of direction is straight on
ABOUT = 5.0  # degrees: the tolerance of an angle that is given as one number
BENDS = {"slight": Range(SIDE, 75), "sharp": Range(95, 180)}
"""How many degrees the route turns if it bears slightly, or turns sharply, to a side."""


def side_of(turn: float) -> Way:
    """Returns the way that corresponds to a change of direction in degrees, positive to the left. Changes of
    up to ``SIDE`` degrees are "straight"."""
    return "left" if turn > SIDE else "right" if turn < -SIDE else "straight"


def bends_as(take: Take | None, turn: float) -> bool:
    """Returns whether a change of direction in degrees is as slight or as sharp as ``take``, such as
    "slight_left", requires; the sides are not compared."""
    return abs(turn) in BENDS.get((take or "").partition("_")[0], Range())


def is_about(degrees: float, asked: Amount | None) -> bool:
    """Returns whether an angle in degrees is as required; the tolerance of a single number is ``ABOUT``."""
    return degrees in about(asked, lambda _: ABOUT)
