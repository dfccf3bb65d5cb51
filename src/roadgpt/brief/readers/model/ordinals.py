"""Finds the places in a row that words name: "the first and the last", "the first two", "all but the third",
in five languages. The texts are those that the networks read: lower case, no accents, a space on each side
of a punctuation mark.
"""

import re
from collections.abc import Mapping

PLACES: Mapping[int, str] = {
    -2: r"second - to - last|second last|last but 1|penultimate|next to last|vorletzte[nrms]?|"
    r"avant - derni(?:er|ere)|penultim[oa]",
    1: r"first|1st|erste[nrms]?|premi(?:er|ere)s?|1er|1ere|primer[oa]?s?|prim[oaie]",
    2: r"second|2nd|zweite[nrms]?|deuxieme|2e|second[eoa]|segund[oa]",
    3: r"third|3rd|dritte[nrms]?|troisieme|3e|tercer[oa]?|terz[oa]",
    4: r"fourth|4th|vierte[nrms]?|quatrieme|4e|cuart[oa]|quart[oa]",
    5: r"fifth|5th|funfte[nrms]?|cinquieme|5e|quint[oa]",
    6: r"sixth|6th|sechste[nrms]?|sixieme|6e|sext[oa]|sest[oa]",
    7: r"seventh|7th|sieb(?:en)?te[nrms]?|septieme|7e|septim[oa]|settim[oa]",
    8: r"eighth|8th|achte[nrms]?|huitieme|8e|octav[oa]|ottav[oa]",
    9: r"ninth|9th|neunte[nrms]?|neuvieme|9e|noven[oa]|non[oa]",
    10: r"tenth|10th|zehnte[nrms]?|dixieme|10e|decim[oa]",
    -1: r"last|final|letzte[nrms]?|derni(?:er|ere)s?|ultim[oaie]s?",
}
"""The words for each place; places below 0 are counted from the end."""
MIDDLE = r"middle|mittlere[nrms]?|du milieu|del medio|de en medio|di mezzo|central[ei]?"
"""Words for the place in the middle of an odd number of things."""
PLACE = rf"(?:{'|'.join(PLACES.values())})"
ORDINAL = rf"(?:{PLACE}|{MIDDLE})"
ARTICLE = r"(?:(?:the|die|der|das|dem|den|des|le|la|les|el|los|las|il|lo|i|gli)|l ')"
DETERMINER = rf"(?:{ARTICLE}|al|alla|allo|del|della|du|aux?|(?:all|dell) ')"
AND = r"(?:(?: ,)? (?:and|und|sowie|et|y|e|plus|&))"
BOTH = r"(?:\d+|beiden|couple)"
ITEM = rf"(?:\d+ )?{ORDINAL}\b(?: {BOTH}\b)?"
WHICH = rf"(?:{DETERMINER} )*{ITEM}(?:(?:{AND} (?:{DETERMINER} )*| , (?:{ARTICLE} )*){ITEM})*"
"""A list of places, such as "the first and the last" or "the first 2"."""
REST = (
    r"(?:others?|rest|remaining|ubrigen?|anderen?|restlichen?|autres?|reste|demas|otr[ao]s?|resto|"
    r"altr[ieo]|restanti)"
)
"""Words for those things of a row that are not named."""
OTHERS = (
    rf"(?:(?:{DETERMINER} )+(?:\d+ )?{REST}(?: \d+)?|"
    r"(?:\d+ )?(?:others|rest|remaining|autres|otr[ao]s|demas|altr[ie]|ubrigen|anderen|restlichen)(?: \d+)?)"
)
"""Phrases for all things of a row that are not named; "otra" and "autre" alone mean one more."""
EXCEPT = (
    r"(?:but(?: for)?|except(?: for)?|apart from|save(?: for)?|bis auf|au(?:ss|ß)er|abgesehen von|sauf|"
    r"hormis|excepte|a part|a l ' exception d(?:es?|u| ')|salvo|menos|excepto|tranne|eccetto|meno|a parte)"
)
_PLURAL = re.compile(r"(?:premi|derni)(?:er|ere)s|primer[oa]s|prim[ie]|ultim(?:[oa]s|[ie])")
_PLACE = {number: re.compile(rf"(?:{words})") for number, words in PLACES.items()}
_ITEM = re.compile(rf"(?:(\d+) )?({ORDINAL})\b(?: ({BOTH})\b)?")
OF_THEM = (
    r"(?:of (?:them|these|which)|davon|d ' (?:entre )?(?:eux|elles)|de (?:ell[oa]s|l[oa]s cuales)|"
    r"di (?:ess[ie]|loro))"
)
ONLY = (
    r"(?:just |only |exactly |nur |genau |seulement |exactement |solo |solamente |exactamente |esattamente |"
    r"soltanto )"
)
ALL = (
    r"(?:all|every|everywhere|alle[nr]?|samtliche[nr]?|jede[rnms]?|uberall|tous|toutes|partout|tod[oa]s|"
    r"en todas partes|tutt[ie]|ogni|dappertutto|ovunque)"
)


def place_of(word: str) -> int | None:
    """Returns the place that an ordinal means, from 1, or below 0 from the end; None for other words."""
    return next((number for number, words in _PLACE.items() if words.fullmatch(word)), None)


def places_in(said: str, number: int) -> frozenset[int] | None:
    """Returns the places, counted from 0, that a list of ordinals names in a row.

    Args:
        said: words that ``WHICH`` matches, such as "the first 2 and the last".
        number: how many things the row has.

    Returns:
        The places; None if the row is too short, if "middle" is said of an even number of things, or if a
        plural such as "les premiers" has no number.
    """
    out = set[int]()
    for before, ordinal, behind in _ITEM.findall(said):
        found = _places_of(ordinal, before or behind, number)
        if found is None:
            return None
        out |= found
    return frozenset(out) or None


def _places_of(ordinal: str, several: str, number: int) -> set[int] | None:
    place = place_of(ordinal)
    count = int(several) if several.isdecimal() else 2 if several else 1
    if place is None:
        return {number // 2} if number % 2 and count == 1 else None
    if count > number or abs(place) > number or (count > 1 and place not in (1, -1)):
        return None
    if not several and _PLURAL.fullmatch(ordinal):  # how many is not said
        return None
    if count > 1:
        return {*range(count)} if place == 1 else {*range(number - count, number)}
    return {place - 1 if place > 0 else number + place}
