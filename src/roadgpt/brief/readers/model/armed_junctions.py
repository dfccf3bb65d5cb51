"""Corrects a crossroads of a route to which the words give another number of arms than four."""

import re

from roadgpt.brief.amount import exactly
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.junction_nouns import KINDS_IN_SINGULAR
from roadgpt.brief.readers.model.slots import SlottedText

OF_ANY_KIND = r"\b(?:junction|turning|einmundung|knoten(?:punkt)?|intersezione)\b"
NOUN = rf"(?:{'|'.join([*(noun.pattern for noun in KINDS_IN_SINGULAR.values()), OF_ANY_KIND])})"
ANY = re.compile(NOUN)
ARMED = re.compile(
    rf"\b([3-6]) ?-? ?(?:way|arm|armed|leg|legged) {NOUN}|"
    rf"{NOUN} (?:with|mit|de|a|con) ([3-6]) (?:arms|legs|armen|branches|brazos|ramales|bracci)\b"
)
"""A number of arms and a noun for a junction; each text in lower case, without accents."""
COMMON_ARMS = 4


def with_told_arms(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a route with a junction of three, five or six arms where the words say so.

    The Brief is returned unchanged if its junctions are not as many as the nouns for junctions in the text.
    """
    said = text.text
    places = [each.start() for each in ANY.finditer(said)]
    junctions = list(brief.junctions)
    if len(places) != len(junctions):
        return brief
    for found in ARMED.finditer(said):
        arms = int(found[1] or found[2])
        at = next(n for n, place in enumerate(places) if found.start() <= place < found.end())
        if junctions[at].kind == "crossroads" and arms != COMMON_ARMS:
            kind = "junction" if arms < COMMON_ARMS else "star"
            junctions[at] = junctions[at].model_copy(update={"kind": kind, "arms": exactly(arms)})
    return brief.model_copy(update={"junctions": tuple(junctions)})
