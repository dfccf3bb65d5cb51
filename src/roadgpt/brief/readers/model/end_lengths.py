"""Reads the lengths of the first and the last road of a route that the network leaves out: "reaches a
T-junction after 100 m", "finish 80 m beyond it".
"""

import re

from roadgpt.brief.amount import exactly
from roadgpt.brief.junctions import JunctionClause
from roadgpt.brief.model import Brief, Clause
from roadgpt.brief.readers.model.denial import TAKEN_BACK
from roadgpt.brief.readers.model.junction_nouns import KINDS_IN_SINGULAR, names_a_junction
from roadgpt.brief.readers.model.slots import SlottedText

ABOUT = (
    r"(?:(?:about|around|roughly|some|approximately|etwa|ungefahr|rund|environ|unos|aproximadamente|circa|"
    r"ca) (?:\. )?)?"
)
METRES = r"\[unused(\d+)\] metres"
BEFORE_FIRST = re.compile(
    r"\b(?:reach\w*|arriv\w+|com(?:es?|ing) to|meets|hits|erreich\w*|attein\w+|llega\w*|raggiung\w+)\b"
    rf"[^.,;:]* (?:after|nach|apres|despues de|tras|dopo) {ABOUT}{METRES}"
)
"""A junction that the route reaches after a length."""
BEHIND_LAST = re.compile(
    r"\b(?:finish\w*|ends?|stops?|end[et]+|fini\w*|termin\w+|acab\w+|arret\w+|halt\w*) "
    rf"{ABOUT}{METRES} (?:beyond|after|past|behind|further|later|on|dahinter|danach|spater|weiter|apres|"
    r"plus loin|despues|mas adelante|dopo|piu avanti)\b[^.;:]*[.;!]?$"
)
"""The end of a route, a length behind its last junction."""


def with_lengths_of_ends(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a route with the length that the words give to its first or its last road.

    A length is added only if the plan has this number nowhere, and the road has no length.
    """
    said = text.text
    if not brief.junctions or TAKEN_BACK.search(said):
        return brief
    first, last = BEFORE_FIRST.search(said), BEHIND_LAST.search(said)
    roads = list(brief.stretches)
    if first and not _names_any(said[: first.start()]):
        roads[0] = _with_length(roads[0], first, brief, text)
    if last:
        roads[-1] = _with_length(roads[-1], last, brief, text)
    return brief.model_copy(update={"stretches": tuple(roads)})


def _names_any(said: str) -> bool:
    return names_a_junction(said) or any(noun.search(said) for noun in KINDS_IN_SINGULAR.values())


def _with_length(road: Brief, found: re.Match[str], brief: Brief, text: SlottedText) -> Brief:
    number = int(found[1])
    length = exactly(text.slots[number - 1].value) if number <= len(text.slots) else None
    parts: list[Brief | Clause | JunctionClause] = [brief, *brief.junctions, *brief.stretches]
    parts += [clause for each in brief.stretches for clause in each.clauses]
    is_used = any(length in (part.length, getattr(part, "radius", None)) for part in parts)
    if length is None or is_used or road.length is not None or any(clause.length for clause in road.clauses):
        return road
    return road.model_copy(update={"length": length})
