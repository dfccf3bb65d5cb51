"""Corrects plans whose words speak of all turns: how many alternate, what none may be, what all but one are.

A small network writes each turn of a list and loses count ("seven bends, alternating"), gives a limit for all
turns to some of them ("no bend under 60 degrees"), or leaves open what follows ("all but the last turn to the
right": the last turns to the left).
"""

import re
from collections.abc import Sequence
from itertools import pairwise

from roadgpt.brief.model import OTHER_SIDE, Amount, Brief, Clause, exactly, span
from roadgpt.brief.normal import STRAIGHT, total
from roadgpt.brief.readers.model.bounds import SENTENCE_STOPS, STOPS
from roadgpt.brief.readers.model.count_correction import measured_values
from roadgpt.brief.readers.model.nouns import COUNTED, LEFT, ONE_TURN, RIGHT
from roadgpt.brief.readers.model.slots import SlottedText, slot_name
from roadgpt.brief.readers.model.word_set import word_set
from roadgpt.brief.words import KINDS

FEWEST = 3
"""The smallest number of turns in a list that is made as long as the words say."""
NONE = word_set(
    "none kein keine keiner keines keinen aucun aucune ningun ninguno ninguna nessun nessuno nessuna"
)
DIFFERENT = re.compile(
    r"\b(?:differ\w*|var(?:y|ies|ying|ied)|unlike|not (?:alike|evenly|equally)|no two"
    r"|verschieden\w*|unterschiedlich\w*|variier\w*|nicht gleich\w*"
    r"|varie(?:nt|s|e)?|varian?|variar|distint\w*|divers[eio]|divers)\b"
)
"""Words for parts that are not alike, in a text without accents."""
EXCEPT = word_set(
    "but save except excepting excluding bar ausser außer auf sauf excepte hormis salvo menos excepto tranne",
    "eccetto meno",
)
"""Words for an exception; "auf" is that of "bis auf"."""
ALL = word_set(
    "all every each alle samtliche jede jeder tous toutes todos todas toda tutti tutte ogni cada chaque"
)
"""Words for all turns; "tout" is left out, since "tout sauf" says that something is denied."""
EVERYONE = word_set("all alle samtliche tous toutes todos todas tutti tutte")
"""Words for all turns together, in the plural."""
ONE_OF_ALL = word_set(
    "first second third fourth fifth last final middle one erste ersten zweite zweiten dritte dritten",
    "vierte vierten letzte letzten mittlere mittleren eine einer einen premier premiere deuxieme troisieme",
    "dernier derniere un une primera primero segunda tercera ultima ultimo una prima primo seconda terza",
)
OF_SEVERAL = ("slalom", "serpentine", "zigzag")
STRAIGHTS = re.compile(r"\b(?:straights?|geraden?|lignes? droites?|rectas?|rettiline[oi]|rettifil[oi])\b")
AFTER_A_STRAIGHT = re.compile(
    rf"\b(?:after|following|nach|apres|despues de|tras) (?:an?|one|einer|une|un|una) "
    rf"(?:\S+ ){{0,3}}?{STRAIGHTS.pattern}"
)
"""A straight that comes before what is named first."""
NAMED = frozenset(
    ["chicane", "schikane", "chicana", "hairpin", "slalom", "haarnadel", "epingle", "horquilla", "tornante"]
)
"""Nouns for turns of a kind."""
NEAR = 6
"""The largest number of words from "all" to "but" of "all bends to the left but the last"."""


def with_words_of_all_turns(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief of a single road, corrected where the words speak of all turns; else unchanged."""
    if brief.junctions or brief.map is not None:
        return brief
    brief = _with_limit_of_all(_with_whole_alternation(brief, text), text)
    brief = _with_limit_of_others(brief, text)
    brief = _with_straight_before(_with_number_of_kind(_with_measure_of_all(brief, text), text), text)
    return _with_unlike_parts(_with_other_exception(brief, text), text)


def _with_number_of_kind(brief: Brief, text: SlottedText) -> Brief:
    """Gives a slalom, a serpentine or a zig-zag as many turns as the words say, if it is all of the road."""
    clause = brief.clauses[0] if len(brief.clauses) == 1 else None
    counts = _counts(text) - measured_values(brief)
    if clause is None or clause.kind not in OF_SEVERAL or clause.count != exactly(1) or len(counts) != 1:
        return brief
    number = counts.pop()
    has_noun = any(
        word.text == f"{number:g}" and after.text in COUNTED for word, after in pairwise(text.words)
    )
    if not has_noun or brief.turns is not None:
        return brief
    return brief.model_copy(update={"clauses": (clause.model_copy(update={"count": exactly(number)}),)})


def _with_straight_before(brief: Brief, text: SlottedText) -> Brief:
    """Moves the only straight before the turns where the words say so at their end: "a chicane after a
    straight of 60 m".
    """
    found = [*AFTER_A_STRAIGHT.finditer(text.text)]
    *turns, last = brief.clauses or (None,)
    before = text.text[: found[0].start()] if found else ""
    is_behind = last is not None and last.kind == "straight" and last.count == exactly(1) and bool(turns)
    if not is_behind or len(found) != 1 or len(STRAIGHTS.findall(text.text)) != 1:
        return brief
    if before.rstrip().endswith((".", ";", ":", ">")):  # it may be "afterwards"
        return brief
    if any(turn is None or turn.kind in STRAIGHT for turn in turns):
        return brief
    if not any(word in COUNTED | ONE_TURN or word in NAMED for word in before.split()):
        return brief
    return brief.model_copy(update={"clauses": (last, *turns)})


def _with_unlike_parts(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief without like parts if the words say that something about them differs.

    Which part differs is not known, so the wish is named among the things beside the road.
    """
    if not brief.alike or not ("compared" in brief.beside or DIFFERENT.search(text.text)):
        return brief
    beside = tuple(dict.fromkeys((*brief.beside, "compared")))
    return brief.model_copy(update={"alike": False, "beside": beside})


def _with_whole_alternation(brief: Brief, text: SlottedText) -> Brief:
    """Makes a list of turns that only alternate as long as the words say.

    The words must have one count that is no measure, and must not list the sides themselves. A list of about
    twice as many turns is left alone: the words may count pairs.
    """
    turns = brief.clauses
    if len(turns) < FEWEST or not _only_alternates(turns) or brief.left or brief.right:
        return brief
    counts = _counts(text) - measured_values(brief)
    sides = sum(word.text in LEFT | RIGHT for word in text.words)
    if len(counts) != 1 or sides >= len(turns):
        return brief
    number = int(*counts)
    if number < FEWEST or abs(len(turns) - 2 * number) <= 1:
        return brief
    row = tuple(turns[place % 2] for place in range(number))
    return brief.model_copy(update={"clauses": row, "turns": None})


def _only_alternates(turns: Sequence[Clause]) -> bool:
    """True if all clauses are single turns that differ in their sides alone, which alternate."""
    alike = {turn.model_copy(update={"side": None}) for turn in turns}
    is_plain = len(alike) == 1 and turns[0].kind == "turn" and turns[0].count == exactly(1)
    return is_plain and all(one.side and OTHER_SIDE[one.side] == other.side for one, other in pairwise(turns))


def _counts(text: SlottedText) -> set[float]:
    """Returns the counts above 1 in the text, without numbers in front of a colon, which number a list."""
    words = [*text.words, *text.words[-1:]]
    return {
        float(word.text)
        for word, after in pairwise(words)
        if word.text.isdecimal() and word.written and after.text != ":" and int(word.text) > 1
    }


def _with_limit_of_all(brief: Brief, text: SlottedText) -> Brief:
    """Gives every turn the limit of an angle or a radius that "no turn" may exceed."""
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    for name in ("radius", "degrees"):
        limits = {getattr(clause, name) for clause in turning}
        said = limits - {None}
        if len(limits) < 2 or len(said) != 1 or getattr(brief, name) is not None:
            continue
        (limit,) = said
        bounds = [bound for bound in (limit.lo, limit.hi) if bound is not None]
        if len(bounds) == 1 and _is_ruled_out(bounds[0], text):
            clauses = tuple(_without(clause, name) for clause in brief.clauses)
            return brief.model_copy(update={"clauses": clauses, name: limit})
    return brief


def _with_limit_of_others(brief: Brief, text: SlottedText) -> Brief:
    """Gives the limit of all angles only to turns that can keep it, if the words make an exception: "but for
    the last, a hairpin, no turn exceeds 40 degrees".
    """
    words = {word.text for word in text.words}
    limit, most = brief.degrees, span(brief.degrees).hi
    is_excepted = [least_of(clause) > most for clause in brief.clauses]
    if limit is None or words.isdisjoint(EXCEPT) or not any(is_excepted) or all(is_excepted):
        return brief
    clauses = tuple(
        each if each.kind in STRAIGHT or each.degrees or above else each.model_copy(update={"degrees": limit})
        for each, above in zip(brief.clauses, is_excepted, strict=True)
    )
    return brief.model_copy(update={"clauses": clauses, "degrees": None})


def least_of(clause: Clause) -> float:
    """Returns the least angle in degrees of the turns of a clause."""
    own = KINDS[clause.kind].degrees
    return max(span(clause.degrees).lo, own.lo if own and clause.kind not in STRAIGHT else 0.0)


def _with_measure_of_all(brief: Brief, text: SlottedText) -> Brief:
    """Gives every turn the radius or the angle of "six bends, all with a radius of 20 m, two of them ..."."""
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    told = _told_of_all(total(brief.clauses), text)
    names = ("radius", "degrees") if all(clause.kind == "turn" for clause in turning) else ("radius",)
    for name in names:
        values = {getattr(clause, name) for clause in turning}
        if len(values) == 2 and None in values and values - {None} == {told}:
            clauses = tuple(
                each if each.kind in STRAIGHT else each.model_copy(update={name: told})
                for each in brief.clauses
            )
            return brief.model_copy(update={"clauses": clauses})
    return brief


def _told_of_all(turns: Amount, text: SlottedText) -> Amount | None:
    """Returns the number behind a word for all, if the count before it is that of all turns and no other
    number of the text has its value.
    """
    found = list[str]()
    words = [word.text for word in text.words]
    for at in (place for place, word in enumerate(words) if word in EVERYONE):
        count = next((float(word) for word in reversed(words[:at]) if word.isdecimal()), None)
        near = words[at + 1 : at + 1 + NEAR]
        slot = next((place for place, word in enumerate(near) if word.startswith("[unused")), NEAR)
        if count is not None and exactly(count) == turns and not any(map(str.isdecimal, near[:slot])):
            found += near[slot : slot + 1]
    names = {slot_name(at): slot.value for at, slot in enumerate(text.slots)}
    if len(found) != 1 or [*names.values()].count(names.get(found[0], 0.0)) != 1:
        return None
    return exactly(names[found[0]])


def _without(clause: Clause, name: str) -> Clause:
    return clause if clause.kind in STRAIGHT else clause.model_copy(update={name: None})


def _is_ruled_out(bound: float, text: SlottedText) -> bool:
    """True if the sentence with this number says "none" or "no bend"."""
    words = [word.text for word in text.words]
    names = [slot_name(at) for at, slot in enumerate(text.slots) if slot.value == bound]
    if len(names) != 1 or names[0] not in words:
        return False
    at = words.index(names[0])
    first = max((place + 1 for place in range(at) if words[place] in SENTENCE_STOPS), default=0)
    last = next((place for place in range(at, len(words)) if words[place] in SENTENCE_STOPS), len(words))
    sentence = words[first:last]
    of_turns = any(one == "no" and other in COUNTED | ONE_TURN for one, other in pairwise(sentence))
    return of_turns or not NONE.isdisjoint(sentence)


def _with_other_exception(brief: Brief, text: SlottedText) -> Brief:
    """Sends the only turn without a side to the other side, if all others go to the one side that is said."""
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    exceptions = [clause for clause in turning if clause.side is None]
    sides = {clause.side for clause in turning if clause.side}
    words = [word.text for word in text.words]
    is_one = len(exceptions) == 1 and exceptions[0].count == exactly(1)
    if not is_one or len(sides) != 1 or not _names_an_exception(words):
        return brief
    (side,) = sides
    if not (RIGHT if side == "left" else LEFT).isdisjoint(words):
        return brief
    other = exceptions[0].model_copy(update={"side": OTHER_SIDE[side]})
    clauses = tuple(other if clause is exceptions[0] else clause for clause in brief.clauses)
    return brief.model_copy(update={"clauses": clauses})


def _names_an_exception(words: Sequence[str]) -> bool:
    """True if the words say "all but the last", "every bend to the left except one" or the like."""
    last = len(words)
    for at, word in enumerate(words):
        if word in ALL or word in STOPS:
            last = at if word in ALL else len(words)
        elif word in EXCEPT and 0 < at - last <= NEAR and not ONE_OF_ALL.isdisjoint(words[at + 1 : at + 4]):
            return True
    return False
