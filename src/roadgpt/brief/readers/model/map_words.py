"""Finds what words say about a map of roads: whether only a map is wanted, without a route, and how many dead
ends or blocks the map has.
"""

import re
from collections.abc import Sequence
from math import isqrt

from roadgpt.brief.amount import Amount, exactly, span
from roadgpt.brief.junction_check import has_fixed_arms, least_ends, most_ends
from roadgpt.brief.junctions import JunctionCount, MapClause
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.denial import DENIAL, TAKEN_BACK, WITHOUT, says
from roadgpt.brief.readers.model.junction_nouns import (
    ANY_KIND,
    CROSSING_NOUNS,
    EITHER,
    KINDS_IN_PLURAL,
    KINDS_IN_SINGULAR,
    OF_THESE,
    SIDE_STREETS,
    SINGLE_T,
)
from roadgpt.brief.readers.model.route_words import said_of
from roadgpt.brief.readers.model.slots import SlottedText

ONE = r"one|single|ein(?:e[nm]?|zige\w*)?|une?|seul|un[ao]?|solo"
DEAD_END = (
    r"(?:dead(?: -)? ends?|cul - de - sacs?|sackgassen?|impasses?|(?:callejon\w*|calles?) sin salida|"
    r"vicol[io] ciec(?:o|hi)|strad[ae] senza uscita)"
)
DEAD_ENDS = re.compile(rf"\b(\d+|{WITHOUT}|{ONE}) (?:\w+ )?{DEAD_END}\b")
NO_ENDS = re.compile(
    r"\bno (?:roads?|streets?) (?:that |which )?(?:just |simply )?ends?\b(?! (?:at|in|on)\b)|"
    r"\bkeine stra(?:ss|ß)e endet\b"
)
ONE_END = re.compile(
    rf"(?:\b(?:exactly|only|just|genau|nur|exactement|exactamente|esattamente) (?:{ONE})|"
    rf"\b(?:a single|une seule|una sola|un solo|un unico|una unica|eine einzige)) (?:\w+ )?{DEAD_END}\b"
)
ROAD_OUT = (
    r"(?:(?:roads?|streets?) (?:that )?(?:leads? out|leading out|goes? out|"
    r"leaves? (?:it|the (?:town|village)))|"
    r"(?:stra(?:ss|ß)en?|wege?) (?:(?:fuhr\w*|geh\w*) )?(?:\w+ ){0,3}?(?:hinaus|heraus)|"
    r"(?:routes?|rues?|chemins?) (?:qui )?(?:menent|mene|sortent|sort) (?:hors|du|de la|vers l ' exterieur)|"
    r"(?:caminos?|calles?|carreteras?) (?:que )?(?:llevan?|conducen?|salen?) (?:hacia )?(?:a)?fuera|"
    r"(?:strad[ae]|vi[ae]) (?:che )?(?:portano?|porta|conduc\w+|escono|esce) fuori)"
)
"""A road that leads out of a map, which counts as a dead end."""
ROADS_OUT = re.compile(rf"\b(\d+|{WITHOUT}) (?:\w+ )?{ROAD_OUT}\b")
ENDS = rf"(?:\w+ )?(?:{DEAD_END}|{ROAD_OUT})\b"
LEAST_ENDS = re.compile(rf"\b(?:at least|mindestens|au moins|al menos|almeno) (\d+) {ENDS}")
MOST_ENDS = re.compile(
    rf"\b(?:at most|no more than|up to|hochstens|maximal|bis zu|au plus|como mucho|al massimo) (\d+) {ENDS}"
)
RANGE_OF_ENDS = re.compile(
    rf"\b(?:(\d+) (?:to|bis|a|-) (\d+)|(?:between|zwischen|entre|tra) (\d+) (?:and|und|et|y|e) (\d+)) {ENDS}"
)
BLOCKS = re.compile(
    rf"\b(\d+|{WITHOUT}|{ONE}) (?:\w+ )?(?:blocks?|(?:hauser)?blocke?|ilots?|manzanas?|isolat[oi])\b"
)
BY = re.compile(
    r"\b(\d+) (?:blocks? |(?:hauser)?blocke? |ilots? |manzanas? |isolati )?"
    r"(?:by|x|mal|auf|par|per|por|sur) (\d+)\b(?! (?:lanes?|spuren|streifen|voies|carriles|corsie))"
)
SIDE_OF_BLOCK = re.compile(
    r"\b(?:blocks?|(?:hauser)?blocken?|ilots|manzanas|isolati) (?:of|von|de|di) \[unused(\d+)\] metres\b"
)
IN_A_ROW = re.compile(
    r"\bin (?:one|1|a|single|einer|una) (?:single |einzigen )?(?:row|reihe|fila)\b|en (?:une )?rangee"
)
ACROSS = re.compile(
    r"\b(?:by|across|columns?|rows|mal|auf|spalten?|reihen|colonn\w+|rangees|filas|righe|sur|par|por|per|"
    r"deep|high|north|south|each|long|len\w*|lang|x)\b"
)
"""Words of grids whose total number of blocks may be larger than the number in the text ("3 blocks deep")."""
WIDE = re.compile(
    r"\b(?:wide|width|side|square|breit\w*|seite\w*|quadrat\w*|larg\w+|cote|carre\w*|anch\w+|lad[oi])\b"
)
"""Words that show that a number of blocks may count only one side of a grid."""
IN_ALL = r"in all|in total|all told|altogether|insgesamt|en tout|au total|en total|in tutto|in totale"
ONE_OF_THESE = rf"\b(?:(?:{ONE}) {OF_THESE}|{OF_THESE} (?:{ONE})) (?:\w+ ){{0,3}}?"
IS_TOTAL = re.compile(rf"\b(?:{IN_ALL})\b|\b{OF_THESE}\b|\binsgesamt \d+\b")
"""Words that show that a number of junctions counts all junctions of the map."""
ALL_KINDS = re.compile(
    rf"(?<!more )(?<!other )(?<!further )\b(\d+) (?:\w+ )?(?:(?:{ANY_KIND})\b|"
    rf"(?:{CROSSING_NOUNS})(?: ,)? (?:(?:{IN_ALL})\b|(?:\d+ )?{OF_THESE}\b))"
)
"""A number before a word for junctions of any kind."""
ARMED = re.compile(r"\b(\d+) (?:- )?(?:arm\w*|leg\w*|branch\w*|brazos|bracci|way)\b")
"""A number of arms."""
OF_JUNCTIONS = re.compile(
    rf"\b\d+ (?:{OF_THESE}|of the|der|des|de las|de los|degli|delle|dei) |"
    rf"\b\d+ (?:\w+ )?(?:{CROSSING_NOUNS})\b"
)
"""A number of junctions."""
OTHERS = re.compile(
    r"\b(?:more|others?|further|another|each|per|weitere[nrs]?|noch|andere[nrs]?|je|autres?|otr[oa]s?|altr[eio])\b"
)
"""Words that show that the number before a noun may count only some of the junctions."""
MAIN_STREET = re.compile(
    r"\b(?:(?:main|through|high) (?:street|road)|(?:haupt|durchgangs)stra(?:ss|ß)e|"
    r"rue principale|grand - rue|calle (?:principal|mayor)|(?:strada|via) principale)\b"
)
TREE = re.compile(rf"\b(?:{DEAD_END}|end dead)\b")
MORE_KINDS = re.compile(
    r"cross|junction|roundabout|kreuz|kreis|einmund|carrefour|croisement|rond|giratoire|cruce|glorieta|rotonda|"
    r"incroc|rotatori|fork|gabel|abzweig|bifurc|bivi|at least|at most|up to|total|in all|each|mindestens|"
    r"hochstens|insgesamt|bis zu|au moins|al menos|almeno|square|loop|ring|platz|place\b|plaza|piazza"
)
NOT_A_TREE = re.compile(rf"\b{DENIAL}\b[^.;]{{0,25}}{DEAD_END}\b")


def with_counted_map(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a map with the numbers of blocks and dead ends that follow from the words.

    For a map of junctions, the number of dead ends is computed from the number of blocks. A main street
    whose side streets are dead ends becomes a map of T-junctions without blocks. If the words count more
    junctions than the map has, junctions of any kind are added. If the words give several numbers, or if the
    Brief has a bound or a range, the number in the Brief stays. A Brief without a map is returned unchanged.
    """
    asked = brief.map
    if asked is None:
        return brief
    said = said_of(text)
    found = DEAD_ENDS.findall(said)
    off_street = _off_main_street(said, found)
    if off_street is not None and (asked.dead_ends is None or asked.dead_ends.exact):
        return brief.model_copy(update={"map": asked.model_copy(update=off_street)})
    update: dict[str, object] = {} if asked.junctions else {**_blocks(asked, said), **_side(asked, text)}
    junctions = _with_others(counted_kinds(asked.junctions, said), said)
    asked = asked.model_copy(update={"junctions": junctions})
    found = found or ROADS_OUT.findall(said) or ["0"] * (NO_ENDS.search(said) is not None)
    bounded = _bounded_ends(said)
    if bounded is not None and len(found) == 1:
        update["dead_ends"] = bounded
    elif asked.dead_ends is None or asked.dead_ends.exact:
        dead_ends = one_number(found) if found else _around_blocks(asked, said)
        is_vague = any(re.fullmatch(ONE, each) for each in found) and not says(ONE_END, said)  # "eine"
        is_tree = asked.blocks == exactly(0) and has_fixed_arms(asked)  # its arms say how many ends it has
        if dead_ends is not None and not is_vague and not is_tree:
            update["dead_ends"] = exactly(dead_ends)
            # the dead ends follow from the blocks in the words, or forbid that there are none
            is_enclosed = asked.blocks == exactly(0) and dead_ends < least_ends(asked)
            update |= {} if found and not is_enclosed else {"blocks": None}
    asked = asked.model_copy(update=update)
    return brief.model_copy(update={"map": _with_possible_ends(asked, said)})


def _with_possible_ends(asked: MapClause, said: str) -> MapClause:
    """Returns the map with junctions of any kind instead of crossroads, where a noun may mean both and the
    crossroads cannot leave the number of dead ends that is asked for: 4 n arms leave an even number.
    """
    ends, kinds = asked.dead_ends, {each.kind for each in asked.junctions}
    is_odd = ends is not None and ends.exact and (ends.lo or 0) % 2 == 1
    if not is_odd or kinds - {"crossroads"} or not kinds or not EITHER.search(said):
        return asked
    junctions = tuple(each.model_copy(update={"kind": "junction"}) for each in asked.junctions)
    return asked.model_copy(update={"junctions": junctions})


def _off_main_street(said: str, dead_ends: Sequence[str]) -> dict[str, object] | None:
    """Returns the junctions and dead ends of a map that is a main street with some dead ends off it.

    Each of them leads off at a T-junction, and the main street itself has two ends. Returns None for any
    other map.
    """
    number = one_number(dead_ends)
    is_more = BLOCKS.search(said) or BY.search(said) or SIDE_STREETS.search(said) or MORE_KINDS.search(said)
    if not number or is_more or not MAIN_STREET.search(said):
        return None
    kinds = (JunctionCount(kind="t_junction", count=exactly(number)),)
    return {
        "junctions": kinds,
        "columns": None,
        "rows": None,
        "blocks": None,
        "dead_ends": exactly(number + 2),
    }


def counted_kinds(junctions: tuple[JunctionCount, ...], said: str) -> tuple[JunctionCount, ...]:
    """Returns the junctions of a map; each kind gets the number before its plural noun, if this is clear."""
    if OTHERS.search(said) or TAKEN_BACK.search(said):
        return junctions
    out, once = [], _without_repeated(junctions, said)
    kinds = [each.kind for each in once]
    for each in once:
        noun, single = KINDS_IN_PLURAL.get(each.kind), KINDS_IN_SINGULAR.get(each.kind)
        number = one_number(noun.findall(said)) if noun else None
        if single and each.count.exact and f"{each.count.lo:g}" in ARMED.findall(said):
            number = number or len(single.findall(said))  # "a three-arm roundabout" is one
        is_clear = number is not None and each.count.exact and kinds.count(each.kind) == 1
        out.append(each.model_copy(update={"count": exactly(number)}) if is_clear and number else each)
    return tuple(out)


def _without_repeated(junctions: Sequence[JunctionCount], said: str) -> list[JunctionCount]:
    """Returns the junctions of a map, only once for a kind that the words name once."""
    out: list[JunctionCount] = []
    for each in junctions:
        noun = KINDS_IN_PLURAL.get(each.kind)
        is_again = any(other.kind == each.kind and other.control == each.control for other in out)
        number = one_number(noun.findall(said)) if noun and is_again else None
        single = KINDS_IN_SINGULAR.get(each.kind, SINGLE_T)
        rest = DEAD_ENDS.sub("", said)
        if not number or single.search(said) or len(re.findall(rf"\b{number}\b", rest)) > 1:
            out.append(each)
    return out


def _with_others(junctions: tuple[JunctionCount, ...], said: str) -> tuple[JunctionCount, ...]:
    """Returns the junctions of a map with those that the words count and no kind accounts for: of "14
    junctions, two of them roundabouts" twelve are of any kind.

    Of "six crossings in all, two of them roundabouts", the network may also count crossroads: if it counts
    more junctions than there are in all, those stay whose kind the words count.
    """
    number = one_number(ALL_KINDS.findall(said))
    if not number or not junctions or TAKEN_BACK.search(said) or not all(j.count.exact for j in junctions):
        return junctions
    kept = junctions
    if number < _number_of(junctions):
        kept = tuple(each for each in junctions if is_counted(each, said))
        unnamed = {each.kind for each in junctions if each not in kept}
        if not kept or not IS_TOTAL.search(said) or unnamed - {"crossroads", "junction"}:
            return junctions
    elif any(each.kind == "junction" for each in junctions):
        return junctions
    others = number - _number_of(kept)
    return (*kept, JunctionCount(kind="junction", count=exactly(others))) if others > 0 else junctions


def _number_of(junctions: Sequence[JunctionCount]) -> int:
    """Returns how many junctions there are in all, if the number of each kind is exact."""
    return int(sum(each.count.lo or 0 for each in junctions))


def is_counted(junctions: JunctionCount, said: str) -> bool:
    """Returns whether the words have this number of junctions before the plural of their kind, or "one of
    them" before its singular.
    """
    noun, count = KINDS_IN_PLURAL.get(junctions.kind), junctions.count
    if noun is None or not count.exact:
        return False
    if count == exactly(1) and (single := KINDS_IN_SINGULAR.get(junctions.kind)) is not None:
        return re.search(ONE_OF_THESE + single.pattern, said) is not None
    return f"{count.lo:g}" in noun.findall(said)


def _blocks(asked: MapClause, said: str) -> dict[str, Amount]:
    """Returns the columns and rows of a grid if the words leave no doubt about them: "two by three", "four
    blocks in a row", "a single block". If they only give the number of blocks, and the plan has another
    number, the grid is as close to a square as this number allows.
    """
    found = BY.findall(said)
    is_exact = all(each is not None and each.exact for each in (asked.columns, asked.rows))
    number = (
        None if ACROSS.search(said) else one_number([each for each in BLOCKS.findall(said) if each != "solo"])
    )
    is_other = is_exact and number != span(asked.columns).lo * span(asked.rows).lo
    if len(found) == 1:
        columns, rows = map(int, found[0])
    elif number and not found and (number == 1 or IN_A_ROW.search(said)):
        columns, rows = number, 1
    elif number and is_other and _is_total(number, said):
        rows = max(n for n in range(1, isqrt(number) + 1) if number % n == 0)
        columns = number // rows
    else:
        return {}
    is_turned = asked.columns == exactly(rows) and asked.rows == exactly(columns)
    return {} if is_turned or not is_exact else {"columns": exactly(columns), "rows": exactly(rows)}


def _is_total(blocks: int, said: str) -> bool:
    """Returns whether words that count blocks have no number of other things but junctions and dead ends, and
    speak of no side of a grid.
    """
    rest = OF_JUNCTIONS.sub("", DEAD_ENDS.sub("", said))
    return re.findall(r"\b\d+\b", rest) == [str(blocks)] and WIDE.search(said) is None


def _side(asked: MapClause, text: SlottedText) -> dict[str, Amount]:
    """Returns the length of a grid's roads, if the plan lacks it and the words give that of a block."""
    found = SIDE_OF_BLOCK.findall(text.text)
    if asked.length is not None or len(found) != 1 or int(found[0]) > len(text.slots):
        return {}
    return {"length": exactly(text.slots[int(found[0]) - 1].value)}


def _bounded_ends(said: str) -> Amount | None:
    """Returns the bound or range that the words give to the number of dead ends; None if there is none."""
    if TAKEN_BACK.search(said):
        return None
    if found := RANGE_OF_ENDS.search(said):
        least, most = (int(number) for number in found.groups() if number)
        return Amount(lo=least, hi=most) if least < most else None
    if found := LEAST_ENDS.search(said):
        return Amount(lo=int(found[1]))
    found = MOST_ENDS.search(said)
    return Amount(hi=int(found[1])) if found else None


def _around_blocks(asked: MapClause, said: str) -> int | None:
    """Returns how many dead ends a map of junctions has, from its number of blocks; None if this is open."""
    found = BLOCKS.findall(said)
    is_tree = not found and SIDE_STREETS.search(said) and TREE.search(said) and not NOT_A_TREE.search(said)
    blocks = 0 if is_tree else one_number(found)
    is_bounded = asked.blocks is not None and not asked.blocks.exact  # "more than one block"
    if blocks is None or is_bounded or not asked.junctions or not has_fixed_arms(asked):
        return None
    enclosing = asked.model_copy(update={"blocks": exactly(blocks), "dead_ends": None})
    dead_ends = enclosing.ends_of_tree(most_ends(asked)).lo
    return int(dead_ends) if dead_ends >= 0 else None


def one_number(found: Sequence[str]) -> int | None:
    """Returns the number that was found, 0 for "no"; None if no number or several numbers were found."""
    if len(found) != 1:
        return None
    return int(found[0]) if found[0].isdecimal() else int(re.fullmatch(ONE, found[0]) is not None)
