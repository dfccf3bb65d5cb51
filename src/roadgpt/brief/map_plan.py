"""Writes a map of roads as a plan, and reads it back.

map columns=3 rows=2 lights        a grid of three by two blocks with traffic lights
map crossroads x3; roundabout      three crossroads and a roundabout, joined by roads
map t_junction x4 blocks=0         four T-junctions whose roads enclose no area
map junction x2 lights; junction x3    five junctions, two of them with traffic lights
map columns=2 rows=2; junction x2 lights       a grid with traffic lights at two of its junctions
map columns=2 rows=2 stop; junction none       a grid with stop signs at all of its junctions but one
map columns=2 rows=2 route=left+straight   a grid, and where the route through it goes at its junctions
"""

import re
from typing import get_args

from pydantic import ValidationError

from roadgpt.brief.amount import amount_text, read_amount
from roadgpt.brief.junctions import (
    LONGEST_ROUTE,
    MAP,
    ONE,
    ROUTE,
    Control,
    JunctionCount,
    MapClause,
    MapJunctionKind,
    Way,
)
from roadgpt.errors import BriefError

KEYS = {"columns": "columns", "rows": "rows", "len": "length", "blocks": "blocks", "dead_ends": "dead_ends"}
CONTROLS = get_args(Control)


def map_plan(asked: MapClause) -> str:
    """Returns a map as a plan, such as "map columns=3 rows=2"."""
    kinds = [_kind_text(each) for each in sorted(asked.junctions, key=lambda each: each.control is None)]
    words = [
        f"{key}={amount_text(amount)}"
        for key, name in KEYS.items()
        if (amount := getattr(asked, name)) is not None
    ]
    words += [asked.control] if asked.control else []
    words += [f"{ROUTE}={'+'.join(asked.route)}"] if asked.route else []
    signed = "".join(f"; {_kind_text(each)}" for each in asked.signed)
    return " ".join([MAP, *filter(None, ["; ".join(kinds)]), *words]) + signed


def _kind_text(each: JunctionCount) -> str:
    count = "" if each.count == ONE else f"x{amount_text(each.count)}"
    return " ".join(filter(None, [each.kind, count, each.control]))


def read_map(line: str) -> MapClause:
    """Returns the map that a plan describes. Raises BriefError if a word or number is not part of the plan
    language, a field is given twice, the plan gives neither a grid nor junctions, a grid has ``blocks=``, or
    a kind of junction in a grid has no sign.
    """
    fields: dict[str, object] = {}
    counts: list[JunctionCount] = []
    words = line.replace(";", " ").split()
    is_grid = any(word.startswith("columns=") for word in words)
    last = max((n for n, word in enumerate(words) if word in get_args(MapJunctionKind)), default=0)
    last = len(words) if is_grid else last
    for n, word in enumerate(words[1:], 1):
        key, equals, value = word.partition("=")
        if equals and key in KEYS:
            found: tuple[str, object] = (KEYS[key], read_amount(value))
        elif key == ROUTE and equals:
            found = (ROUTE, read_ways(value))
        elif word in CONTROLS and counts and n < last:
            if counts[-1].control is not None:
                raise BriefError(f"a plan gives a kind of junction two signs: '{word}'; give one of them")
            counts[-1] = counts[-1].model_copy(update={"control": word})
            continue
        elif word in CONTROLS:
            found = ("control", word)
        elif word in get_args(MapJunctionKind):
            counts.append(JunctionCount.model_validate({"kind": word}))
            continue
        elif counts and re.match(r"x[\d.]", word):
            counts[-1] = counts[-1].model_copy(update={"count": read_amount(word[1:])})
            continue
        else:
            known = ", ".join([*(f"{key}=" for key in (*KEYS, ROUTE)), *CONTROLS, *get_args(MapJunctionKind)])
            raise BriefError(f"a plan has no word '{word[:40]}' for a map; there are {known}")
        if found[0] in fields:
            raise BriefError(f"a plan gives {found[0]} of a map twice: '{word[:40]}'; give it once")
        fields[found[0]] = found[1]
    if "blocks" in fields and "columns" in fields:
        raise BriefError("the blocks of a grid are its columns and rows, so leave blocks= out of the plan")
    if is_grid and not all(each.control for each in counts):
        raise BriefError(
            "the kinds of junctions of a grid say which of them have signs of their own; give a sign behind "
            "each kind, as in map columns=2 rows=2; junction x2 lights"
        )
    fields["signed" if is_grid else "junctions"] = tuple(counts)
    try:
        return MapClause(**fields)
    except ValidationError as error:
        raise BriefError(
            f"the map '{line.strip()[:60]}' in a plan cannot be read; give columns and rows, as in map "
            "columns=3 rows=2, or kinds of junctions, as in map crossroads x3"
        ) from error


def read_ways(text: str) -> tuple[Way, ...]:
    """Returns the ways that a route takes at junctions, from a text such as "left, straight"; raises
    BriefError unless the text is 1 to 12 of left, right and straight.
    """
    words = [word for word in re.split(r"[+,\s]+", text) if word]
    ways: list[Way] = [way for word in words for way in get_args(Way) if way == word]
    if not 1 <= len(ways) == len(words) <= LONGEST_ROUTE:
        raise BriefError(
            f"the route '{text[:40]}' through a map cannot be read; give 1 to {LONGEST_ROUTE} of "
            f"{', '.join(get_args(Way))}, one for each junction that it passes, as in left+straight+right"
        )
    return tuple(ways)


def with_route(asked: MapClause | None, text: str) -> MapClause:
    """Returns the map ``asked`` with the route that a text such as "left,straight" describes. Raises
    BriefError if the description asks for no map (None), or the text cannot be read.
    """
    if asked is None:
        raise BriefError(
            "a route can be named through a map only, such as 'a grid of 3 by 2 blocks'; this description "
            "has a route or a road of its own, so leave --route out"
        )
    return asked.model_copy(update={"route": read_ways(text)})
