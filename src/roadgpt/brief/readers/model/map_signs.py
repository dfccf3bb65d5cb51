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
from roadgpt.brief.readers.model.map_words import (
    ALL_KINDS,
    KINDS_IN_PLURAL,
    TAKEN_BACK,
    is_counted,
    one_number,
)
from roadgpt.brief.readers.model.slots import SlottedText

LIGHTS = (
    r"(?:(?:traffic )?(?:lights|signals)|ampeln?(?:anlagen?)?|lichtsignal\w*|feux(?: tricolores)?|semafor\w*)"
)
ANY_WORD = (
    r"(?!with\b|mit\b|avec\b|con\b|and\b|und\b|et\b|y\b|e\b|no\b|without\b|sin\b|senza\b|sans\b|ohne\b)\w+"
)
HAVE = r"(?:with|have|has|having|get|mit|haben|bekommen|avec|ont|con|tienen|llevan|hanno|sono con)"
COUNTED = re.compile(rf"\b(\d+)((?: {ANY_WORD}){{0,5}}?),? {HAVE} (?:\w+ )?{LIGHTS}\b")
"""A number, the words between, and a verb or preposition for lights: "two of the crossroads have lights"."""
SIGNALLED = re.compile(
    rf"\b(\d+)((?: {ANY_WORD}){{0,4}}?) (?:signalled|signalised|signalized|semaforizad\w+)\b"
)
AT = re.compile(
    rf"\b{LIGHTS} (?:at|on|an|bei|aux?|a|en|in) (?:just |only |exactly |nur |seulement |solo )?(\d+)()"
    r"(?! (?:blocks?|metres?))\b"
)
"""Lights, a preposition and a number: "lights at two of them"."""
JUNCTIONS = re.compile(
    r"junction|intersection|knoten|interse|crossing|kreuzung|incroc|cruce|carrefour|croisement"
)
"""Nouns behind the number that may mean junctions of any kind."""


def with_counted_lights(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a map with lights at as many of its junctions as the words say.

    The Brief is returned unchanged if it has no map of junctions, or the words do not give exactly one number
    of junctions with lights that is smaller than the number of all.
    """
    asked = brief.map
    said = " ".join(word.text for word in text.words)
    if asked is None or not asked.junctions or asked.control not in (None, "lights", "none"):
        return brief
    found = [*COUNTED.findall(said), *SIGNALLED.findall(said), *AT.findall(said)]
    if len(found) != 1 or TAKEN_BACK.search(said) or not all(each.count.exact for each in asked.junctions):
        return brief
    number, between = int(found[0][0]), found[0][1]
    kinds = _split(asked, said, number, _kind(between, number), bool(JUNCTIONS.search(between)))
    if kinds is None:
        return brief
    control = None if asked.control == "lights" else asked.control
    return brief.model_copy(
        update={"map": MapClause.model_validate({**dict(asked), "junctions": kinds, "control": control})}
    )


def _kind(between: str, number: int) -> MapJunctionKind | None:
    """Returns the kind of junction that stands between the number and the lights; None if there is none."""
    words = f"{number}{between}"
    return next((kind for kind, noun in KINDS_IN_PLURAL.items() if noun.search(words)), None)


def _split(
    asked: MapClause, said: str, lit: int, kind: MapJunctionKind | None, is_any: bool
) -> tuple[JunctionCount, ...] | None:
    """Returns the junctions of the map, those with lights apart; None if the words do not say which.

    Args:
        asked: the map.
        said: the words.
        lit: the number of junctions with lights.
        kind: their kind; None if it is not said.
        is_any: whether a word for junctions of any kind stands behind the number of those with lights.
    """
    counts = Counter[MapJunctionKind]()
    for each in asked.junctions:
        counts[each.kind] += int(each.count.lo or 0)
    total = one_number(ALL_KINDS.findall(said)) or counts.total()
    if not 0 < lit < total:
        return None
    if kind is not None and kind in counts and not (is_any and kind == "crossroads" and lit > counts[kind]):
        return _apart(counts, kind, lit)
    if len(counts) == 1:
        only = next(iter(counts))
        return _apart({only: total}, only, lit)
    named = [each for one, number in counts.items() if is_counted(each := _of(one, number), said)]
    rest = total - lit - int(sum(each.count.lo or 0 for each in named))
    if rest < 0:
        return None
    return (_of("junction", lit, True), *named, *([_of("junction", rest)] if rest else []))


def _apart(
    counts: Mapping[MapJunctionKind, int], kind: MapJunctionKind, lit: int
) -> tuple[JunctionCount, ...] | None:
    """Returns the junctions with ``lit`` of one kind apart; None if there are fewer of this kind."""
    rest = dict(counts)
    rest[kind] -= lit
    if rest[kind] < 0 or not any(rest.values()):
        return None
    return (_of(kind, lit, True), *(_of(each, number) for each, number in rest.items() if number))


def _of(kind: MapJunctionKind, number: int, has_lights: bool = False) -> JunctionCount:
    return JunctionCount(kind=kind, count=exactly(number), control="lights" if has_lights else None)
