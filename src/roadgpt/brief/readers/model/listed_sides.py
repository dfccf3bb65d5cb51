"""Finds sides that are listed one after another ("left, right, right"), to compare a plan's turns with them.

A small network loses count of repetitions. If all sides in a description are part of one list, a plan whose
turns have these sides is preferred to a likelier plan whose turns do not.
"""

from itertools import zip_longest

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import SINGLE, STRAIGHT, normal
from roadgpt.brief.readers.model.count_correction import MULTIPLES
from roadgpt.brief.readers.model.nouns import LEFT, RIGHT
from roadgpt.brief.readers.model.slots import SlottedText

FEWEST = 3
JOINTS = frozenset(
    [",", ";", ".", "-", "/", ">", "then", "and", "dann", "und", "puis", "et", "luego", "y", "poi", "e"]
)


def listed_sides(text: SlottedText) -> tuple[str, ...]:
    """Returns the listed sides in order; empty unless all sides in the text form one list of at least three.

    The result is also empty if the text contains a count other than the number of listed sides, or a word
    like "twice", since one side may then stand for several turns.
    """
    lists: list[list[str]] = [[]]
    for word in text.words:
        if word.text in LEFT | RIGHT:
            lists[-1].append("left" if word.text in LEFT else "right")
        elif lists[-1] and word.text not in JOINTS:
            lists.append([])
    named = [sides for sides in lists if sides]
    if len(named) != 1 or len(named[0]) < FEWEST:
        return ()
    said = {word.text for word in text.words}
    others = {word for word in said if word.isdecimal()} - {str(len(named[0]))}
    return () if others or said & MULTIPLES else tuple(named[0])


def sides_of(brief: Brief) -> tuple[str | None, ...]:
    """Returns the side of every turn in order, None for a turn whose side is open.

    The result is empty if the number of turns is not exact, or if a feature has several turns, such as an
    S-bend. For a route, the sides to which the route leaves its junctions are also listed.
    """
    if brief.junctions:
        return _along(brief)
    turning = [clause for clause in normal(brief).clauses if clause.kind not in STRAIGHT]
    if any(clause.kind not in SINGLE or not clause.count.exact for clause in turning):
        return ()
    return tuple(clause.side for clause in turning for _ in range(int(clause.count.lo or 0)))


def _along(route: Brief) -> tuple[str | None, ...]:
    out: list[str | None] = []
    for stretch, junction in zip_longest(route.stretches, route.junctions):
        if any(clause.kind not in STRAIGHT for clause in stretch.clauses):
            own = sides_of(stretch)
            if not own:
                return ()
            out += own
        side = (junction.take or "").rpartition("_")[2] if junction else ""
        if side in ("left", "right"):
            out.append(side)
    return tuple(out)
