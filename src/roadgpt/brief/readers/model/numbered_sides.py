"""Gives the turns of a road the sides that words tell by places: "five bends, the second and the last to the
right, the others left", "no bend to the left but the third". The network loses count of them.
"""

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from roadgpt.brief.model import OTHER_SIDE, Brief, Clause, Side, exactly
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.readers.model.denial import CORRECTED, DENIAL, is_denied
from roadgpt.brief.readers.model.nouns import COUNTED, LEFT, ONE_TURN, RIGHT
from roadgpt.brief.readers.model.ordinals import (
    ALL,
    DETERMINER,
    EXCEPT,
    OF_THEM,
    ONLY,
    ORDINAL,
    OTHERS,
    WHICH,
    places_in,
)
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.turn_list import joined, one_by_one

LEFTS, RIGHTS = LEFT - {"l"} | {"linkskurve"}, RIGHT - {"r"} | {"rechtskurve"}
SIDE = rf"({'|'.join(sorted({*LEFTS, *RIGHTS}, key=len, reverse=True))})\b"
SIDES = re.compile(rf"\b{SIDE}")
NOUN = rf"(?:{'|'.join(sorted({*COUNTED, *ONE_TURN}, key=len, reverse=True))})"
COUNT = re.compile(
    rf"(?<!\w )\b(\d+) (?:\w+ )?(?:{NOUN})\b|\b(?:with|mit|avec|con|of|has|have) (\d+) {NOUN}\b"
)
OF_PART = ("first", "last", "other", "ersten", "letzten", "anderen", "les", "las", "los", "le")
PART = "".join(f"(?<!{word} )" for word in OF_PART)
ANY_COUNT = re.compile(rf"{PART}\b(\d+) (?:\w+ )?{NOUN}\b")
"""A number of turns that are not a part of others."""
TO = (
    r"(?:(?:to|the|go|goes|going|bend|bends|turn|turns|is|are|curve|curves|be|should|must|nach|fuhrt|fuhren|geht|"
    r"gehen|ist|sind|eine|vont|va|van|tourne|tournent|est|sont|a|la|hacia|gira|giran|son|es|e|sono|vanno|piega|"
    r"piegano|verso|al?l?e?|einzige|only|one) )*"
)
FROM = (
    rf"(?:from (?:{DETERMINER} )*{ORDINAL}(?: {NOUN}| one)? on(?:wards?)?|"
    rf"(?:ab|a partir|desde) (?:d ' |de )?(?:{DETERMINER} )*{ORDINAL}(?: {NOUN})?|"
    rf"dalla {ORDINAL}(?: {NOUN})? in poi)"
)
"""All turns from one on: "from the third on"."""
FROM_ON = re.compile(rf"\b({FROM})\b ?,?(?: (?!{DENIAL}\b)\w+){{0,4}}?( {DENIAL}\b(?: \w+){{0,4}}?)? {SIDE}")
EARLIER = re.compile(
    r"\b(?:before (?:that|it|then)|until then|davor|vorher|zuvor|avant|antes|prima di|first|erste[nr]?|"
    r"primer[ao]?s?|premi(?:er|ere)s?|prim[aeio])\b"
)
"""Words for the turns before those."""
SAID = re.compile(rf"\b({WHICH}|{OTHERS})(?: {NOUN}| ones?)? ,? ?{TO}{SIDE}")
"""Turns, and the side to which they lead."""
LISTED = re.compile(
    rf"(?<!\w )\b(\d+) (?:{OF_THEM} |\w+ ){{0,2}}?{TO}{SIDE} ?[:(,-] ?({WHICH})"
    rf"(?!(?: {NOUN}| ones?)? ,? ?{TO}{SIDE})|"
    rf"\b(?:dont|of which|davon|de l[oa]s cuales|di cui) (\d+) (?:\w+ )??{TO}{SIDE} ?[:(,-] ?({WHICH})"
)
"""A number of turns to one side, and their places: "two to the right: the second and the last"."""
NOT_SO = re.compile(
    rf"\b({WHICH}|{OTHERS})(?: {NOUN}| ones?)? ?,? ?(?:(?:does|is|do|va|gira|hingegen|jedoch|invece) )?"
    rf"(?:no|not|nicht|non|pas|doesn ' t|isn ' t|don ' t)(?= [.,;:]|$)"
)
"""Turns that do not lead to the side that was said: "the first goes left, the second does not"."""
FEW = re.compile(
    rf"\b(?:only|just|nur|seulement|solo|soltanto|solamente|of which|davon|dont) (?:{ONLY})?"
    rf"(\d+|one|ein\w*|une?|un[ao]?)(?: {OF_THEM})?(?: (?!{DENIAL}\b)\w+)?? {TO}{SIDE}(?! ?[:(,-] ?{WHICH})"
)
"""A number of turns to one side, without their places: "only one of them to the right"."""
BUT = re.compile(
    rf"\b(?:({DENIAL})|{ALL})\b(?: \w+){{0,6}}? {SIDE} ,? ?{EXCEPT} (?:{DETERMINER} )*({WHICH})|"
    rf"\b{EXCEPT} ({WHICH})(?: ,)? (?:({DENIAL})|{ALL})\b(?: \w+){{0,5}}? {SIDE}"
)
"""A side that no turns have but some, or all but some."""


NOT_THIS = re.compile(
    rf"\b(?:not|nicht|pas|no|non)\b(?: \w+){{0,4}}? {SIDE} ,? ?(?:but|sondern|mais|sino|ma|bensi)\b"
)
"""A side that is denied and replaced by the other."""


class Sided(NamedTuple):
    """The turns to one side."""

    where: str | tuple[int, ...]
    """Their places, in words or counted from 0; empty for all turns that are not named."""
    side: Side


def with_numbered_sides(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a single road whose turns lead to the sides that the words tell by ordinals.

    The Brief is returned unchanged if the words do not give the sides of all turns, or if they are not clear.
    A list of turns that differ in nothing but their sides becomes as long as the words say.
    """
    said = text.text
    is_road = not brief.junctions and brief.map is None and not brief.alternating
    each = one_by_one(brief.clauses)
    here = sum(clause.kind not in STRAIGHT for clause in each)
    is_unclear = len({*ANY_COUNT.findall(said)}) > 1 or CORRECTED.search(said) or NOT_THIS.search(said)
    if not is_road or not here or is_unclear:
        return brief
    each = _as_long(each, told_turns(said) or here) or each
    number = sum(clause.kind not in STRAIGHT for clause in each)
    sides = _sides(said, number)
    if sides is None:
        return _with_few_to_one_side(brief, each, said, number)
    turns = iter(sides)
    each = [one if one.kind in STRAIGHT else one.model_copy(update={"side": next(turns)}) for one in each]
    return brief.model_copy(update={"clauses": joined(each), "left": None, "right": None, "turns": None})


def _with_few_to_one_side(brief: Brief, each: list[Clause], said: str, number: int) -> Brief:
    """Returns the Brief with the number of turns to either side, if the words count those to one side and the
    Brief has another number of them.
    """
    found = [each for each in FEW.finditer(said) if not is_denied(said[: each.start()])]
    sides = {_side(word) for word in SIDES.findall(said)}
    is_clear = len(found) == len(sides) == 1 and told_turns(said) == number
    if not is_clear or re.search(rf"\b{ORDINAL}\b", said):
        return brief
    (side,) = sides
    count = int(found[0][1]) if found[0][1].isdecimal() else 1
    turning = [clause for clause in each if clause.kind not in STRAIGHT]
    has = [clause.side for clause in turning]
    counts = brief.left if side == "left" else brief.right
    if not 0 < count < number or has.count(side) == count or counts == exactly(count):
        return brief
    each = [one if one.kind in STRAIGHT else one.model_copy(update={"side": None}) for one in each]
    update: dict[str, object] = {"clauses": joined(each), "turns": None}
    update |= {side: exactly(count), OTHER_SIDE[side]: exactly(number - count)}
    return brief.model_copy(update=update)


def _as_long(clauses: Sequence[Clause], number: int) -> list[Clause]:
    """Returns the clauses with so many turns; empty if the turns differ, or if straights part them."""
    turning = [n for n, clause in enumerate(clauses) if clause.kind not in STRAIGHT]
    first, last = turning[0], turning[-1]
    inner = [clause.model_copy(update={"side": None}) for clause in clauses[first : last + 1]]
    if any(clause != inner[0] for clause in inner):
        return []
    return [*clauses[:first], *inner[:1] * number, *clauses[last + 1 :]]


def told_turns(said: str) -> int | None:
    """Returns the number of turns in words, as networks read them; None if there is none, or several."""
    found = _counts(said)
    return found.pop() if len(found) == 1 and len({*ANY_COUNT.findall(said)}) <= 1 else None


def _counts(said: str) -> set[int]:
    return {int(first or second) for first, second in COUNT.findall(said)}


def _sides(said: str, number: int) -> list[Side] | None:
    """Returns the side of each turn; None if the words do not give them all."""
    out: dict[int, Side] = {}
    rest: set[Side] = set()
    for each in _told_sides(said, number):
        places = places_in(each.where, number) if isinstance(each.where, str) and each.where else each.where
        if each.where and (not places or any(out.get(n, each.side) != each.side for n in places)):
            return None
        out |= dict.fromkeys(places or (), each.side)
        rest |= set() if each.where else {each.side}
    if not out or len(rest) > 1 or (len(out) < number and not rest):
        return None
    other = next(iter(rest), None)
    sides = [out.get(n, other) for n in range(number)]
    return [side for side in sides if side is not None]


def _told_sides(said: str, number: int) -> Iterator[Sided]:
    """Yields the turns to which words give a side by their places."""
    for match in FROM_ON.finditer(said):
        side = OTHER_SIDE[_side(match[3])] if match[2] else _side(match[3])
        place = places_in(" ".join(re.findall(rf"\b{ORDINAL}\b", match[1])), number)
        if place is not None:
            yield Sided(tuple(range(min(place), number)), side)
            if EARLIER.search(said[: match.start()] + said[match.end() :]):
                yield Sided("", OTHER_SIDE[side])
    said = FROM_ON.sub(" ", said)
    for match in BUT.finditer(said):
        none, word, where = (match[1], match[2], match[3]) if match[3] else (match[5], match[6], match[4])
        its = _side(word)
        yield Sided(where, its if none else OTHER_SIDE[its])
        yield Sided("", OTHER_SIDE[its] if none else its)
    said = BUT.sub(" ", said)
    for match in LISTED.finditer(said):
        several, word, where = filter(None, match.groups())
        if int(several) == len(places_in(where, number) or ()):
            yield Sided(where, _side(word))
            yield Sided("", OTHER_SIDE[_side(word)])
    said = LISTED.sub(" ", said)
    named = {_side(word) for word in SIDES.findall(said)}
    for match in NOT_SO.finditer(said) if len(named) == 1 else ():
        is_rest = re.search(rf"\b{ORDINAL}\b", match[1]) is None
        yield Sided("" if is_rest else match[1], OTHER_SIDE[next(iter(named))])
    for match in SAID.finditer(said):
        before = said[: match.start()]
        if is_denied(before) or re.search(rf"\b{EXCEPT} (?:\w+ )?$", before):
            continue
        is_rest = re.search(rf"\b{ORDINAL}\b", match[1]) is None
        yield Sided("" if is_rest else match[1], _side(match[2]))
        if re.search(rf"\b(?:{ONLY})(?:\w+ )?$", before) or match[0].find(" only ") > 0:
            yield Sided("", OTHER_SIDE[_side(match[2])])


def _side(word: str) -> Side:
    return "left" if word in LEFTS else "right"
