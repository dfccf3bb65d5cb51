"""What words say of a whole route, and the network left out: traffic on the left, and the centre line."""

import re

from roadgpt.brief.left_hand import says_left_hand
from roadgpt.brief.model import Brief, CentreLine
from roadgpt.brief.readers.model.numerals import plain

LINES: dict[CentreLine, re.Pattern[str]] = {
    "double": re.compile(
        r"double (?:\w+ )?(?:centre |center )?lines?|doppellinie|doppelte linie|double ligne|lignes? double|"
        r"doble linea|linea doble|doppi[ae] (?:line[ae]|strisci[ae])|linea doppia"
    ),
    "solid": re.compile(
        r"no overtaking|no passing|overtaking (?:is )?(?:forbidden|prohibited|not allowed|banned)|"
        r"solid (?:\w+ )?(?:centre |center )?line|uberholverbot|uberholen (?:ist )?verboten|kein uberholen|"
        r"nicht uberholt|durchgezogene|sperrlinie|sicherheitslinie|interdi\w+ de (?:depasser|doubler)|"
        r"depassement interdit|ligne (?:\w+ )?continue|prohibido adelantar|adelanta\w+ prohibido|"
        r"linea (?:\w+ )?continua|divieto di sorpasso|sorpasso vietato|striscia continua"
    ),
    "none": re.compile(
        r"(?:no|without (?:an?|any|the)?) ?(?:centre|center|middle) ?lines?|no (?:road |lane )?markings|"
        r"unmarked road|(?:ohne|keine) mittellinie|sans (?:ligne (?:centrale|mediane)|marquage)|"
        r"sin (?:linea central|marcas)|senza (?:line[ae] (?:centrale|di mezzeria)|segnaletica orizzontale)"
    ),
    "broken": re.compile(
        r"(?:dashed|broken) (?:\w+ )?(?:centre |center )?line|overtaking (?:is )?allowed|gestrichelte|"
        r"leitlinie|ligne (?:\w+ )?(?:discontinue|pointillee)|linea discontinua|linea tratteggiata"
    ),
}
PLACED = re.compile(
    r"\b(?:until|till|before|after|behind|first|last|then|from there|up to|bis|vor|nach|danach|dahinter|dann|"
    r"jusqu|avant|apres|puis|ensuite|hasta|antes|despues|luego|fino|prima|dopo|poi)"
)
"""Words that say on which part of the route a line is."""


def with_whole_drive(brief: Brief, words: str) -> Brief:
    """Returns the Brief with what the words say of the whole route, if the Brief lacks it.

    A single road is returned as it is. A centre line is added where the words say one kind of line and no
    place, no part of the plan has a line, and on every road that has oncoming traffic on the same
    carriageway.
    """
    if not brief.junctions and brief.map is None:
        return brief
    line = None if any(each.centre for each in brief.stretches) else _line_said(words)
    roads = tuple(
        each.model_copy(update={"centre": line}) if line and _has_centre_line(each) else each
        for each in brief.stretches
    )
    return brief.model_copy(
        update={"left_hand": brief.left_hand or says_left_hand(words, by_place=True), "stretches": roads}
    )


def _line_said(words: str) -> CentreLine | None:
    found = set[CentreLine]()
    for part in re.split(r"[.,;:!?\n]", plain(words)):
        kinds = [line for line, pattern in LINES.items() if pattern.search(part)]
        if kinds and PLACED.search(part):
            return None
        found.update(kinds[:1])
    return found.pop() if len(found) == 1 else None


def _has_centre_line(road: Brief) -> bool:
    return not (road.divided or road.motorway or (road.against is not None and road.against.hi == 0))
