"""The same description seen in a mirror: left for right, in the text and in the plan."""

import re

PAIRED = (
    "left/right lefts/rights leftward/rightward leftwards/rightwards lefthand/righthand "
    "lefthander/righthander lefthanders/righthanders lefty/righty l/r lh/rh links/rechts "
    "linke/rechte linken/rechten linker/rechter linkes/rechtes linkskurve/rechtskurve "
    "linkskurven/rechtskurven linkskehre/rechtskehre linksbogen/rechtsbogen "
    "linkskehren/rechtskehren linksherum/rechtsherum gauche/droite gauches/droites "
    "izquierda/derecha izquierdas/derechas izquierdo/derecho sinistra/destra sinistro/destro "
    "sinistre/destre sinistri/destri "
)
"""Left and right in five languages."""
OTHER = {a: b for pair in (words.split("/") for words in PAIRED.split()) for a, b in (pair, pair[::-1])}
UNSAFE = re.compile(
    r"\bright(?: |-)(?:angle|away|after|now|at|in|before|on|from|there|then|up|down|into)|"
    r"all right|\bis left\b|left over|"
    r"leave|turn(?:s|ed)? out|right\?|\br ?=|\bderecho|\btodo recto|\br\d|\bl ?=|droit\b|clockwise|direct",
    re.I,
)


def mirrored(text: str, plan: str) -> tuple[str, str] | None:
    """Text and plan with sides swapped; None where a word may not mean a side."""
    if UNSAFE.search(text) or not re.search(r"\b(?:left|right|lefts|rights)\b", plan):
        return None
    swapped = re.sub(r"[^\W\d_]+", lambda match: _other(match[0]), text)
    if swapped == text:
        return None
    return swapped, re.sub(r"\b(lefts|rights|left|right)\b", lambda match: OTHER[match[1]], plan)


def _other(word: str) -> str:
    other = OTHER.get(word.lower())
    if other is None or (len(word) == 1 and word.islower()):
        return word
    if word.isupper():
        return other.upper()
    return other.capitalize() if word[:1].isupper() else other
