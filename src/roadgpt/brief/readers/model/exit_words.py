"""Exits of motorways that the words number: those before the one that is taken are passed."""

import re

from roadgpt.brief.junctions import JunctionClause
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.numerals import plain
from roadgpt.brief.readers.model.ordinals import PLACE, place_of

EXIT = r"(?:exit|off - ramp|off ramp|slip road|ausfahrt|abfahrt|sortie|salida|uscita|svincolo)"
COUNTS = {
    **dict.fromkeys(("2", "two", "zwei", "deux", "dos", "due"), 2),
    **dict.fromkeys(("3", "three", "drei", "trois", "tres", "tre"), 3),
    **dict.fromkeys(("4", "four", "vier", "quatre", "cuatro", "quattro"), 4),
}
NUMBERED = re.compile(rf"\b({PLACE}) (?:\w+ )?{EXIT}\b")
"""An exit with its number: those before it are passed."""


def with_passed_exits(brief: Brief, words: str) -> Brief:
    """Returns the Brief of a route that leaves a motorway at "the second exit" and passes those before it.

    The Brief is returned unchanged if it has another number of exits, or passes one of them already.
    """
    ramps = [n for n, each in enumerate(brief.junctions) if each.kind == "diverge"]
    found = {place_of(each) for each in NUMBERED.findall(plain(words))}
    if len(ramps) < 2 or found != {len(ramps)} or _is_passed(brief.junctions):
        return brief
    junctions = tuple(
        each.model_copy(update={"take": "main"}) if n in ramps[:-1] else each
        for n, each in enumerate(brief.junctions)
    )
    return brief.model_copy(update={"junctions": junctions})


def _is_passed(junctions: tuple[JunctionClause, ...]) -> bool:
    """Returns whether the route stays on the road at some ramp."""
    return any(each.take == "main" for each in junctions)
