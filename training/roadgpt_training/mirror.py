"""Swaps left and right in a description and in its plan."""

import re
from collections.abc import Sequence

PAIRED = (
    "left/right lefts/rights leftward/rightward leftwards/rightwards lefthand/righthand "
    "lefthander/righthander lefthanders/righthanders lefty/righty l/r lh/rh links/rechts "
    "linke/rechte linken/rechten linker/rechter linkes/rechtes linkskurve/rechtskurve "
    "linkskurven/rechtskurven linkskehre/rechtskehren linksbogen/rechtsbogen "
    "linkskehren/rechtskehren linksherum/rechtsherum gauche/droite gauches/droites "
    "izquierda/derecha izquierdas/derechas izquierdo/derecho sinistra/destra sinistro/destro "
    "sinistre/destre sinistri/destri "
)
"""Pairs of words for left and right in five languages."""
ON_ROUTES = (
    "halblinks/halbrechts linksab/rechtsab linksabbiegen/rechtsabbiegen linkerhand/rechterhand "
    "linksabbieger/rechtsabbieger linksseitig/rechtsseitig linksseitige/rechtsseitige izda/dcha sx/dx"
)
"""Further pairs of words, which occur in routes with junctions."""
OTHER = {
    a: b
    for pair in (words.split("/") for words in f"{PAIRED}{ON_ROUTES}".split())
    for a, b in (pair, pair[::-1])
}
UNSAFE = re.compile(
    r"\bright(?: |-)(?:angle|away|after|now|at|in|before|on|from|there|then|up|down|into)|"
    r"all right|\bis left\b|left over|"
    r"leave|turn(?:s|ed)? out|right\?|\br ?=|\bderecho|\btodo recto|\br\d|\bl ?=|droit\b|clockwise|direct",
    re.I,
)
A_WAY = re.compile(
    r"\b(?:(?:turn|go|bear|keep|stay|hang|head|fork|branch)(?:s|ing)?|take (?:a|the)|second|third|next|sharp|"
    r"slight|hard|half|(?:on|from|to) (?:the|your|my)) (?:left|right)\b"
    r"(?! (?:after|before|away|now|from|then|there|angle|behind)|-angle)|"
    r"\btout droit\b|\bleave(?= the round)",
    re.I,
)
"""Phrases in which "right" certainly means a side, and "droit" certainly means straight on."""
ONE_SIDED = re.compile(r"hand traffic|driv\w* on the|(?:links|rechts)verkehr|rechts vor", re.I)
"""Phrases that say on which side of the road to drive."""
UNSAFE_ON_ROUTES = re.compile(
    r"right[ -]of|right,? (?:before|then|so|ok)|hand (?:traffic|side of the road|drive)|driv\w+ on the|"
    r"rechts (?:vor|hat|haben|kommt|faehrt)|winklig|rechten winkel|verkehr|priorit.{1,3} [aà] (?:la )?dr|"
    r"precedenza a|preferencia (?:a|de)|from the right|von rechts|da destra|desde la derecha|\bde droite",
    re.I,
)
"""Phrases in which left and right must not be swapped, such as right of way or traffic on the left."""
SIDED = re.compile(r"left|right|link|recht|gauch|droit|izq|derech|destr|sinist", re.I)
NO_SIDE = re.compile(r"(?:tout|todo) (?:droit|recto)|links?\b(?= (?:two|the|it|both))", re.I)
IN_PLAN = re.compile(r"\b(?:left|right)(?:\+(?:left|right|straight))+|[a-z_]+")
MIRRORED_WORDS = {
    "left": "right", "right": "left", "lefts": "rights", "rights": "lefts", "lefts=": "rights=",
    "rights=": "lefts=",
    "sharp_left": "sharp_right", "sharp_right": "sharp_left",
    "slight_left": "slight_right", "slight_right": "slight_left",
    "left+straight": "right+straight", "right+straight": "left+straight",
}  # fmt: skip
"""Words and tokens of plans that name one side, each with the word or token for the other side."""
OF_JUNCTIONS = re.compile(
    r"//|\|\||^ *(?:t_junction|y_junction|crossroads|star|roundabout|junction|merge|diverge|lane_\w+|map)\b"
)
SIDES_IN_PLAN = re.compile(r"(?<![a-z])(?:(?:sharp|slight)_)?(?:left|right)s?(?![a-z])")


def mirrored(text: str, plan: str) -> tuple[str, str] | None:
    """Returns text and plan with left and right swapped; None if text or plan names neither side, if the plan
    asks for traffic on the left, or if a word of the text is ambiguous.

    For a route with junctions, the result is also None if a word for a side may mean something else, or if
    the plan has the number of an exit but lacks a direction that the text also gives.
    """
    named = len(SIDES_IN_PLAN.findall(plan))
    if not named or "left_hand" in plan:
        return None
    is_route = is_of_junctions(plan)
    if is_route and not _is_safe_route(text, plan, named):
        return None
    swapped = _swapped(text) if is_route else in_mirror(text)
    return None if swapped is None else (swapped, in_mirror_plan(plan))


def is_of_junctions(plan: str) -> bool:
    """Returns whether a plan is a route with junctions or a map."""
    return OF_JUNCTIONS.search(plan) is not None


def _is_safe_route(text: str, plan: str, named: int) -> bool:
    if UNSAFE_ON_ROUTES.search(text) or UNSAFE.search(A_WAY.sub(" ", text)):
        return False
    sides = [word for word in re.findall(r"[^\W\d_]+", NO_SIDE.sub(" ", text)) if SIDED.search(word)]
    if any(word.lower() not in OTHER for word in sides):
        return False
    return "exit=" not in plan or len(sides) <= named


def in_mirror(text: str) -> str | None:
    """Returns the text with left and right swapped; None if it names neither side, or a word is ambiguous."""
    is_unsafe = UNSAFE.search(A_WAY.sub(" ", text)) or ONE_SIDED.search(text)
    return None if is_unsafe else _swapped(text)


def _swapped(text: str) -> str | None:
    swapped = re.sub(r"[^\W\d_]+", lambda match: _other(match[0]), text)
    return None if swapped == text else swapped


def in_mirror_plan(plan: str) -> str:
    """Returns a plan with left and right swapped."""
    return IN_PLAN.sub(lambda match: MIRRORED_WORDS.get(match[0], match[0]), plan)


def in_mirror_tokens(tokens: Sequence[str]) -> tuple[str, ...]:
    """Returns the tokens of a plan with left and right swapped."""
    return tuple(MIRRORED_WORDS.get(token, token) for token in tokens)


def _other(word: str) -> str:
    other = OTHER.get(word.lower())
    if other is None or (len(word) == 1 and word.islower()):
        return word
    if word.isupper():
        return other.upper()
    return other.capitalize() if word[:1].isupper() else other
