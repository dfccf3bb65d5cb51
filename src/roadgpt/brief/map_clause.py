"""Defines what a description can ask of a map of roads."""

from collections.abc import Mapping
from typing import Self

from pydantic import Field, model_validator

from roadgpt.brief.amount import Amount, Frozen, exactly, span
from roadgpt.brief.junctions import Control, MapJunctionKind, Way
from roadgpt.brief.ranges import Range

MAP = "map"
ROUTE = "route"
LONGEST_ROUTE = 12  # junctions
ONE = exactly(1)
SIGNS: Mapping[Control, str] = {
    "priority": "roads with priority",
    "yield": "give-way signs",
    "stop": "stop signs",
    "lights": "traffic lights",
    "none": "no signs",
}
"""The signs or lights at the junctions of a map, in words."""


class JunctionCount(Frozen):
    """A number of junctions of one kind."""

    kind: MapJunctionKind
    count: Amount = ONE
    control: Control | None = None
    """The sign or light of these junctions; None if they have that of the map."""


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
            raise ValueError("a map has either columns and rows of blocks, or kinds of junctions")
        if self.signed and not (is_grid and all(each.control for each in self.signed)):
            raise ValueError("kinds of junctions beside columns and rows have a control each")
        if is_grid and self.blocks is not None:
            raise ValueError("the blocks of a grid are its columns and rows; leave out blocks=")
        if self.junctions and all(each.control for each in self.junctions):
            raise ValueError("if every kind of junction has a control, the last one's is that of the map")
        return self

    def ends_of_tree(self, arms: float) -> Range:
        """Returns how many dead ends the map may have.

        Args:
            arms: the number of free arms if the junctions are joined as a tree, without blocks. Each block
                joins two of them.
        """
        blocks = span(self.blocks)
        enclosing = Range(arms - 2 * blocks.hi, arms - 2 * max(blocks.lo, 0))
        asked = span(self.dead_ends)
        return Range(max(asked.lo, enclosing.lo), min(asked.hi, enclosing.hi))

    def control_of(self, junctions: JunctionCount) -> Control | None:
        """Returns the sign or light that these junctions of the map must have; None if that is open."""
        return junctions.control or self.control
