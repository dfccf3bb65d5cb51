"""Finds how long a route is, or its first or last road: "route about 500 m", "reaches a T-junction after
100 m", "finish 80 m beyond it".

The network leaves out the length of routes that are told in many words, or takes it for that of the first
road.
"""

import re

from roadgpt.brief.amount import Amount, exactly
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause
from roadgpt.brief.model import Brief, Clause
from roadgpt.brief.readers.model.denial import TAKEN_BACK
from roadgpt.brief.readers.model.exit_words import EXIT
from roadgpt.brief.readers.model.junction_nouns import KINDS_IN_SINGULAR, names_a_junction
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.told_junctions import DRIVE
from roadgpt.brief.readers.model.whole_drive import PLACED

ABOUT = (
    r"(?:(?:about|around|roughly|some|approximately|etwa|ungefahr|rund|environ|unos|aproximadamente|circa|"
    r"ca) (?:\. )?)?"
)
METRES = r"\[unused(\d+)\] metres(?: \[unused\d+\])?"
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
ROUTE = re.compile(
    rf"\b(?:{DRIVE}) (?:(?:of|is|about|around|roughly|some|von|ist|etwa|rund|circa|ca|de|d '|environ|fait|"
    rf"mesure|mide|unos|es|di|misura|lunga?|long|lang|total|length) )*{METRES}"
    r"(?= (?:[.,;:]|in all|long|lang|(?:and|und|et|y|e)\b)|$)"
)
"""The length of a whole route."""
ON_A_RAMP = re.compile(
    rf"\b(?:{EXIT}|ramps?|entr\w+|merg\w+|join\w*|leav\w+|auffahrt|einfahrt|rampe|bretelle|entree|acceso|entrada|"
    r"ingresso|rampa)\b"
)
"""Words that tell of a ramp."""
OF_ALL = (
    r"(?: (?:long|dead|straight|in length|lang|gerade(?:aus)?|de long|tout droit|de largo|rect[ao]|lung[ao]|"
    r"dritt[ao])){0,2}"
)
"""What may follow the length of a road without junctions."""
WITHOUT = re.compile(
    rf"^\W*(?:\w+ ){{1,3}}(?:of|von|de|d '|di) {ABOUT}{METRES} (?:without|ohne|sans|sin|senza) "
    r"(?:any )?(?:junctions?|intersections?|kreuzung(?:en)?|knoten|carrefours?|intersecciones|cruces|"
    r"incroci)\b"
)
"""The length of a road without junctions, with which a text begins."""


def with_length_of_route(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a route with the length that the words give to it, if the Brief has no length."""
    begun = WITHOUT.search(text.text)
    found = {int(group) for match in ROUTE.finditer(text.text) for group in match.groups() if group}
    has_length = brief.length is not None or any(road.length is not None for road in brief.stretches)
    if begun and brief.length is None and all(each.kind in LANE_KINDS for each in brief.junctions):
        found, has_length = {int(begun[1])}, False
    if not brief.junctions or has_length or len(found) != 1 or TAKEN_BACK.search(text.text):
        return brief
    number = found.pop()
    if number > len(text.slots):
        return brief
    length = exactly(text.slots[number - 1].value)
    roads = tuple(
        road.model_copy(update={"length": None}) if road.length == length else road
        for road in brief.stretches
    )
    return brief.model_copy(update={"length": length, "stretches": roads})


def with_length_past_lanes(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a route on which lanes only end, begin or are changed, or of a motorway, with the
    length that a sentence before its places gives alone as the length of the whole route.

    The Brief is returned unchanged if the length is not that of its first road, if it does not stand alone
    between commas, if a word near it may limit it to a part of the route: "then 200 m", or if the sentence
    also tells of a ramp.
    """
    kinds = {each.kind for each in brief.junctions}
    lengths = [road.length for road in (brief, *brief.stretches[1:])]
    if not kinds or not kinds <= {*LANE_KINDS, *RAMPS} or any(lengths):
        return brief
    first = brief.stretches[0]
    length, clauses = first.length, first.clauses
    if len(clauses) == 1 and clauses[0].kind == "straight" and length is None:
        length, clauses = clauses[0].length, (clauses[0].model_copy(update={"length": None}),)
    said = next((part.strip() for part in text.text.split(".") if _stands_alone(length, part, text)), None)
    has_ramp = said is None or ON_A_RAMP.search(said) is not None
    if said is None or PLACED.search(said) or (has_ramp and kinds & {*RAMPS}):
        return brief
    bare = first.model_copy(update={"length": None, "clauses": clauses})
    return brief.model_copy(update={"length": length, "stretches": (bare, *brief.stretches[1:])})


def _stands_alone(length: Amount | None, part: str, text: SlottedText) -> bool:
    """Returns whether a part of the text gives a length alone between commas."""
    numbers = map(
        int, re.findall(rf"(?:^|,) {ABOUT}\[unused(\d+)\] metres{OF_ALL}(?: ?,|$)", f" {part.strip()}")
    )
    return any(n <= len(text.slots) and length == exactly(text.slots[n - 1].value) for n in numbers)


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
