"""Swaps left and right in a description and in its plan."""

import re
from collections.abc import Sequence

PAIRED = (
    "left/right lefts/rights leftward/rightward leftwards/rightwards lefthand/righthand "
    "lefthander/righthander lefthanders/righthanders lefty/righty l/r lh/rh links/rechts "
    "linke/rechte linken/rechten linker/rechter linkes/rechtes linkskurve/rechtskurve "
    "linkskurven/rechtskurven linkskehre/rechtskehre linksbogen/rechtsbogen "
    "linkskehren/rechtskehren linksherum/rechtsherum gauche/droite gauches/droites "
    "izquierda/derecha izquierdas/derechas izquierdo/derecho sinistra/destra sinistro/destro "
    "sinistre/destre sinistri/destri "
)
"""Pairs of words for left and right in five languages."""
OTHER = {a: b for pair in (words.split("/") for words in PAIRED.split()) for a, b in (pair, pair[::-1])}
UNSAFE = re.compile(
    r"\bright(?: |-)(?:angle|away|after|now|at|in|before|on|from|there|then|up|down|into)|"
    r"all right|\bis left\b|left over|"
    r"leave|turn(?:s|ed)? out|right\?|\br ?=|\bderecho|\btodo recto|\br\d|\bl ?=|droit\b|clockwise|direct",
    re.I,
)


TOKENS = {"left": "right", "right": "left", "lefts=": "rights=", "rights=": "lefts="}


def mirrored(text: str, plan: str) -> tuple[str, str] | None:
    """Returns text and plan with left and right swapped; None if the plan names neither side, or a word is
    ambiguous.
    """
    if not re.search(r"\b(?:left|right|lefts|rights)\b", plan):
        return None
    swapped = in_mirror(text)
    if swapped is None:
        return None
    return swapped, re.sub(r"\b(lefts|rights|left|right)\b", lambda match: OTHER[match[1]], plan)


def in_mirror(text: str) -> str | None:
    """Returns the text with left and right swapped; None if it names neither side, or a word is ambiguous."""
    swapped = re.sub(r"[^\W\d_]+", lambda match: _other(match[0]), text)
    return None if swapped == text or UNSAFE.search(text) else swapped


def in_mirror_tokens(tokens: Sequence[str]) -> tuple[str, ...]:
    """Returns the tokens of a plan with left and right swapped."""
    return tuple(TOKENS.get(token, token) for token in tokens)


def _other(word: str) -> str:
    other = OTHER.get(word.lower())
    if other is None or (len(word) == 1 and word.islower()):
        return word
    if word.isupper():
        return other.upper()
    return other.capitalize() if word[:1].isupper() else other
