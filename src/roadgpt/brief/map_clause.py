"""Defines what a description can ask of a map of roads without a route, and how a plan says it.

map columns=3 rows=2 lights        a grid with three by two blocks
map crossroads x3; roundabout      three crossroads and a roundabout, joined by roads
"""

import re
from typing import Self, get_args

from pydantic import ValidationError, model_validator

from roadgpt.brief.amount import Amount, Frozen, exactly
from roadgpt.brief.junctions import Control, MapJunctionKind
from roadgpt.brief.plan_amount import amount_text, read_amount
from roadgpt.errors import BriefError

MAP = "map"
KEYS = {"columns": "columns", "rows": "rows", "len": "length"}
CONTROLS = get_args(Control)
ONE = exactly(1)


class JunctionCount(Frozen):
    """A number of junctions of one kind."""

    kind: MapJunctionKind
    count: Amount = ONE


class MapClause(Frozen):
    """A map of roads: either a grid of blocks, or junctions of some kinds joined by roads."""

    columns: Amount | None = None
    """The number of blocks of a grid from west to east."""
    rows: Amount | None = None
    """The number of blocks of a grid from south to north."""
    length: Amount | None = None
    """The distance in metres between neighbouring junctions of a grid."""
    junctions: tuple[JunctionCount, ...] = ()
    control: Control | None = None
    """The sign or light of all junctions."""

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        is_grid = self.columns is not None and self.rows is not None
        if is_grid == bool(self.junctions) or (self.columns is None) != (self.rows is None):
            raise ValueError("a map has either columns and rows of blocks, or kinds of junctions")
        return self


def map_plan(asked: MapClause) -> str:
    """Returns a map as a plan, such as "map columns=3 rows=2"."""
    kinds = [
        each.kind if each.count == ONE else f"{each.kind} x{amount_text(each.count)}"
        for each in asked.junctions
    ]
    words = [
        f"{key}={amount_text(amount)}"
        for key, name in KEYS.items()
        if (amount := getattr(asked, name)) is not None
    ]
    return " ".join([MAP, *filter(None, ["; ".join(kinds)]), *words, *filter(None, [asked.control])])


def is_map(line: str) -> bool:
    """Returns whether a plan asks for a map."""
    return (line.split() or [""])[0] == MAP


def read_map(line: str) -> MapClause:
    """Returns the map that a plan describes.

    Raises:
        BriefError: A word or number is not part of the plan language, or is given twice.
    """
    fields: dict[str, object] = {}
    counts: list[JunctionCount] = []
    for word in re.sub(r"[;]", " ", line).split()[1:]:
        key, equals, value = word.partition("=")
        if equals and key in KEYS:
            found: tuple[str, object] = (KEYS[key], read_amount(value))
        elif word in CONTROLS:
            found = ("control", word)
        elif word in get_args(MapJunctionKind):
            counts.append(JunctionCount.model_validate({"kind": word}))
            continue
        elif counts and re.match(r"x[\d.]", word):
            counts[-1] = JunctionCount(kind=counts[-1].kind, count=read_amount(word[1:]))
            continue
        else:
            known = ", ".join([*(f"{key}=" for key in KEYS), *CONTROLS, *get_args(MapJunctionKind)])
            raise BriefError(f"a plan has no word '{word[:40]}' for a map; there are {known}")
        if found[0] in fields:
            raise BriefError(f"a plan gives {found[0]} of a map twice: '{word[:40]}'; give it once")
        fields[found[0]] = found[1]
    try:
        return MapClause(**fields, junctions=tuple(counts))
    except ValidationError as error:
        raise BriefError(
            f"the map '{line.strip()[:60]}' in a plan cannot be read; give columns and rows, as in map "
            "columns=3 rows=2, or kinds of junctions, as in map crossroads x3"
        ) from error
