"""Finds the words that ask for left-hand traffic, in five languages."""

import re

from roadgpt.brief.model import Brief
from roadgpt.brief.words import unaccented

COUNTRIES = (
    r"(?:great )?britain|the uk|england|scotland|wales|ireland|dublin|london|bristol|japan|australia|"
    r"india|kenya|new zealand|south africa|malta|cyprus|schottland|irland|grossbritannien|"
    r"großbritannien|australien|angleterre|ecosse|irlande|londres|japon|australie|royaume-uni|jersey|"
    r"inglaterra|escocia|irlanda|reino unido|inghilterra|scozia|londra|giappone|regno unito|cipro"
)
SAYS = re.compile(
    r"left[- ]?hand traffic|\blht\b|traffic (?:(?:is|keeps|drives|goes) )?(?:on the )?left\b(?! lane)|"
    r"\bdriv(?:e|es|ing) (?:on|to) the left\b(?! lane)|\bso on the left|"
    r"on the left(?:-hand)? side of the road like|wrong side,? ie the left|"
    r"linksverkehr|\bfahr(?:en|t) (?:sie |wir |man )?(?:links,|auf der linken (?:strassen)?seite)|"
    r"\b(?:conduite|circulation) a gauche|\b(?:roul|condui|circul)\w* a gauche|\btient la gauche|"
    r"\b(?:circul|conduc|condu[cz]|manej|transit|trafico)\w*(?: siempre)? por la izquierda|"
    r"\bguida\w* a sinistra|\b(?:si|che) (?:viaggia|guida|circola|tiene) (?:a |la |sulla )?sinistra|"
    r"\bbritish (?:rules|traffic)"
)
BY_PLACE = re.compile(
    rf"\b(?:as|like|wie|comme|como|come)(?: we| man)?(?: drive| roads?)? (?:in|en|a|au) (?:{COUNTRIES})\b|"
    rf"\b(?:in|en|a|au|siamo a|this is) (?:{COUNTRIES})\b[^.;]{{0,24}}"
    r"\b(?:left|links|gauche|izquierda|sinistra)(?=\b(?!.{0,8}(?:bend|turn|kurve|virage|curva)))|"
    rf"\bthis is (?:{COUNTRIES})\b|^(?:in|en|a|au) (?:{COUNTRIES})\b[:,]|"
    r"\bbritish roads|like the (?:british|uk)\b|ponmelo britanico"
)
TRAFFIC = re.compile(r"traffic|verkehr|circulation|circulacion|circolazione|trafico")
FORK = re.compile(r"\b(?:bivio|biforcazione|fourche|bifurcation)\b")
"""Where "keep left" says where the route goes."""
NEGATED = re.compile(
    r"\b(?:no|not|without|never|kein|keinen|nicht|ohne|pas de|sans|sin|senza)\b(?:\s\w+)?\s*$"
)


def says_left_hand(words: str, by_place: bool = False) -> bool:
    """Returns True if a description in English, German, French, Spanish or Italian asks for traffic that
    drives on the left side of the road.

    Args:
        words: the description.
        by_place: True if naming a country ("as in Scotland") also asks for it.
    """
    said = unaccented(words)
    found = [*SAYS.finditer(said), *(BY_PLACE.finditer(said) if by_place else ())]
    is_at_fork = FORK.search(said) is not None
    return any(
        not NEGATED.search(said[: each.start()]) and not (is_at_fork and "tien" in each[0]) for each in found
    )


def with_driving_side(brief: Brief, words: str) -> Brief:
    """Returns the Brief with traffic on the left if the Brief or the words ask for it; otherwise unchanged.

    The phrase "left-hand traffic" does not ask for other cars: if no other word of the description does,
    "traffic" is removed from ``beside``, the things that are mentioned but not required.
    """
    if not (brief.left_hand or says_left_hand(words)):
        return brief
    has_others = TRAFFIC.search(SAYS.sub(" ", unaccented(words))) is not None
    beside = tuple(name for name in brief.beside if has_others or name != "traffic")
    return brief.model_copy(update={"left_hand": True, "beside": beside})
