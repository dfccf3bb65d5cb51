"""Gives the junctions of a route the signs and the ways that words tell by places: "four crossroads, left at
the last, lights only at the second", "stop signs at all but the first". The network often gives them to
another one.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import NamedTuple

from roadgpt.brief.junctions import LANE_KINDS, RAMPS, Control, JunctionClause, JunctionKind, Take
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.denial import CORRECTED, TAKEN_BACK, is_denied
from roadgpt.brief.readers.model.junction_nouns import (
    ANY_KIND,
    EITHER,
    KINDS_IN_PLURAL,
    KINDS_IN_SINGULAR,
    PLURAL,
    SIDE_STREETS,
)
from roadgpt.brief.readers.model.ordinals import (
    ALL,
    DETERMINER,
    EXCEPT,
    OF_THEM,
    ONLY,
    OTHERS,
    WHICH,
    places_in,
)
from roadgpt.brief.readers.model.sign_words import ARE, ARTICLE, HAVE, SIGN_WORDS, SINGULARS
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.told_junctions import CROSSINGS
from roadgpt.brief.readers.model.told_takes import TO, WAYS

SIGNS: Mapping[Control, str] = {
    "lights": SIGN_WORDS["lights"],
    "stop": SIGN_WORDS["stop"],
    "yield": rf"(?:{SIGN_WORDS['yield']}|give way|yield|vorfahrt (?:gewahren|achten)|ceder? le passage)",
    "priority": r"(?:priority|right of way|vorfahrt|priorite|prioridad|preferencia|precedenza)",
}
TAKES: Mapping[Take, str] = {take: rf"{TO}(?:{way})" for take, way in WAYS.items()}
FLAGS = ("all_way", "others_stop")
"""Fields of a junction that belong to its sign."""
NO_FLAGS = dict.fromkeys(FLAGS, False)
NOT_GIVEN = re.compile(
    r"\b(?:giv\w*|yield\w*|gewahr\w*|ced\w*|d(?:o|a|are|ai|iamo)|losing|lose|without|no) (?:\w+ )?$"
)
"""Words before "priority" or "precedenza" with which the route has none."""
OF_OTHERS = re.compile(
    r"\b(?:(?:cross )?traffic(?! (?:light|signal))|others?|everybody|everyone|they|side (?:roads?|streets?)|"
    r"querverkehr|"
    r"quer\w*|anderen?|autres?|transversal\w*|lati|demas|otr[oa]s?|altri|altre|laterali)\b[^.,;:]*$"
)
"""Words before a sign that is not for the route."""
NO_WAY = re.compile(
    r"\b(?:on|from|von|auf|de|da|sur|desde|por|su) (?:the |your |my |our |its |la |der |mano )?$|"
    r"\b(?:sulla|dalla|keep|bear|lane|then|and then|sharp|slight\w*|slightly) $"
)
"""Words before a side that is no way at a junction, or not the whole of it: "a side road on the left"."""
AT = r"(?:at|on|an|am|bei|beim|auf|in|im|aux?|al|alla|allo|all '|a|en|sur|dans|nel|nella|of)"
PLACES = rf"({WHICH}|{OTHERS})"
EVERY = rf"(?:{ALL}|each|throughout|both|beide\w*|amb[oa]s|entramb[ie]|chaque|cada|ciascun\w*)"
NOUN = rf"(?:(?:{SINGULARS}|{PLURAL}|{ANY_KIND}|ones?)\b|{OF_THEM})"
LAST = (
    r"(?:[.,;:!?)]|for (?:me|us|you)|only|alone|nur|seulement|solo|solamente|soltanto|and|und|et|y|e|sind|"
    r"ist|steht|stehen)"
)
ENDS = rf"(?= (?:{LAST}|{EXCEPT})(?: |$)|$)"
"""What may follow the places; any other word, as in "the second exit", names something else."""
VERB = r"(?:is|are|ist|sind|est|sont|es|son|sono|e)"
GOING = (
    r"(?:(?:turn|go|head|i|we|you|it|then|carry on|drive|wir|ich|fahre?n?|geht es|biegen|abbiegen|je|on|nous|"
    r"tourne[rz]?|prend|voy|vamos|giro|gira|giriamo|vado|andiamo|si|sigo|seguimos) ){0,3}"
)
RELATIVE = r"(?:which|that|der|die|das|qui|que|che)"
OWN = re.compile(rf" , {RELATIVE} ")
"""What is said of an excepted junction itself: "all but the last, which has a stop sign"."""
BUT = re.compile(rf"\b{EXCEPT} (?:{AT} )*$")
ALL_BUT = re.compile(rf"\b{EVERY}(?: \w+){{0,4}}? ,? ?{EXCEPT} (?:{AT} )*$")
EXCEPTED = re.compile(
    rf"\b{EXCEPT} (?:{AT} )*({WHICH})(?: ({NOUN}))?(?: {OF_THEM})? ?,? (?:where|wo|ou|donde|dove) ([^.;:]*)"
)
"""What is said of a junction that is excepted: "except the second, where the car turns left"."""
ANY_NOUN = re.compile(rf"(?:{ANY_KIND}|junction|intersection|crossing|knoten(?:punkt)?)")
T_JUNCTION = re.compile(r"t - (?:junction|crossing|intersection)s?|einmundung(?:en)?")


class Placed(NamedTuple):
    """A sign or a way, and the junctions at which words place it."""

    value: str
    where: str
    """The places in words, such as "the first and the last", or "the others"."""
    noun: str
    """The noun behind them; empty if there is none."""
    is_exception: bool
    """Whether it holds for all other junctions, as in "lights at all but the last"."""


def with_numbered_junctions(brief: Brief, text: SlottedText) -> Brief:
    """Returns a route with the signs and the ways that the words place by ordinals.

    If every mention of a sign has its places, other junctions do not have this sign. The Brief is returned
    unchanged if a junction would get two signs or ways, if the words have too few junctions, or if they do
    not say of which kind of junctions they count.
    """
    said = text.text
    if not brief.junctions or TAKEN_BACK.search(said) or CORRECTED.search(said):
        return brief
    signs, takes = [*placed_signs(said)], [*placed_takes(said)]
    controls = _by_junction(brief.junctions, signs, said)
    ways = _by_junction(brief.junctions, takes, said)
    if any(brief.junctions[n].kind not in CROSSINGS or brief.junctions[n].ways for n in ways):
        ways = {}
    if any(brief.junctions[n].others_stop and each in ("stop", "yield") for n, each in controls.items()):
        controls = {}  # the sign is that of the other roads
    junctions = _signed(
        brief.junctions, controls, {sign for sign in SIGNS if _is_complete(sign, signs, said)}
    )
    ways |= _other_ways(brief.junctions, takes, ways)
    junctions = tuple(
        each.model_copy(update={"take": ways[n]}) if n in ways and not _goes(each, ways[n]) else each
        for n, each in enumerate(junctions)
    )
    return brief.model_copy(update={"junctions": junctions})


def _other_ways(
    junctions: Sequence[JunctionClause], takes: Sequence[Placed], ways: Mapping[int, str]
) -> dict[int, str]:
    """Returns a way for each junction that is excepted from another one: after "straight over all but the
    last", the route turns there.
    """
    excepted = {each.value for each in takes if each.is_exception} if ways else set()
    if len(excepted) != 1:
        return {}
    (way,) = excepted
    other = "left" if way == "right" else "right"
    return {n: other for n, each in enumerate(junctions) if n not in ways and _goes(each, way)}


def placed_signs(said: str) -> Iterator[Placed]:
    """Yields the signs that words place by ordinals.

    Args:
        said: the words in lower case without accents, as networks read them.
    """
    for control, sign in SIGNS.items():
        for each, before in _found(control, (*_forms(sign), *_forms_of_sign(sign)), said):
            is_given = control == "priority" and NOT_GIVEN.search(before) is not None
            if not is_given and not OF_OTHERS.search(before):
                yield each
        yield from _of_first(control, said)
        yield from _of_excepted(control, sign, said)


def _of_excepted(value: str, words: str, said: str) -> Iterator[Placed]:
    """Yields what is said of an excepted junction: "straight over all but the last, where I turn left"."""
    for where, noun, told in EXCEPTED.findall(said):
        found = re.search(rf"\b{words}\b", told)
        before = told[: found.start()] if found else ""
        if found and not is_denied(before) and not OF_OTHERS.search(before) and not NO_WAY.search(before):
            yield Placed(value, where, noun, is_exception=False)


def _of_first(control: Control, said: str) -> Iterator[Placed]:
    """Yields a sign that the first junctions of a kind have, as many as the words count: "straight over two
    crossroads with lights, left at the third".
    """
    for match in _counted(SIGNS[control]).finditer(said):
        before = said[: match.start()]
        if not is_denied(before) and _kind(match[2]) and not re.search(rf"\b{match[2]}\b", before):
            yield Placed(control, f"the first {match[1]}", match[2], is_exception=False)


@cache
def _counted(sign: str) -> re.Pattern[str]:
    noun = rf"({PLURAL}|{SIDE_STREETS.pattern})"
    on_side = r"(?: (?:on|to) the (?:left|right)| (?:rechts|links)| a (?:droite|gauche))?"
    with_it = rf"(?:{HAVE}|(?:where|at which|wo|an denen|ou|donde|dove) (?:\S+ ){{1,4}}?)"
    return re.compile(rf"\b([2-9]) {noun}{on_side}(?: ,)? {with_it} ?{ARTICLE}{sign}\b(?! {AT} )")


def placed_takes(said: str) -> Iterator[Placed]:
    """Yields the ways that words place by ordinals, such as "left at the second"; see ``placed_signs``."""
    for take, way in TAKES.items():
        for each, before in _found(take, (*_forms(way), *_forms_of_way(way)), said):
            if not NO_WAY.search(before):
                yield each
        yield from _of_excepted(take, way, said)


def _found(value: str, forms: Sequence[re.Pattern[str]], said: str) -> Iterator[tuple[Placed, str]]:
    """Yields what the forms find, each with the text before it."""
    for match in (match for form in forms for match in form.finditer(said)):
        before = said[: match.start()]
        is_own = OWN.search(match[0]) is not None
        is_exception = not is_own and ALL_BUT.search(said[: match.start(1)]) is not None
        if not is_denied(before) and (is_exception or is_own or not BUT.search(before)):
            yield Placed(value, match[1], match[2] or "", is_exception), before


@cache
def _forms(words: str) -> tuple[re.Pattern[str], ...]:
    """Returns the forms in which the places stand behind a sign or a way."""
    noun = rf"(?: ({NOUN}))?(?: {OF_THEM})?{ENDS}"
    all_but = rf"(?:{AT} )*{EVERY}(?: \w+){{0,3}}? ,? ?{EXCEPT} (?:{AT} )*({WHICH})"
    return (
        re.compile(rf"\b{words} (?:{ONLY})?(?:{AT} )+(?:{ONLY})?{PLACES}{noun}"),
        re.compile(rf"\b{words} {all_but}{noun}"),
        re.compile(rf"\b{EVERY}(?: \w+)? {HAVE} {ARTICLE}{words} ,? ?{EXCEPT} (?:{AT} )*({WHICH}){noun}"),
    )


@cache
def _forms_of_sign(sign: str) -> tuple[re.Pattern[str], ...]:
    """Returns the forms in which the places stand before a sign."""
    every = rf"(?:{AT} )*({EVERY})(?: (?:of )?(?:{DETERMINER} )*({NOUN}))?(?: {OF_THEM})?"
    noun, end = rf"(?: ({NOUN}))? ,? ?", rf"\b(?: {AT} {ALL} \w+)?(?! {AT} ){ENDS}"
    have = rf"(?:{HAVE}|{VERB} (?:with|mit|avec|con))"
    return (
        re.compile(rf"\b{sign} {every}{ENDS}(?! ?,? ?{EXCEPT})"),
        re.compile(rf"\b{PLACES}{noun}(?:{RELATIVE} )?{have} {ARTICLE}{sign}{end}"),
        re.compile(rf"\b(?:{AT} )+(?:{ONLY})?{PLACES}{noun}{ARE} {ARTICLE}{sign}{end}"),
    )


@cache
def _forms_of_way(way: str) -> tuple[re.Pattern[str], ...]:
    """Returns the forms in which the places stand before a way."""
    at_all = rf"(?:{AT} )*({EVERY}) (?:of )?(?:{DETERMINER} )*((?:{PLURAL}|{SIDE_STREETS.pattern})\b)"
    return (
        re.compile(rf"\b(?:{AT} )+(?:{ONLY})?{PLACES}(?: ({NOUN}))? ,? ?{GOING}{way}\b(?! {AT} ){ENDS}"),
        re.compile(rf"\b{way} {at_all}{ENDS}(?! ?,? ?{EXCEPT})"),
    )


def _signed(
    junctions: Sequence[JunctionClause], controls: Mapping[int, str], complete: set[Control]
) -> tuple[JunctionClause, ...]:
    """Returns the junctions with their signs; all others lose those signs that have all of their places."""
    if not controls:
        return tuple(junctions)
    moved = complete & {*controls.values()}
    rest = [each for n, each in enumerate(junctions) if n not in controls]
    flags = {
        name: True for name in FLAGS if any(getattr(each, name) for each in rest if each.control in moved)
    }
    out = []
    for n, each in enumerate(junctions):
        if n in controls and each.control != controls[n]:
            each = each.model_copy(update={"control": controls[n], **NO_FLAGS, **flags})
        elif n not in controls and each.control in moved:
            each = each.model_copy(update={"control": None, **NO_FLAGS})
        out.append(each)
    return tuple(out)


def _by_junction(junctions: Sequence[JunctionClause], found: Sequence[Placed], said: str) -> dict[int, str]:
    """Returns the value of each junction that the words name; empty if that is not clear."""
    out: dict[int, str] = {}
    rest = [each for each in found if re.fullmatch(OTHERS, each.where)]
    for each in (each for each in found if each not in rest):
        row = _row(junctions, each.noun, said)
        is_of_all = re.fullmatch(EVERY, each.where) is not None
        named = {*row} if is_of_all else {row[place] for place in places_in(each.where, len(row)) or ()}
        numbers = [n for n in row if (n in named) != each.is_exception] if named else []
        if not numbers or any(out.get(n, each.value) != each.value for n in numbers):
            return {}
        out |= dict.fromkeys(numbers, each.value)
    if len(rest) == 1 and out:
        left = [n for n in _row(junctions, rest[0].noun, said) if n not in out]
        told = re.search(r"\d+", rest[0].where)
        if told and int(told[0]) != len(left):
            return {}
        out |= dict.fromkeys(left, rest[0].value)
    return out


def _row(junctions: Sequence[JunctionClause], noun: str, said: str) -> list[int]:
    """Returns the junctions that words count with this noun; empty if several kinds may be meant."""
    counted = [n for n, each in enumerate(junctions) if each.kind not in (*RAMPS, *LANE_KINDS)]
    kinds = {junctions[n].kind for n in counted}
    is_open = noun in ("", "one", "ones") or re.fullmatch(OF_THEM, noun) is not None
    if len(kinds) == 1 or (not _has_counted_kinds(said) if is_open else ANY_NOUN.fullmatch(noun)):
        return counted
    kind = _kind(noun)
    is_either = kind == "crossroads" and EITHER.search(f"{noun}s {noun}en {noun}es") is not None
    return [] if kind is None or is_either else [n for n in counted if junctions[n].kind == kind]


def _kind(noun: str) -> JunctionKind | None:
    if T_JUNCTION.fullmatch(noun) or SIDE_STREETS.fullmatch(noun):
        return "t_junction"
    kinds = (kind for kind, its in KINDS_IN_SINGULAR.items() if its.fullmatch(noun))
    return next(kinds, None) or next(
        (kind for kind, its in KINDS_IN_PLURAL.items() if its.fullmatch(f"2 {noun}")), None
    )


def _has_counted_kinds(said: str) -> bool:
    """Returns whether words count the junctions of a kind, of which an ordinal may then be one."""
    return any(noun.search(said) for noun in KINDS_IN_PLURAL.values())


def _is_complete(sign: Control, found: Sequence[Placed], said: str) -> bool:
    """Returns whether every mention of a sign has its places."""
    return len(re.findall(rf"\b{SIGNS[sign]}\b", said)) == sum(each.value == sign for each in found)


def _goes(junction: JunctionClause, way: str) -> bool:
    """Returns whether the route leaves a junction to this side, also if it does so sharply or slightly."""
    return (junction.take or "").rpartition("_")[2] == way
