"""Corrects places where lanes end, begin or are changed: the network may write one too many or too few."""

import re
from collections.abc import Mapping

from roadgpt.brief.amount import span
from roadgpt.brief.junctions import RAMPS, JunctionClause, JunctionKind
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.numerals import plain

BEGINS = re.compile(
    r"\b(?:start|begin|set off|setting off|starting|beginning)\w*(?: out| off)? (?:in|on) the (left|right)"
    r"(?:most|-hand| hand)? (?:lane|one)\b|"
    r"\b(?:beginn|start)\w*(?: wir| man)? (?:auf|in) de[rm] (linken|rechten) (?:fahr)?(?:spur|streifen)\b|"
    r"\b(?:commenc|demarr|part)\w* (?:sur|dans) la (?:voie|file) de (gauche|droite)\b|"
    r"\b(?:empez|empiez|sal)\w* (?:en|por) el carril (?:de la )?(izquierd[ao]|derech[ao])\b|"
    r"\b(?:cominc|iniz|part)\w* (?:nella|sulla|in) corsia (?:di )?(sinistra|destra)\b"
)
ADDED: Mapping[JunctionKind, int] = {"lane_gain": 1, "lane_drop": -1}
"""How many lanes more there are behind a place."""
CHANGED: Mapping[JunctionKind, re.Pattern[str]] = {
    "lane_gain": re.compile(
        r"\blanes? (?:is |are |gets? )?(?:add|begin|start|open|join)\w*|"
        r"\b(?:add|gain)\w* (?:a |another |one )?(?:\w+ )?lane\b|\bbecom\w+ (?:three|four|3|4)\b|"
        r"(?:spur|streifen)\b[^.;]{0,30}\b(?:hinzu|dazu|beginn)|\bvoie\b[^.;]{0,30}\b(?:ajout|commenc|s'ouvre)|"
        r"\b(?:anade|suma|abre|empieza)\w* [^.;]{0,20}carril|\bcarril\b[^.;]{0,20}\b(?:anad|empieza|abre)|"
        r"\b(?:aggiunge|apre|inizia)\w* [^.;]{0,20}corsia"
    ),
    "lane_drop": re.compile(
        r"\blanes? (?:is |are |gets? )?(?:end|drop|clos|lost|disappear)\w*|"
        r"\b(?:drop|los)\w* (?:a |another |one )?(?:\w+ )?lane\b|"
        r"(?:spur|streifen)\b[^.;]{0,30}\b(?:endet|entfallt|weg)|\bendet [^.;]{0,15}(?:spur|streifen)|"
        r"\bvoie\b[^.;]{0,30}\b(?:se termine|disparait|supprim)|"
        r"\bcarril\b[^.;]{0,20}\b(?:acaba|termina|desaparece)|"
        r"\b(?:finisce|termina|scompare)\w* [^.;]{0,20}corsia|"
        r"\bcorsia\b[^.;]{0,20}\b(?:finisce|termina|scompare)"
    ),
}
"""Words for a lane that begins or ends."""
LEFT = ("left", "linken", "gauche", "izquierdo", "izquierda", "sinistra")


def without_own_lane(brief: Brief, words: str) -> Brief:
    """Returns a route without its first lane change if that change only names the car's first lane.

    For example, "Start in the right lane, then change to the left one" asks for only one lane change. Other
    Briefs are returned unchanged.
    """
    begins = BEGINS.search(plain(words))
    if len(brief.junctions) < 2 or begins is None:
        return brief
    own = "left" if next(filter(None, begins.groups())) in LEFT else "right"
    first, second = brief.junctions[:2]
    before, behind, *roads = brief.stretches
    changes = {first.kind, second.kind} == {"lane_change"}
    if not changes or first.take != own or second.take == own or (before.length and behind.length):
        return brief
    road = behind if before.is_open else before.model_copy(update={"length": before.length or behind.length})
    return brief.model_copy(update={"junctions": brief.junctions[1:], "stretches": (road, *roads)})


def with_told_lane(brief: Brief, words: str) -> Brief:
    """Returns a route on which a lane begins or ends behind a ramp or a lane change, where the words say so
    and the network has only written the numbers of lanes before and behind.

    The Brief is returned unchanged if it has a place where a lane begins or ends.
    """
    said = plain(words)
    if any(each.kind in ADDED for each in brief.junctions):
        return brief
    for n, place in enumerate(brief.junctions):
        before, behind = brief.stretches[n : n + 2]
        is_same_road = place.kind == "lane_change" or (place.kind in RAMPS and place.take == "main")
        if not is_same_road or not (before.lanes and behind.lanes):
            continue
        change = span(behind.lanes).lo - span(before.lanes).lo
        kind = next((kind for kind, more in ADDED.items() if more == change), None)
        if kind is None or not CHANGED[kind].search(said):
            continue
        middle = behind.model_copy(update={"lanes": before.lanes, "length": None, "clauses": ()})
        junctions = (*brief.junctions[: n + 1], JunctionClause(kind=kind), *brief.junctions[n + 1 :])
        roads = (*brief.stretches[: n + 1], middle, *brief.stretches[n + 1 :])
        return brief.model_copy(update={"junctions": junctions, "stretches": roads})
    return brief
