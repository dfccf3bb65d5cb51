"""Takes back a slope that the words only deny: "it never goes downhill and gains 14 m"."""

import re

from roadgpt.brief.model import Brief, Slope, span
from roadgpt.brief.readers.model.denial import is_denied
from roadgpt.brief.readers.model.slots import SlottedText

WORDS = {
    "down": re.compile(
        r"\b(?:down\w*|descen\w*|desciend\w*|descente|baj\w+|scend\w+|discesa|bergab\w*|abwarts|gefalle|fall(?:s|ing)?|"
        r"drop(?:s|ping)?|sink\w*)\b"
    ),
    "up": re.compile(
        r"\b(?:up\w*|climb\w*|mont(?:e|ee|er|ent|ant)|sub(?:e|en|a|an|ida|idas|ir|iendo)|sal(?:e|ga|ire|endo|ita|ite)|"
        r"bergauf\w*|aufwarts|steigt|steigen|steigung|ris(?:e|es|ing)|ascen\w*|ascienda?)\b"
    ),
}
"""Words for the two directions of a slope, in a text in lower case without accents."""
OTHER: dict[str, Slope] = {"down": "up", "up": "down"}


def with_denied_slope(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a single road with the slope of its height, if the Brief has the opposite slope
    and every mention of that in the words is denied; else the Brief unchanged.
    """
    way = (brief.slope or "").rpartition("_")[2]
    if brief.junctions or brief.map is not None or way not in WORDS:
        return brief
    climb = span(brief.climb)
    is_opposite = climb.lo > 0 if way == "down" else climb.hi < 0
    return (
        brief.model_copy(update={"slope": OTHER[way]})
        if is_opposite and _is_only_denied(way, text.text)
        else brief
    )


def _is_only_denied(way: str, said: str) -> bool:
    found = [*WORDS[way].finditer(said)]
    return bool(found) and all(is_denied(said[: each.start()]) for each in found)
