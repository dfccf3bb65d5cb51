"""Reads "sharp left" and "sharp right" at a skew crossroads."""

import re

from roadgpt.brief.amount import at_least
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.numerals import plain

SHARP = re.compile(
    r"\bsharp(?:ly|est)? (left|right)\b(?! (?:bend|curve|corner|hairpin))|"
    r"\bscharf (?:nach )?(links|rechts)\b|\bspitz (?:nach )?(links|rechts)\b|"
    r"\b(?:serre|franchement) a (gauche|droite)\b|"
    r"\bbruscamente a la (izquierda|derecha)\b|\bbruscamente a (sinistra|destra)\b"
)
SHARPLY = at_least(100)
"""Degrees by which a route turns; across the obtuse angle of a skew crossroads it turns by less than 70."""
LEFT = ("left", "links", "gauche", "izquierda", "sinistra")


def with_sharp_side(brief: Brief, words: str) -> Brief:
    """Returns the Brief of a route that turns by 100 degrees or more at its only junction, if that is a skew
    crossroads and the words say "sharp" of the side that the route takes; else the Brief unchanged.
    """
    said = SHARP.search(plain(words))
    if said is None or len(brief.junctions) != 1:
        return brief
    junction = brief.junctions[0]
    side = "left" if next(filter(None, said.groups())) in LEFT else "right"
    is_skew = junction.kind == "crossroads" and (junction.skew or junction.angle is not None)
    if not is_skew or junction.take != side or junction.degrees is not None:
        return brief
    return brief.model_copy(update={"junctions": (junction.model_copy(update={"degrees": SHARPLY}),)})
