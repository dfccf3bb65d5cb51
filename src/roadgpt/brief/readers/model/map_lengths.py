"""Finds how long all roads of a map are together, "a village with 2 km of streets", or how long a route is:
"route about 500 m".

The network knows one length of a map only, the distance from a junction to the next, and leaves out the
length of routes that are told in many words.
"""

import re

from roadgpt.brief.amount import Amount, exactly
from roadgpt.brief.junctions import LANE_KINDS, RAMPS
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.denial import TAKEN_BACK
from roadgpt.brief.readers.model.end_lengths import ABOUT
from roadgpt.brief.readers.model.exit_words import EXIT
from roadgpt.brief.readers.model.map_words import IN_ALL
from roadgpt.brief.readers.model.sign_words import LEAST, MOST
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.told_junctions import DRIVE
from roadgpt.brief.readers.model.whole_drive import PLACED

ROADS = (
    r"(?:roads?|streets?|stra(?:ss|ß)en?(?:netz\w*)?|wegen?|rues?|routes?|voirie|calles?|carreteras?|strad[ae]|"
    r"vie)"
)
TOTAL = r"(?:total length|length in all|gesamtlange|longueur totale|longitud total|lunghezza totale)"
METRES = r"\[unused(\d+)\] metres(?: \[unused\d+\])?"
WHOLE = re.compile(
    rf"{METRES} (?:(?:of|an|von|de|di) (?:(?:its|the|all) )?{ROADS}|stra(?:ss|ß)en(?:netz)?)\b"
    r"(?! (?:between|zwischen|entre|tra|from|before|behind|to|from|each|per|je|bis|vor|nach)\b)|"
    rf"\b{TOTAL} (?:\w+ )?{METRES}\b|"
    rf"{METRES} (?:long |lang |de long |largo |lungh\w+ )?(?:{IN_ALL})\b|"
    rf"\b(?:{IN_ALL}) {METRES}\b"
)
"""The length of all roads."""


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


def with_whole_length(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a map with the length that the words give to all its roads.

    The Brief is returned unchanged if it has no map, or if the words give no such length, or several.
    """
    found = [*WHOLE.finditer(text.text)]
    numbers = {int(group) for match in found for group in match.groups() if group}
    if brief.map is None or len(numbers) != 1 or TAKEN_BACK.search(text.text):
        return brief
    number = numbers.pop()
    if number > len(text.slots):
        return brief
    metres, before = text.slots[number - 1].value, text.text[: found[0].start()].strip()
    bounds = Amount(lo=metres) if LEAST.search(before) else Amount(hi=metres) if MOST.search(before) else None
    spacing = brief.map.length
    is_whole = spacing is not None and metres in (spacing.lo, spacing.hi)
    asked = brief.map.model_copy(update={"length": None}) if is_whole else brief.map
    return brief.model_copy(update={"map": asked, "length": bounds or exactly(metres)})
