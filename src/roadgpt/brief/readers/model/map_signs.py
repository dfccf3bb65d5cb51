"""Gives the junctions of a map signs and lights of their own, where the words count such junctions.

The neural network writes one sign for all junctions of a map. For "six junctions, two with lights", the
number before "with lights" says that only two of them have lights.
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from roadgpt.brief.amount import Amount, exactly
from roadgpt.brief.junctions import Control, JunctionCount, MapClause, MapJunctionKind
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.denial import TAKEN_BACK
from roadgpt.brief.readers.model.junction_nouns import ANY_KIND, KINDS_IN_PLURAL, KINDS_IN_SINGULAR
from roadgpt.brief.readers.model.map_words import ALL_KINDS, counted_kinds, is_counted, one_number
from roadgpt.brief.readers.model.ordinals import ALL
from roadgpt.brief.readers.model.route_words import said_of
from roadgpt.brief.readers.model.sign_words import (
    EVERYWHERE,
    OF,
    PLURALS,
    SIGN_WORDS,
    SINGULARS,
    CountedSigns,
    SignsInWords,
    limits_signs,
    signs_in_words,
)
from roadgpt.brief.readers.model.slots import SlottedText

CROSSING = re.compile(r"cross|inters|kreuz|croisement|carrefour|cruce|incroc")
"""Nouns of junctions that may mean crossroads, or junctions of any kind."""
SIDE_ROAD = re.compile(r"t - junction|einmundung")
CENTRE = r"(?:middle|cent(?:re|er|ral)|mitte|mittlere[nrms]?|milieu|centrale?|centro|mezzo)"
"""Words for the one crossroads in the middle of a grid."""
INNER = r"(?:inner|interior(?:es)?|innere[nrms]?|interieure?s?|intern[oi]|interne)"
"""Words for the crossroads within a grid, which has (columns - 1) (rows - 1) of them."""
OF_ANY_KIND: tuple[MapJunctionKind, ...] = ("crossroads", "junction")


def with_counted_signs(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a map with signs and lights at as many of its junctions as the words say.

    The Brief is returned unchanged if it has no map, if its junctions already have the signs that the words
    count, or if the words do not say which junctions have which sign.
    """
    asked = brief.map
    if asked is None:
        return brief
    said = said_of(text)
    if (inside := _inside_grid(asked, said)) is not None:
        return brief.model_copy(update={"map": asked.model_copy(update=inside)})
    signs = signs_in_words(said)
    if asked.signed and {each.control for each in signs.counted} <= {each.control for each in asked.signed}:
        return brief
    if any(each.control for each in asked.junctions):
        if signs.counted and all(_is_placed(each, asked) for each in signs.counted):
            return brief
        asked = _without_signs(asked)
        asked = asked.model_copy(update={"junctions": counted_kinds(asked.junctions, said)})
        named = [*(each.nouns for each in signs.counted), *(noun for _, noun in signs.of_kinds)]
        is_of_kinds = bool(named) and all(_kinds_of(noun) for noun in named)
        if not is_of_kinds and (len(asked.junctions) > 1 or len(signs.counted) != 1):
            return brief
    if not signs.counted and signs.all_but is None and not signs.of_kinds:
        return brief
    found = _in_village(asked, said, signs) if asked.junctions else _in_grid(asked, said, signs)
    return brief if found is None else brief.model_copy(update={"map": asked.model_copy(update=found)})


def has_unlimited_signs(brief: Brief, text: SlottedText) -> bool:
    """Returns whether words limit a sign to some junctions, but no junctions have signs of their own."""
    asked = brief.map
    if asked is None:
        return False
    placed = {each.control for each in (*asked.junctions, *asked.signed)} - {None}
    return not placed and limits_signs(said_of(text))


def _others(asked: MapClause, said: str, signs: SignsInWords) -> Control | None:
    """Returns the sign of the junctions that are not counted; None if they have none.

    That of the map holds for them only if the words name it.
    """
    sign = None if asked.control is None else SIGN_WORDS.get(asked.control)
    counted = {*(each.control for each in signs.counted), *(control for control, _ in signs.of_kinds)}
    is_unsaid = sign is not None and re.search(rf"\b{sign}\b", said) is None
    return signs.others or (None if asked.control in counted or is_unsaid else asked.control)


def _in_grid(asked: MapClause, said: str, signs: SignsInWords) -> dict[str, object] | None:
    """Returns the signs of a grid; None if they are not clear."""
    kinds = [  # the crossings of a grid may be of any kind
        _of("t_junction" if SIDE_ROAD.search(each.nouns) else "junction", each.amount, each.control)
        for each in signs.counted
    ]
    if signs.all_but is None:
        return {"signed": tuple(kinds), "control": _others(asked, said, signs)}
    left = signs.all_but.number - sum(each.number for each in signs.counted)
    if left < 0:
        return None
    if left:
        kinds.append(_of("junction", exactly(left), signs.others or "none"))
    return {"signed": tuple(kinds), "control": signs.all_but.control}


def _inside_grid(asked: MapClause, said: str) -> dict[str, object] | None:
    """Returns the signs of a grid, if the words limit one to the crossroads within it."""
    if asked.junctions or not (asked.columns and asked.rows and asked.columns.exact and asked.rows.exact):
        return None
    number = int((asked.columns.lo or 0) - 1) * int((asked.rows.lo or 0) - 1)
    where = INNER if number > 1 else rf"(?<!town )(?<!city )(?<!village )(?:{INNER}|{CENTRE})"
    nouns = rf"(?:{SINGULARS}|{PLURALS}|ones?)\b"
    named = [
        control
        for control, sign in SIGN_WORDS.items()
        if re.search(rf"\b{sign} [^.;:]{{0,32}}\b{where}\b|\b{where} {nouns}[^.;:]{{0,15}} {sign}\b", said)
    ]
    everywhere = EVERYWHERE.search(re.sub(rf"\b{ALL} (?:\w+ ){{0,3}}?(?={INNER})", "", said))
    if number < 1 or len(named) != 1 or TAKEN_BACK.search(said) or everywhere:
        return None
    within = _of("crossroads", exactly(number), named[0])
    return {"signed": (within,), "control": signs_in_words(said).others}


def _in_village(asked: MapClause, said: str, signs: SignsInWords) -> dict[str, object] | None:
    """Returns the junctions of a map, those with signs apart; None if the words do not say which they are."""
    if not all(each.count.exact for each in asked.junctions):
        return None
    counts = Counter[MapJunctionKind]()
    for each in asked.junctions:
        counts[each.kind] += int(each.count.lo or 0)
    total = one_number(ALL_KINDS.findall(said)) or counts.total()
    counted, others = (*signs.counted, *_all_of_kinds(signs, counts)), _others(asked, said, signs)
    if len(counted) > 1:  # "six junctions with stop signs, but one of them has lights"
        others = next((each.control for each in counted if each.number == total), others)
        counted = tuple(each for each in counted if each.number < total)
    if signs.all_but is not None:
        sign = signs.all_but
        counted = (*counted, CountedSigns(sign.control, total - sign.number, sign.amount, ""))
        others = signs.others
    if any(_names_another_kind(each, counts) for each in counted):
        return None
    numbers = [each.number for each in counted]
    if not numbers or min(numbers) < 1 or sum(numbers) > total or (len(counted) == 1 and numbers[0] == total):
        return None
    kinds = (
        _split(counts, said, counted[0], total) if len(counted) == 1 else _all_split(counts, counted, total)
    )
    if kinds is None:
        return None
    if all(each.control for each in kinds):
        return {
            "junctions": (*kinds[:-1], _of(kinds[-1].kind, kinds[-1].count)),
            "control": kinds[-1].control,
        }
    return {"junctions": kinds, "control": others}


def _is_placed(signs: CountedSigns, asked: MapClause) -> bool:
    """Returns whether a map has these signs at as many junctions, of a kind that the words name, if any."""
    kinds = _kinds_of(signs.nouns)
    return any(
        each.control == signs.control and each.count == signs.amount and (not kinds or each.kind in kinds)
        for each in asked.junctions
    )


def _without_signs(asked: MapClause) -> MapClause:
    """Returns the map with junctions without signs, those of a kind together."""
    counts = dict[MapJunctionKind, Amount]()
    for each in asked.junctions:
        more = counts.get(each.kind, exactly(0))
        is_exact = more.exact and each.count.exact
        counts[each.kind] = exactly((more.lo or 0) + (each.count.lo or 0)) if is_exact else each.count
    kinds = tuple(_of(kind, count) for kind, count in counts.items())
    return asked.model_copy(update={"junctions": kinds, "control": None})


def _all_of_kinds(signs: SignsInWords, counts: Mapping[MapJunctionKind, int]) -> Iterator[CountedSigns]:
    """Yields the signs that stand at all junctions of a kind."""
    for control, noun in signs.of_kinds:
        kinds = [kind for kind in _kinds_of(noun) if kind in counts]
        if len(kinds) == 1:
            number = counts[kinds[0]]
            yield CountedSigns(control, number, exactly(number), f" {noun}")


def _kinds_of(nouns: str) -> list[MapJunctionKind]:
    """Returns the kinds that some nouns name, such as " of the forks"."""
    nouns = re.sub(rf"^(?: {OF}\b)+", "", nouns)
    found = [kind for kind, noun in KINDS_IN_PLURAL.items() if noun.search(f"2 {nouns.strip()}")]
    found += [kind for kind, noun in KINDS_IN_SINGULAR.items() if noun.search(nouns)]
    return list(dict.fromkeys(found)) or (["t_junction"] if SIDE_ROAD.search(nouns) else [])


def _names_another_kind(signs: CountedSigns, counts: Mapping[MapJunctionKind, int]) -> bool:
    """Returns whether the words for the junctions with a sign name a kind that the map lacks."""
    named = {kind for kind, noun in KINDS_IN_PLURAL.items() if noun.search(f"{signs.number}{signs.nouns}")}
    named |= {kind for kind, noun in KINDS_IN_SINGULAR.items() if noun.search(signs.nouns)}
    may_be_any = CROSSING.search(signs.nouns) is not None and bool({*OF_ANY_KIND} & {*counts})
    return bool(named) and not named & {*counts} and "junction" not in counts and not may_be_any


def _all_split(
    counts: Mapping[MapJunctionKind, int], counted: Sequence[CountedSigns], total: int
) -> tuple[JunctionCount, ...] | None:
    """Returns the junctions with several signs, each apart; None if the words do not name their kinds."""
    rest = {next(iter(counts)): total} if len(counts) == 1 else dict(counts)
    out = []
    for each in counted:
        kind = next(iter(rest)) if len(rest) == 1 else _kind(each, rest)
        if kind is None or rest[kind] < each.number:
            return None
        rest[kind] -= each.number
        out.append(_of(kind, exactly(each.number), each.control))
    return (*out, *(_of(kind, exactly(number)) for kind, number in rest.items() if number))


def _split(
    counts: Counter[MapJunctionKind], said: str, signs: CountedSigns, total: int
) -> tuple[JunctionCount, ...] | None:
    """Returns the junctions with one sign apart; None if the words do not say which they are."""
    kind = _kind(signs, counts)
    if kind is not None:
        return _apart(counts, {kind: signs.number}, signs.control)
    if len(counts) == 1:
        only = next(iter(counts))
        return _apart({only: total}, {only: signs.number}, signs.control)
    named = [each for one, number in counts.items() if is_counted(each := _of(one, exactly(number)), said)]
    rest = total - signs.number - int(sum(each.count.lo or 0 for each in named))
    is_any = re.search(rf"\b{ANY_KIND}\b", signs.nouns) is not None
    if (rest < 0 or is_any) and total == counts.total():
        return _apart(counts, _first(counts, signs.number), signs.control)
    if rest < 0 or {*counts} - {each.kind for each in named} - {*OF_ANY_KIND}:
        return None
    others = [_of("junction", exactly(rest))] if rest else []
    return (_of("junction", exactly(signs.number), signs.control), *named, *others)


def _first(counts: Mapping[MapJunctionKind, int], number: int) -> dict[MapJunctionKind, int]:
    """Returns the first ``number`` of some junctions, in the order of their kinds."""
    out: dict[MapJunctionKind, int] = {}
    for kind, here in counts.items():
        taken = min(here, number - sum(out.values()))
        out |= {kind: taken} if taken else {}
    return out


def _kind(signs: CountedSigns, counts: Mapping[MapJunctionKind, int]) -> MapJunctionKind | None:
    """Returns the kind of the junctions with a sign, if the words behind their number name it."""
    number = signs.number
    kinds = _kinds_of(signs.nouns)
    if (not kinds or counts.get(kinds[0], 0) < number) and CROSSING.search(signs.nouns):
        kinds = [kind for kind in OF_ANY_KIND if counts.get(kind, 0) >= number]
    return kinds[0] if kinds and counts.get(kinds[0], 0) >= number else None


def _apart(
    counts: Mapping[MapJunctionKind, int], taken: Mapping[MapJunctionKind, int], control: Control
) -> tuple[JunctionCount, ...] | None:
    """Returns the junctions with some of each kind apart; None if none would be left."""
    rest = {kind: number - taken.get(kind, 0) for kind, number in counts.items()}
    if not any(rest.values()):
        return None
    apart = [_of(kind, exactly(number), control) for kind, number in taken.items()]
    return (*apart, *(_of(kind, exactly(number)) for kind, number in rest.items() if number))


def _of(kind: MapJunctionKind, count: Amount, control: Control | None = None) -> JunctionCount:
    return JunctionCount(kind=kind, count=count, control=control)
