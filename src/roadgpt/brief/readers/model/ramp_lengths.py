"""Corrects the lengths of the lane and the taper at a ramp where the words say which number is which.

The network often gives such a number to the road beside the ramp: of "a deceleration lane of 80 m with a
taper of 30 m" it wrote a road of 30 m before the exit.
"""

import re
from collections.abc import Collection

from roadgpt.brief.amount import Amount, exactly
from roadgpt.brief.junctions import RAMPS
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.denial import TAKEN_BACK
from roadgpt.brief.readers.model.junction_nouns import LANE
from roadgpt.brief.readers.model.slots import SlottedText

TAPERED = ("lane_drop", "lane_gain")
"""The kinds that are a taper and nothing else."""
SLOT = r"\[unused(\d+)\] metres"
TAPER = (
    r"(?:tapers?(?: (?:out|off|away))?(?: over)?(?: another| a further)?|"
    r"verziehung|biseau|cuna|rastremazione)"
)
LINK = (
    r"(?: (?:of|is|lasts|measures|von|ist|mit|de|di|da|est|mesure|mide|es|misura|e|long|lunga?|longue|larga?|"
    r"lang|:|,))"
)
OF = r"(?: (?:of|de|di|long|lange[nr]?|d '))"
AFTER = r"(?:\b(after|in|nach|hinter|apres|dans|tras|en|despues de|dopo|fra|tra|until|bis|hasta|fino a) )?"
"""A word before a length with which it is the distance to the lane."""
INEXACT = (
    r"at least|at most|up to|no (?:more|less|longer|shorter) than|minimum|maximum|min|max|mindestens|"
    r"hochstens|bis zu|au moins|au plus|al menos|como (?:mucho|maximo|minimo)|almeno|al massimo|"
    r"or (?:more|less|longer)|oder (?:mehr|langer)|o (?:mas|piu)|ou plus"
)
"""Words with which a number is no exact one."""
BOUND = re.compile(rf"\b(?:{INEXACT}|between|zwischen|entre|tra)\b|(?:(?:to|bis)|metres a) \[unused")
"""Words with which some length is no exact one."""


def _places(noun: str) -> re.Pattern[str]:
    """Returns a pattern for a length before or behind a noun."""
    return re.compile(rf"{AFTER}{SLOT}{OF}{{0,2}} {noun}\b|\b{noun}{LINK}{{0,3}} {SLOT}")


LANES, TAPERS = _places(LANE), _places(TAPER)
ANY_LANE, ANY_TAPER = re.compile(rf"\b{LANE}\b"), re.compile(rf"\b{TAPER}\b")


def with_ramp_lengths(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a route with the lengths that the words give to its only ramp, or to the taper of
    its only lane that ends or begins.

    The Brief is returned unchanged if the words or the plan have several of these, or if a number may belong
    to several things. The roads beside it lose the number, and a ramp without a lane of its own in the words
    loses a length that is that of its taper.
    """
    places = [n for n, each in enumerate(brief.junctions) if each.kind in (*RAMPS, *TAPERED)]
    is_unclear = TAKEN_BACK.search(text.text) or BOUND.search(text.text)
    if len(places) != 1 or is_unclear:
        return brief
    at = places[0]
    told = {"length": _told(LANES, ANY_LANE, text), "taper": _told(TAPERS, ANY_TAPER, text)}
    update: dict[str, Amount | None] = {name: amount for name, amount in told.items() if amount}
    if told["length"] == told["taper"]:
        return brief
    if brief.junctions[at].kind in TAPERED:
        update = {"length": told["taper"]} if told["taper"] and not told["length"] else {}
    elif brief.junctions[at].length == told["taper"] and not ANY_LANE.search(text.text):
        update["length"] = None
    junctions, roads = list(brief.junctions), list(brief.stretches)
    junctions[at] = junctions[at].model_copy(update=update)
    for n in (at, at + 1):
        roads[n] = _without_length(roads[n], update.values(), text)
    return brief.model_copy(update={"junctions": tuple(junctions), "stretches": tuple(roads)})


def _without_length(road: Brief, told: Collection[Amount | None], text: SlottedText) -> Brief:
    """Returns a road without its length, if that is a number that the text has once, for something else."""
    is_once = [exactly(slot.value) for slot in text.slots].count(road.length or exactly(0)) == 1
    is_other = road.length is not None and road.length in told and is_once
    return road.model_copy(update={"length": None}) if is_other else road


def _told(pattern: re.Pattern[str], noun: re.Pattern[str], text: SlottedText) -> Amount | None:
    """Returns the length beside the only noun; None if there is none, or several."""
    said = text.text
    found = [int(one or other) - 1 for after, one, other in pattern.findall(said) if not after]
    if len(noun.findall(said)) != 1 or len(found) != 1 or found[0] >= len(text.slots):
        return None
    slot = text.slots[found[0]]
    return exactly(slot.value) if slot.unit == "metres" else None
