"""The lane in which the words say that the car begins, which is no change of lanes."""

import re

from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.numerals import plain

BEGINS = re.compile(
    r"\b(?:in|on) the (left|right)(?:most|-hand| hand)? lane\b|"
    r"\b(?:auf|in) de[rm] (linken|rechten) (?:fahr)?(?:spur|streifen)\b|"
    r"\b(?:sur|dans) la (?:voie|file) de (gauche|droite)\b|"
    r"\b(?:en|por) el carril (?:de la )?(izquierd[ao]|derech[ao])\b|"
    r"\b(?:nella|sulla|in) corsia (?:di )?(sinistra|destra)\b"
)
CHANGES = re.compile(
    r"\b(?:chang|switch|mov[ei]|get over|pull|shift|wechs|pass|depla|rabat|deboit|cambi|pas[ao]|spost|einord)"
)
LEFT = ("left", "linken", "gauche", "izquierdo", "izquierda", "sinistra")


def without_own_lane(brief: Brief, words: str) -> Brief:
    """Returns a route without the lane change that the network writes where the words name the lane in which
    the car begins: "start in the right lane, then change to the left one" has one change.
    """
    begins = BEGINS.search(plain(words))
    if len(brief.junctions) < 2 or begins is None or CHANGES.search(plain(words)[: begins.start()]):
        return brief
    own = "left" if next(filter(None, begins.groups())) in LEFT else "right"
    first, second = brief.junctions[:2]
    changes = {first.kind, second.kind} == {"lane_change"}
    if not changes or first.take != own or second.take == own:
        return brief
    before, behind, *roads = brief.stretches
    kept = behind if before.is_open else before
    return brief.model_copy(update={"junctions": brief.junctions[1:], "stretches": (kept, *roads)})
