"""Counts the junctions that a description names, to tell a junction told twice from two junctions."""

import re
from collections.abc import Mapping, Sequence
from functools import reduce

from roadgpt.brief.amount import exactly, meets, span
from roadgpt.brief.junction_check import has_fixed_arms, most_ends
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause, JunctionKind, MapJunctionKind
from roadgpt.brief.model import Brief
from roadgpt.brief.readers.model.denial import TAKEN_BACK, WITHOUT
from roadgpt.brief.readers.model.exit_words import EXIT
from roadgpt.brief.readers.model.junction_nouns import (
    ANY_KIND,
    ANY_PLURAL,
    EITHER_NOUNS,
    KINDS_IN_PLURAL,
    KINDS_IN_SINGULAR,
    PLURAL,
)
from roadgpt.brief.readers.model.map_words import ALL_KINDS, DEAD_ENDS, IS_TOTAL, one_number, with_counted_map
from roadgpt.brief.readers.model.ordinals import PLACE, place_of
from roadgpt.brief.readers.model.ramp_lengths import INEXACT
from roadgpt.brief.readers.model.slots import SlottedText

MORE = re.compile(
    r"\b(?:one (?:that|beyond|behind|after)|"
    r"another|again|second|next|twice|same|each|both|more|further|every|third|last|other|"
    r"zweite[nrms]?|nachste[nrms]?|wieder|noch|weitere[nrms]?|beide[nr]?|jede[nrms]?|andere[nrms]?|dritte[nrms]?|"
    r"letzte[nrms]?|autre|encore|deuxieme|seconde?|prochain|suivant|chaque|memes?|troisieme|dernier|"
    r"otr[oa]|segund[oa]|siguiente|cada|mism[oa]|tercer[oa]?|ultim[oa]|altr[oa]|second[oa]|prossim[oa]|ogni|"
    r"stess[oa]|terz[oa]|x)\b|\b\d+ (?:\w+ ){0,2}?(?:cross ?-?road|crossing|inter|rounda|kreis|kreuz|carref|"
    r"crois|gira|rond|rot|glor|cruc|incr|fork|gabel|bif|four|biv|star|junction)"
)
"""Words that may stand for a further junction that has no noun of its own."""
NUMBERED_EXIT = re.compile(
    r"\b(?:second|third|last|next|zweite[nrms]?|nachste[nrms]?|dritte[nrms]?|letzte[nrms]?|deuxieme|seconde|"
    r"prochaine|troisieme|derniere|segunda|siguiente|tercera|ultima|seconda|prossima|terza) "
    rf"{EXIT}\b"
)
"""An exit with its number, which is no further junction."""
EITHER_COUNTED = re.compile(rf"\b(\d+) {EITHER_NOUNS}\b(?! (?:en|a) [ty]\b)")
"""A number before a plural noun that means crossroads or junctions of any kind."""
AGAIN = re.compile(
    r"\b(?:another|again|further|more|noch|wieder|weitere[nrms]?|encore|autres?|otr[oa]s?|mas|altr[oaie]|ancora)\b"
)
"""Words with which a further junction may follow those that are counted."""
CROSSINGS: tuple[JunctionKind, ...] = ("crossroads", "junction", "t_junction", "y_junction")
LETTERED: Mapping[str, JunctionKind] = {"t": "t_junction", "y": "y_junction"}
LETTER = re.compile(
    r"\b(?:cruce|interseccion|incrocio|intersezione|carrefour|intersection|croisement|junction|kreuzung|einmundung)"
    r" (?:en|a|in(?: the)?)(?: forme? de| forma d[ei]| form eines| shape of an?)? ([ty])\b"
)
"""A junction that is named by the shape of a letter: "cruce en Y", "incrocio a T"."""
DRIVE = (
    r"route|drive|trip|journey|ride|fahrt|strecke|tour|trajet|parcours|itineraire|ruta|trayecto|recorrido|"
    r"percorso|tragitto"
)
MORE_BEHIND = r"(?:and|plus|then|followed|und|dann|et|puis|y|luego|e|poi)"
TOTAL = re.compile(
    rf"\b(\d+) (?:\w+ )?(?:{PLURAL}|{ANY_KIND}) "
    r"(?:in all|in total|all told|altogether|overall|insgesamt|en tout|au total|en total|in tutto|"
    r"in totale|in (?:any|whatever) order|in beliebiger reihenfolge|"
    r"dans n ' importe quel ordre|en cualquier orden|in qualsiasi ordine)\b|"
    rf"\binsgesamt (\d+) (?:\w+ )?(?:{PLURAL}|{ANY_KIND})\b|"
    rf"^\W*(?:(?:\w+ ){{0,6}}?(?:{DRIVE}) (?:\S+ ){{0,7}}?)?(\d+) (?:{ANY_KIND})\b"
    rf"(?! (?:, )?{MORE_BEHIND}\b)"
)
"""The number of all junctions of a route: said to be all of them, or that of the route with which a text
begins."""


MENTIONS: Mapping[JunctionKind, re.Pattern[str]] = {
    "t_junction": re.compile(
        r"\bts?\b|\btees?\b|side (?:road|street)|branch|einmund|abzweig|seiten|neben|lateral|secund|"
        r"secondair|turn"
    ),
    "y_junction": re.compile(r"\bys?\b|fork|split|gabel|fourche|bifurc|bivi|horquilla"),
    "crossroads": re.compile(r"cross|kreuz|carrefour|croisement|cruce|incroc|quadriv"),
    "roundabout": re.compile(r"round|rotary|circle|kreis|giratoire|rond|glorieta|rotond|rotator|circol"),
    "star": re.compile(r"star|stern|etoile|estrella|stell"),
}
"""Parts of words for each kind of junction."""
ANY_MENTION = re.compile(
    r"junction|inters|node|knoten|jonction|noeud|nudo|nodo|crossing|kreuzung|cruce|croisement|incroc"
)
"""Parts of words for junctions of any kind."""
LISTED = re.compile(
    rf"^\W*(?:\w+ )?(\d+) (?:{PLURAL}|{ANY_KIND}) (?:in all |in total )?:|"
    rf"\b(\d+) (?:{PLURAL}|{ANY_KIND})(?: (?![.;])\S+){{0,8}} :"
)
"""The number of junctions before the list of all of them."""


IS_BOUND = re.compile(rf"\b(?:{INEXACT})\b")


def number_of_listed(text: SlottedText) -> int | None:
    """Returns how many junctions a description says that it lists ("five junctions: left at a T, ...")."""
    found = LISTED.search(text.text)
    if found is None or any(each.search(text.text[: found.start(0)]) for each in MENTIONS.values()):
        return None
    return int(found[1] or found[2])


def most_of_kinds(text: SlottedText) -> dict[JunctionKind, int]:
    """Returns for each kind the largest number of junctions that the words can mean, as far as they say it.

    A kind is counted if its noun is in the text, in the singular or behind a number, and no word speaks of
    further junctions. If some word may do so, only a kind that is named once, behind its number, is counted.
    """
    counted = {kind: noun.findall(text.text) for kind, noun in KINDS_IN_PLURAL.items()}
    said = reduce(lambda rest, noun: noun.sub("", rest), KINDS_IN_PLURAL.values(), text.text)
    said = re.sub(rf"\b{WITHOUT} (?:\w+ )?(?:{PLURAL})\b", "", said)
    if ANY_PLURAL.search(_without_crossroads(said)):
        return {}
    if MORE.search(NUMBERED_EXIT.sub("", said)):
        return {} if AGAIN.search(said) else _named_once(counted, said)
    found = {kind: len(noun.findall(said)) for kind, noun in KINDS_IN_SINGULAR.items()}
    for kind, numbers in counted.items():
        if all(map(str.isdecimal, numbers)):
            found[kind] = found.get(kind, 0) + sum(map(int, numbers))
    return {kind: number for kind, number in found.items() if number}


def _named_once(counted: Mapping[MapJunctionKind, Sequence[str]], rest: str) -> dict[JunctionKind, int]:
    """Returns the numbers of those kinds that the words name only once.

    Args:
        counted: the numbers before the plural noun of each kind.
        rest: the text without these nouns.
    """
    once = {kind: found[0] for kind, found in counted.items() if len(found) == 1 and found[0].isdecimal()}
    return {kind: int(number) for kind, number in once.items() if not MENTIONS[kind].search(rest)}


def _without_crossroads(said: str) -> str:
    """Returns the words without "crossroads", which is singular and plural."""
    return re.sub(r"\bcross ?-? ?roads\b", "", said)


def has_told_kinds(brief: Brief, most: Mapping[JunctionKind, int]) -> bool:
    """Returns whether a route has no more junctions of a kind than the words can mean."""
    kinds = [junction.kind for junction in brief.junctions]
    return all(kinds.count(kind) <= number for kind, number in most.items())


def has_all_told(brief: Brief, text: SlottedText) -> bool:
    """Returns whether a route has as many junctions of each kind as the words count, where they name the kind
    only once.
    """
    kinds = [junction.kind for junction in brief.junctions]
    return not kinds or all(kinds.count(kind) == number for kind, number in _told_once(text).items())


def _told_once(text: SlottedText) -> dict[JunctionKind, int]:
    """Returns the numbers of junctions of those kinds that the words name once, behind a number, unless an
    ordinal goes beyond this number.
    """
    farthest = max((place_of(word) or 0 for word in re.findall(rf"\b{PLACE}\b", text.text)), default=0)
    counted = {kind: noun.findall(text.text) for kind, noun in KINDS_IN_PLURAL.items()}
    counted["crossroads"] += EITHER_COUNTED.findall(text.text)
    said = reduce(
        lambda rest, noun: noun.sub("", rest), (*KINDS_IN_PLURAL.values(), EITHER_COUNTED), text.text
    )
    if AGAIN.search(said) or TAKEN_BACK.search(said):
        return {}
    return {kind: number for kind, number in _named_once(counted, said).items() if number >= farthest}


def names_kinds(brief: Brief, text: SlottedText) -> bool:
    """Returns whether the words mention every kind of junction of a map, or junctions of any kind."""
    if brief.map is None or ANY_MENTION.search(text.text):
        return True
    return all(MENTIONS[each.kind].search(text.text) for each in brief.map.junctions if each.kind in MENTIONS)


def has_told_ends(brief: Brief, text: SlottedText) -> bool:
    """Returns whether a map has as many dead ends as the words count."""
    number, asked = _told_ends(text), with_counted_map(brief, text).map
    if asked is None or not number:
        return True
    if asked.dead_ends is None and asked.blocks == exactly(0) and has_fixed_arms(asked):
        return asked.ends_of_tree(most_ends(asked)).lo == number
    return asked.dead_ends is None or meets(exactly(number), span(asked.dead_ends))


def lacks_ends_as_junctions(brief: Brief, text: SlottedText) -> bool:
    """Returns whether a map lacks any kind that the words do not mention, with as many junctions as the words
    count dead ends.
    """
    number = _told_ends(text) or 0
    number = 0 if len(re.findall(rf"\b{number}\b", text.text)) > 1 else number
    kinds = [] if brief.map is None else [each for each in brief.map.junctions if each.kind in MENTIONS]
    return number < 2 or not any(
        each.count == exactly(number) and not MENTIONS[each.kind].search(text.text) for each in kinds
    )


def _told_ends(text: SlottedText) -> int | None:
    """Returns the number of dead ends that the words give once; None if they give none, or take it back."""
    return None if TAKEN_BACK.search(text.text) else one_number(DEAD_ENDS.findall(text.text))


def with_told_letter(brief: Brief, text: SlottedText) -> Brief:
    """Returns a route whose only junction has the shape of the letter that the words give it.

    The network reads "cruce" as crossroads, also in "cruce en Y".
    """
    found = set(LETTER.findall(text.text))
    if len(brief.junctions) != 1 or brief.junctions[0].kind not in CROSSINGS:
        return brief
    if len(found) != 1 or TAKEN_BACK.search(text.text):
        return brief
    kind = LETTERED[found.pop()]
    junction = brief.junctions[0].model_copy(update={"kind": kind, "arms": None})
    return brief.model_copy(update={"junctions": (junction,)})


def with_told_total(brief: Brief, text: SlottedText) -> Brief:
    """Returns a route with as many junctions as its total says, if only some of no kind differ.

    "Four junctions in all; the first is a roundabout and the last a T-junction" has two between them, and
    "four junctions in any order, two with lights" has two more.
    """
    found = None if TAKEN_BACK.search(text.text) else TOTAL.search(text.text)
    number = int(next(filter(None, found.groups()))) if found else 0
    counted = [n for n, each in enumerate(brief.junctions) if each.kind not in (*RAMPS, *LANE_KINDS)]
    surplus = len(counted) - number
    bare = [n for n in counted if _is_bare(brief, n)]
    of_any_kind = [n for n in bare if brief.junctions[n].kind == "junction"]
    bare = of_any_kind or _too_many(brief, bare, text) or (bare if len(bare) == surplus else [])
    if one_number(ALL_KINDS.findall(text.text)) == len(brief.junctions) and IS_TOTAL.search(text.text):
        surely_too_many = [] if IS_BOUND.search(text.text) else _too_many(brief, counted, text)
        return _as_any_kind(brief, surely_too_many)
    if number and 0 < -surplus < number and len(counted) == len(brief.junctions):
        more = (JunctionClause(kind="junction"),) * -surplus
        roads = (*brief.stretches, *(Brief() for _ in more))
        return brief.model_copy(update={"junctions": (*brief.junctions, *more), "stretches": roads})
    if not number or not 0 < surplus <= len(bare):
        return brief
    gone = {*bare[:surplus]}
    junctions = tuple(each for n, each in enumerate(brief.junctions) if n not in gone)
    roads = tuple(each for n, each in enumerate(brief.stretches) if n - 1 not in gone)
    return brief.model_copy(update={"junctions": junctions, "stretches": roads})


def _as_any_kind(brief: Brief, numbers: Sequence[int]) -> Brief:
    """Returns a route on which some junctions without further wishes may be of any kind."""
    junctions = tuple(
        JunctionClause(kind="junction") if n in numbers and _is_bare(brief, n) else each
        for n, each in enumerate(brief.junctions)
    )
    return brief.model_copy(update={"junctions": junctions})


def _is_bare(brief: Brief, number: int) -> bool:
    """Returns whether nothing is asked of a junction but its kind, and nothing of the road behind it."""
    junction = brief.junctions[number]
    return junction == JunctionClause(kind=junction.kind) and brief.stretches[number + 1].is_open


def _too_many(brief: Brief, bare: Sequence[int], text: SlottedText) -> list[int]:
    """Returns the junctions without further wishes of a kind of which the words count fewer."""
    out = []
    for kind, noun in KINDS_IN_PLURAL.items():
        said = noun.findall(text.text)
        number = int(said[0]) if len(said) == 1 else 0
        its = [n for n in bare if brief.junctions[n].kind == kind]
        surplus = sum(each.kind == kind for each in brief.junctions) - number
        if number > 0 and 0 < surplus <= len(its):
            out += its[-surplus:]
    return out
