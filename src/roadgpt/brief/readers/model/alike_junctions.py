"""Counts junctions that are all alike: the network writes each of them, and loses count of more than four."""

import re

from roadgpt.brief.junctions import LANE_KINDS, RAMPS
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.junction_nouns import PLURAL
from roadgpt.brief.readers.model.slots import SlottedText

MOST = 9  # junctions of a route that a reader writes
OTHERS = r"more|other|further|weiteren?|andere|autres|otr[ao]s|altr[ei]|mas|piu|de plus"
APART = r"(?:and|und|et|y|e|between|way|lane|arm|turns?|bends?|curves?|kurven|virages|curvas|curve|blocks?)\b"
"""Words that part a number from junctions named behind them, as in "3 bends and roundabouts"."""
COUNT = re.compile(
    rf"(?<!(?:altre|altri|otras|otros) )\b(\d+) (?!{OTHERS})(?:(?!{APART})[^\W\d]\w* ){{0,2}}?{PLURAL}\b"
)
"""A number before the plural of a word for junctions, in a text without accents."""


def with_counted_junctions(brief: Brief, text: SlottedText) -> Brief:
    """Returns a route of junctions that are all alike, with as many of them as the words say.

    The Brief is returned unchanged if its junctions differ, if the roads between them differ, or if the words
    do not give exactly one number of junctions, from 2 to 9. It is also unchanged if the words contain the
    number of its junctions, as in "five, no, make it two". Ramps and lane changes also stay.
    """
    junctions, inner = brief.junctions, brief.stretches[1:-1]
    if len(junctions) < 2 or len({*junctions}) > 1 or any(road != inner[0] for road in inner):
        return brief
    found = COUNT.findall(text.text)
    number = int(found[0]) if len(found) == 1 else 0
    is_said = str(len(junctions)) in {word.text for word in text.words}
    if is_said or junctions[0].kind in (*RAMPS, *LANE_KINDS) or not 2 <= number <= MOST:
        return brief
    roads = (brief.stretches[0], *[inner[0]] * (number - 1), brief.stretches[-1])
    return brief.model_copy(update={"junctions": (junctions[0],) * number, "stretches": roads})
