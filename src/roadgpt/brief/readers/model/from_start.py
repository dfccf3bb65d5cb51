"""Reads distances that are counted from the start of a route: with "crossroads at 70 m, T-junction at 240 m,
both from the start" the road between the junctions is 170 m long.
"""

import re
from itertools import pairwise

from roadgpt.brief.amount import exactly
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.numerals import plain

START = r"(?:start(?:ing)?(?: (?:line|point|position))?|beginning|origin)"
FROM_START = re.compile(
    rf"\b(?:(?:from|after|past|beyond) (?:the |my |our |its )?{START}|"
    r"(?:vom|ab|nach dem|ab dem|seit dem) (?:start|anfang|beginn)\w*|"
    r"(?:depuis|apres|a partir d[ue]|d[ue]) (?:le |la |l ?')?(?:depart|debut|origine)|"
    r"(?:desde|despues de|a partir de) (?:el |la |l )?(?:salida|inicio|origen|principio|comienzo)|"
    r"(?:dal|dalla|dall ?'|dopo il|dopo la) ?(?:partenza|inizio|origine))\b"
)
MEASURE = r"\d+(?:[.,]\d+)? ?(?:m|met\w+|yds?|yards|ft|feet)?"
OF_ALL = re.compile(
    r"\b(?:both|all|each|every|measured|counted|seen|given|distances?|positions?|places?|points?|chainages?|"
    r"alle|beide|jeweils|gemessen|gezahlt|gerechnet|abstande|entfernungen|positionen|"
    r"tou(?:s|tes)|chaque|mesure\w*|compte\w*|distances|positions|"
    r"tod[oa]s|ambas|ambos|cada|medid\w+|contad\w+|distancias|posiciones|"
    r"tutt[ei]|entramb[ei]|ogni|misurat\w+|contat\w+|distanze|posizioni)\b|"
    rf"{MEASURE},? (?:and|und|et|y|e) {MEASURE} {FROM_START.pattern}"
)
"""Words that say that several distances are counted from the start."""
AT = re.compile(rf"\b(?:at|bei|a)(?: (?:m|metre|meter))? {MEASURE}")
STATION = re.compile(r"\b(?:at|bei) \d+(?:[.,]\d+)? ?(?:m|met\w+)\b")
"""A place on the road in English or German. Two such places count from the start, even if no word says so."""
FROM_ELSEWHERE = re.compile(
    r"\b(?:further|farther|another|more|later|next|onwards?|apart|weiter\w*|spater|nachste\w*|danach|davon|"
    r"plus loin|encore|suivante?|mas (?:adelante|alla)|otros|siguiente|piu avanti|altri|altre)\b|"
    r"\b(?:after|past|beyond|behind|from) "
    r"(?!\d|(?:the )?(?:left|right)\b|which|(?:one|two|three|four) (?:lanes?|to)\b)[a-z]+|"
    r"\bnach (?!links|rechts|\d)[a-z]+|\bapres (?!\d)[a-z]+|\bdespues de (?!\d)[a-z]+|"
    r"\bdopo (?!\d)[a-z]+|\bdal?l? (?:prim|second|terz|bivi|incroci|quest|precedent)\w*|"
    r"\bdu (?:premier|second|precedent)"
)
"""Words that count a distance from another place than the start."""
IS_END = re.compile(r"\b(?:ends?|ende[nt]?|fini\w*|fin|termin\w+|acaba)\b")


def with_distances_from_start(brief: Brief, words: str) -> Brief:
    """Returns the Brief of a route with the lengths of the roads before its junctions, if the words count the
    distances of these junctions from the start; else the Brief unchanged.
    """
    parts = re.split(r"[.;](?!\d)", plain(words))
    said = ";".join(part for part in parts if not IS_END.search(part))
    found = FROM_START.findall(said)
    are_stations = len(STATION.findall(said)) > 1
    is_of_all = len(found) > 1 or OF_ALL.search(said) or len(AT.findall(said)) > 1
    is_from_start = are_stations or (found and is_of_all)
    if not brief.junctions or not is_from_start or FROM_ELSEWHERE.search(FROM_START.sub("", said)):
        return brief
    roads = brief.stretches[: len(brief.junctions)]
    lengths = [road.length.lo if road.length and road.length.exact else None for road in roads]
    places = [length for length in lengths if length is not None]
    if len(places) < 2 or lengths[: len(places)] != places:
        return brief
    if any(one >= other for one, other in pairwise(places)):
        return brief
    between = [other - one for one, other in pairwise([0.0, *places])]
    changed = [
        road.model_copy(update={"length": exactly(round(length, 1))})
        for road, length in zip(brief.stretches, between, strict=False)
    ]
    return brief.model_copy(update={"stretches": (*changed, *brief.stretches[len(changed) :])})
