"""Removes the lane change that the network may write if words only name the lane in which the car begins."""

import re

from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.numerals import plain

BEGINS = re.compile(
    r"\b(?:start|begin|set off|setting off|starting|beginning)\w*(?: out| off)? (?:in|on) the (left|right)"
    r"(?:most|-hand| hand)? lane\b|"
    r"\b(?:beginn|start)\w*(?: wir| man)? (?:auf|in) de[rm] (linken|rechten) (?:fahr)?(?:spur|streifen)\b|"
    r"\b(?:commenc|demarr|part)\w* (?:sur|dans) la (?:voie|file) de (gauche|droite)\b|"
    r"\b(?:empez|empiez|sal)\w* (?:en|por) el carril (?:de la )?(izquierd[ao]|derech[ao])\b|"
    r"\b(?:cominc|iniz|part)\w* (?:nella|sulla|in) corsia (?:di )?(sinistra|destra)\b"
)
LEFT = ("left", "linken", "gauche", "izquierdo", "izquierda", "sinistra")


def without_own_lane(brief: Brief, words: str) -> Brief:
    """Returns a route without its first lane change if this is only the lane in which the car begins.

    "Start in the right lane, then change to the left one" has one lane change. Other Briefs are returned
    unchanged.
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
