"""Finds at how many junctions of a map there are traffic lights, where the words count them.

The neural network writes one sign for all junctions of a map. For "six junctions, two with lights", the
number before "with lights" says that only two of them have lights.
"""

import re
from collections import Counter
from collections.abc import Mapping

from roadgpt.brief.amount import exactly
from roadgpt.brief.junctions import MapJunctionKind
from roadgpt.brief.map_clause import JunctionCount, MapClause
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.alike_junctions import NOUN
from roadgpt.brief.readers.model.map_words import (
    ALL_KINDS,
    ANY_KIND,
    KINDS_IN_PLURAL,
    TAKEN_BACK,
    is_counted,
    one_number,
    said_of,
)
from roadgpt.brief.readers.model.slots import SlottedText

LIGHTS = (
    r"(?:(?:traffic )?(?:lights|signals)|ampeln?(?:anlagen?)?|lichtsignal\w*|feux(?: tricolores)?|semafor\w*)"
)
NOUNS = rf"(?:{NOUN}|{ANY_KIND}|stars|sterne|etoiles|estrellas|stelle)"
OF = (
    r"(?:others?|of|them|which|these|those|the|davon|von|ihnen|denen|dont|d|'|entre|elles|eux|de|ellos|ellas|los|las|"
    r"cuales|di|dei|delle|quali|queste|questi|esse|essi|loro)"
)
BETWEEN = rf"((?: (?:{OF}|{NOUNS})\b){{0,5}})"
"""The words that may stand between a number of junctions and their lights."""
HAVE = r"(?:with|have|has|having|get|mit|haben|bekommen|avec|ont|con|tienen?|llevan?|hanno)"
ARTICLE = r"(?:the |a set of |eine[rn]? |des |les |un |los |i |il |el |le |dei )?"
COUNTED = re.compile(rf"\b(\d+){BETWEEN},? {HAVE} {ARTICLE}{LIGHTS}\b")
"""A number, words for junctions, and a word such as "have" before lights: "two of them have lights"."""
SIGNALLED = re.compile(rf"\b(\d+){BETWEEN} (?:are )?(?:signalled|signalised|signalized|semaforizad\w+)\b")
AT = re.compile(
    rf"\b{LIGHTS} (?:at|on|an|bei|aux?|a|en|in) (?:just |only |exactly |nur |seulement |solo )?(\d+){BETWEEN}"
    r"(?! \w+s\b(?<! others))"
)
"""Lights, a preposition and a number: "lights at two of them"."""
ONE = re.compile(
    r"\b(?:(?:only|just|exactly) one(?: other)?|(?<!every )(?<!each )one of (?:them|these|which)|"
    r"(?:nur|genau) eine[rs]?|"
    r"eine[rs]? davon|exactement une?|exactamente un[oa]|esattamente un[oa]|un seul|une seule|dont une?|"
    r"solo un[oa]|un[oa] solo|un[oa] de (?:ellos|ellas|los cuales|las cuales)|un[oa] di (?:essi|esse|loro)) "
    rf"{HAVE} {ARTICLE}{LIGHTS}\b"
)
BOUND = re.compile(
    r"(?:\b(?:at least|at most|no more than|up to|about|mindestens|hochstens|bis zu|etwa|au moins|au plus|"
    r"al menos|como mucho|almeno|al massimo|but|except|bis auf|sauf|salvo|menos|tranne|eccetto|or|oder|ou|o|"
    r"to|bis|a))$"
)
"""Words before a number with which it is no number of lights, or not an exact one."""
NONE = re.compile(
    r"\b(?:no|not|without|kein\w*|ohne|sans|pas|aucun\w*|sin|ningun\w*|non|senza|nessun\w*) "
    rf"(?:\w+ )?{LIGHTS}\b"
)
CROSSING = re.compile(r"cross|inters|kreuz|croisement|carrefour|cruce|incroc")
"""Nouns of junctions that may mean crossroads, or junctions of any kind."""
OF_ANY_KIND: tuple[MapJunctionKind, ...] = ("crossroads", "junction")


def with_counted_lights(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a map with lights at as many of its junctions as the words say.

    The Brief is returned unchanged if it has no map of junctions, if some kinds have signs of their own, or
    if the words do not give one exact number of junctions with lights that is smaller than that of all.
    """
    asked = brief.map
    said = said_of(text)
    if asked is None or not asked.junctions or asked.control not in (None, "lights", "none"):
        return brief
    are_exact = all(each.count.exact and each.control is None for each in asked.junctions)
    found = None if TAKEN_BACK.search(said) or NONE.search(said) else _lit(said)
    if found is None or not are_exact:
        return brief
    kinds = _split(asked, said, *found)
    if kinds is None:
        return brief
    control = None if asked.control == "lights" else asked.control
    return brief.model_copy(update={"map": asked.model_copy(update={"junctions": kinds, "control": control})})


def _lit(said: str) -> tuple[int, str] | None:
    """Returns how many junctions have lights, and the words for them behind the number.

    Returns None if the words do not give one exact number.
    """
    at = [*AT.finditer(said)]
    found = at or [*COUNTED.finditer(said), *SIGNALLED.finditer(said)]
    ones = ONE.findall(said)
    if len(ones) == 1 and not found:
        return 1, ""
    if len(found) != 1 or ones:
        return None
    number = found[0]
    is_bound = BOUND.search(said[: number.start(1)].strip())
    return None if is_bound else (int(number[1]), number[2])


def _split(asked: MapClause, said: str, lit: int, between: str) -> tuple[JunctionCount, ...] | None:
    """Returns the junctions of the map, those with lights apart; None if the words do not say which.

    Args:
        asked: the map.
        said: the words.
        lit: the number of junctions with lights.
        between: the words for these junctions, behind their number.
    """
    counts = Counter[MapJunctionKind]()
    for each in asked.junctions:
        counts[each.kind] += int(each.count.lo or 0)
    total = one_number(ALL_KINDS.findall(said)) or counts.total()
    if not 0 < lit < total:
        return None
    kind = _kind(between, lit, counts)
    if kind is not None:
        return _apart(counts, kind, lit)
    if len(counts) == 1:
        only = next(iter(counts))
        return _apart({only: total}, only, lit)
    named = [each for one, number in counts.items() if is_counted(each := _of(one, number), said)]
    rest = total - lit - int(sum(each.count.lo or 0 for each in named))
    if rest < 0 or {*counts} - {each.kind for each in named} - {*OF_ANY_KIND}:
        return None
    return (_of("junction", lit, True), *named, *([_of("junction", rest)] if rest else []))


def _kind(between: str, lit: int, counts: Mapping[MapJunctionKind, int]) -> MapJunctionKind | None:
    """Returns the kind of the junctions with lights, if words between the number and the lights name it."""
    kinds = [kind for kind, noun in KINDS_IN_PLURAL.items() if noun.search(f"{lit}{between}")]
    if not kinds and CROSSING.search(between):
        kinds = [kind for kind in OF_ANY_KIND if counts.get(kind, 0) >= lit]
    return kinds[0] if kinds and counts.get(kinds[0], 0) >= lit else None


def _apart(
    counts: Mapping[MapJunctionKind, int], kind: MapJunctionKind, lit: int
) -> tuple[JunctionCount, ...] | None:
    """Returns the junctions with ``lit`` of one kind apart; None if all junctions would have lights."""
    rest = dict(counts)
    rest[kind] -= lit
    if not any(rest.values()):
        return None
    return (_of(kind, lit, True), *(_of(each, number) for each, number in rest.items() if number))


def _of(kind: MapJunctionKind, number: int, has_lights: bool = False) -> JunctionCount:
    return JunctionCount(kind=kind, count=exactly(number), control="lights" if has_lights else None)
