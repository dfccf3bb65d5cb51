"""Chooses among the plans that the networks wrote, and makes a Brief of the chosen plan."""

import re
from collections.abc import Sequence
from math import inf
from typing import TypeVar

from roadgpt.brief.feasible import check
from roadgpt.brief.model import Amount, Brief, Clause, exactly
from roadgpt.brief.normal import normal, total
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.mirror import is_of_junctions
from roadgpt.brief.readers.model.nouns import COUNTED, ONE_TURN
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.test_time_augmentation import ScoredPlan
from roadgpt.brief.readers.model.used_words import lost
from roadgpt.errors import BriefError

Sloped = TypeVar("Sloped", Brief, Clause)
NEARLY = 0.7  # difference of score
ALMOST = 2.0  # difference of score
CLOSE = 1.0  # difference of score
FAIRLY = 1.5  # difference of score
FAR = 4.0  # difference of score
NOUN = rf"(?:{'|'.join(sorted({*COUNTED, *ONE_TURN}, key=len, reverse=True))})"
COUNT = re.compile(
    rf"(?<!\w )\b(\d+) (?:\w+ )?(?:{NOUN})\b|\b(?:with|mit|avec|con|of|has|have) (\d+) {NOUN}\b"
)
OF_PART = ("first", "last", "other", "ersten", "letzten", "anderen", "les", "las", "los", "le")
COUNTS = frozenset({"x", "turns=", "lefts=", "rights=", "turn", "hairpin", "switchback", "u_turn"})
"""Tokens of plans that say how many turns there are, if only by naming each."""
ANY_COUNT = re.compile(rf"{''.join(f'(?<!{word} )' for word in OF_PART)}\b(\d+) (?:\w+ )?{NOUN}\b")
"""A number of turns; a number behind a word such as "first" counts only a part, and does not match."""


def most_plausible(found: Sequence[ScoredPlan], text: SlottedText) -> ScoredPlan:
    """Returns the likeliest plan, but prefers plans that match the text and do not contradict themselves.

    If the likeliest plan is a route or a map that contradicts itself, a plan without a contradiction is
    returned in its place, if such a plan is nearly as likely.
    """
    first = found[0] if found[0].is_refusal else _with_all_numbers(found, text) or found[0]
    found = (first, *(draft for draft in found if draft is not first))
    if first.is_refusal:
        return first
    if not is_of_junctions(first.line):
        return _with_told_turns(found, text) or first
    if can_be_kept(first.line):
        return first
    near = [draft for draft in found if not draft.is_refusal and draft.score > first.score - NEARLY]
    return next((draft for draft in near if can_be_kept(draft.line)), first)


def _with_all_numbers(found: Sequence[ScoredPlan], text: SlottedText) -> ScoredPlan | None:
    """Returns the likeliest plan that leaves out no number of the text and does not contradict itself, if it
    is almost as likely as the first plan; else None.

    If the first plan leaves out no number, another one has to be closer to it, since what contradicts itself
    may be the description.
    """
    near = (draft for draft in found if not draft.is_refusal and draft.score > found[0].score - ALMOST)
    whole = [draft for draft in near if not lost(draft.tokens, text)]
    least = found[0].score - CLOSE if found[0] in whole else -inf
    return next((draft for draft in whole if draft.score > least and can_be_kept(draft.line)), None)


def _with_told_turns(found: Sequence[ScoredPlan], text: SlottedText) -> ScoredPlan | None:
    """Returns the likeliest plan of a single road with as many turns as the words count, if it is nearly as
    likely as the first plan; else None.

    If the words count turns once and the first plan counts none, as in "winding, at least 5 bends", a plan
    with this number may be much less likely.
    """
    told, counted = _told_turns(text.text), {*map(int, ANY_COUNT.findall(text.text))} - {1}
    counts_none = len(counted) == 1 and COUNTS.isdisjoint(found[0].tokens)
    least = found[0].score - (FAR if counts_none else FAIRLY)
    near = (draft for draft in found if not draft.is_refusal and draft.score > least)
    kept = (draft for draft in near if not is_of_junctions(draft.line) and can_be_kept(draft.line))
    if counts_none:
        return next((draft for draft in kept if counted & _ends(_turns(draft.line))), None)
    return next((draft for draft in kept if told is not None and _turns(draft.line) == exactly(told)), None)


def _ends(amount: Amount) -> set[float]:
    """Returns the numbers between which an amount lies, one or two."""
    return {end for end in (amount.lo, amount.hi) if end is not None}


def _told_turns(said: str) -> int | None:
    """Returns the number of turns in words, as networks read them; None if there is none, or several."""
    found = {int(first or second) for first, second in COUNT.findall(said)}
    return found.pop() if len(found) == 1 and len({*ANY_COUNT.findall(said)}) <= 1 else None


def agrees_with_numbers(draft: ScoredPlan, text: SlottedText) -> bool:
    """Returns whether a plan leaves out no number of the text, and has as many turns as the words count."""
    told = _told_turns(text.text)
    return not lost(draft.tokens, text) and (told is None or _turns(draft.line) == exactly(told))


def _turns(line: str) -> Amount:
    brief = normal(read_plan(line))
    return brief.turns or total(brief.clauses)


def brief_of(line: str, text: SlottedText, words: str) -> Brief:
    """Returns the Brief of a plan, corrected by rules where the words of the description are clear."""
    brief = _level_at_zero(read_plan(line))
    if brief.junctions or brief.map is not None:
        brief = _with_words_of_network(brief, text, words)
    return brief


def _with_words_of_network(brief: Brief, text: SlottedText, words: str) -> Brief:
    """Returns the Brief of a route or a map, corrected by rules that single roads do not need."""
    from roadgpt.brief.readers.model.from_start import with_distances_from_start
    from roadgpt.brief.readers.model.map_signs import with_counted_signs
    from roadgpt.brief.readers.model.map_words import with_counted_map
    from roadgpt.brief.readers.model.side_roads import with_end_of_side_street, with_sides_of_side_roads

    brief = with_counted_signs(with_counted_map(brief, text), text)
    brief = with_end_of_side_street(with_distances_from_start(brief, words), words)
    return with_sides_of_side_roads(brief, text, words)


def _level_at_zero(brief: Brief) -> Brief:
    """Returns the Brief with "level" instead of "uphill at 0 percent"."""
    clauses = tuple(_at_zero(clause) for clause in brief.clauses)
    brief = brief.model_copy(update={"clauses": clauses}) if clauses != brief.clauses else brief
    return _at_zero(brief)


def _at_zero(said: Sloped) -> Sloped:
    is_level = said.slope is not None and said.incline == exactly(0)
    return said.model_copy(update={"slope": "flat", "incline": None}) if is_level else said


def can_be_kept(line: str) -> bool:
    """Returns whether a plan can be read and does not contradict itself."""
    try:
        brief = read_plan(line)
        check(brief, map_size=None, min_radius=0.0)  # the limits of a World are checked in brief.read
    except BriefError:
        return False
    return all(map(_sides_add_up, normal(brief).stretches or (normal(brief),)))


def _sides_add_up(brief: Brief) -> bool:
    """True if the numbers of left and right turns can add up to the number of turns."""
    turns = brief.turns or total(brief.clauses)
    sides = (brief.left, brief.right)
    least = sum(side.lo or 0 for side in sides if side)
    if turns.hi is not None and least > turns.hi:
        return False
    most = [side.hi if side else None for side in sides]
    return None in most or turns.lo is None or sum(number or 0 for number in most) >= turns.lo
