"""Corrects the counts in a plan: each must be a number in the text, or a sum or difference of such numbers.

A small network copies numbers well and calculates badly: for "seven turns, the first two uphill", it wrote
counts of 2 and 4. Here 4 is the only count that is not in the text, and 7 the only number in the text that is
not a count. In such a case, 7 is taken as the total, and the wrong count is corrected to 7 - 2 = 5. If every
count is in the text, but the text also gives a number of turns that is not the sum of any counts, the Brief
keeps this number as its total number of turns. The contradiction is then reported.
"""

from collections.abc import Iterator
from itertools import chain, combinations, pairwise

from roadgpt.brief.model import Amount, Brief, Clause, at_least, exactly
from roadgpt.brief.normal import STRAIGHT, turns_of
from roadgpt.brief.readers.model.nouns import LEFT, RIGHT, TURNS
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.word_set import word_set

MULTIPLES = word_set(
    "twice thrice double doubles triple both pair trio again same half zweimal dreimal beide doppelt",
    "gleiche halb deux fois moitie meme encore dos veces doble ambas misma mitad due volte doppio",
    "entrambe stessa meta alternating",
)
"""Words that imply numbers without naming them, such as "twice"."""
ONE = word_set("one ein eine einen einer eins un une una uno single sole")
"""Words that may be the number 1 or an article."""
MORE = word_set(
    "more further other others additional else otherwise weiteren weitere weiter anderen sonst autres",
    "autre plus davantage mas otras otra otros demas altre altra altri ulteriori",
)
"""Words with which "no turns" excludes only turns that are not named, as in "no further turns"."""
MOST = word_set(
    "mostly majority meist meisten mehrzahl mehrheit plupart majorite mayoria maggioranza maggior"
)
"""Words with which most turns go to one side."""
COMPARED = word_set("more mehr plus mas piu")
THAN = word_set("than als que che di")
"""Words of comparisons, such as "more lefts than rights"."""
MOST_COUNTS = 8
"""The largest number of counts that are checked: eight counts already have 255 possible sums."""


def with_checked_counts(brief: Brief, text: SlottedText) -> Brief:
    """Returns the Brief with its counts corrected to follow from the numbers in the text.

    The Brief of a route with junctions or of a map is returned unchanged, because a number in its text may
    count turns or junctions.
    """
    if brief.junctions or brief.map is not None:
        return brief
    words = {word.text for word in text.words}
    said = [int(word.text) for word in text.words if word.text.isdecimal() and word.written]
    brief = _without_more(brief, words)
    sides = _majority(_sides_summed(brief, [*said, 1] if words & ONE else said, words), said, words)
    return _total_kept(_counts_summed(sides, said, words), text, {*said, 1})


def _without_more(brief: Brief, words: set[str]) -> Brief:
    """Removes 'no turns' if turns are named and a word such as "further" says that only others are meant."""
    turning = any(clause.kind not in STRAIGHT for clause in brief.clauses)
    if turning and brief.turns and brief.turns.hi == 0 and words & MORE:
        return brief.model_copy(update={"turns": None})
    return brief


def _sides_summed(brief: Brief, said: list[int], words: set[str]) -> Brief:
    """Corrects the left and right turns to add up to the number of turns, if that is known."""
    turns = _total(brief)
    sides = (brief.left, brief.right)
    if turns is None or not any(sides) or not all(side is None or side.exact for side in sides):
        return brief
    left, right = (None if side is None or side.lo is None else int(side.lo) for side in sides)
    if left is not None and right is not None and left + right == turns:
        return brief
    number, side = _trusted(left, right, said, words)
    if side is None or number is None or not 0 < number <= turns:
        return brief
    if side == "left":
        return brief.model_copy(update={"left": exactly(number), "right": exactly(turns - number)})
    return brief.model_copy(update={"left": exactly(turns - number), "right": exactly(number)})


def _majority(brief: Brief, said: list[int], words: set[str]) -> Brief:
    """Corrects "at least n turns to one side" to more than half of the turns, if most go there and the words
    do not give n."""
    turns = _total(brief)
    is_compared = all(words & each for each in (COMPARED, THAN, LEFT, RIGHT))
    if turns is None or not (is_compared or words & MOST):
        return brief
    for name, side, other in (("left", brief.left, brief.right), ("right", brief.right, brief.left)):
        if other is None and side and side.hi is None and side.lo not in said and (side.lo or 0) > 1:
            return brief.model_copy(update={name: at_least(turns // 2 + 1)})
    return brief


def _trusted(
    left: int | None, right: int | None, said: list[int], words: set[str]
) -> tuple[int | None, str | None]:
    """Returns the number that was said and its side; if only one side is named, the number belongs to it."""
    named_left, named_right = bool(words & LEFT), bool(words & RIGHT)
    numbers = [number for number in (left, right) if number is not None]
    heard = [number for number in numbers if number in said]
    if named_left != named_right and len(set(heard)) == 1:
        return heard[0], "left" if named_left else "right"
    if left is None or right is None:
        return numbers[0], "right" if left is None else "left"
    if len(heard) == 1:
        return heard[0], "left" if left == heard[0] else "right"
    return None, None


def _total(brief: Brief) -> int | None:
    """Returns the number of turns if the Brief gives it as one exact number, else None."""
    if brief.turns and brief.turns.exact and not brief.clauses:
        return int(brief.turns.lo or 0)
    if len(brief.clauses) == 1 and brief.clauses[0].kind == "turn" and brief.clauses[0].count.exact:
        return int(brief.clauses[0].count.lo or 0)
    return None


def _counts_summed(brief: Brief, said: list[int], words: set[str]) -> Brief:
    """Corrects the only count that is not in the text by the only number in the text that is not a count."""
    if words & MULTIPLES or brief.left or brief.right or brief.hills:
        return brief
    turning = [index for index, clause in enumerate(brief.clauses) if clause.kind not in STRAIGHT]
    counts = {index: _exact(brief.clauses[index].count) for index in turning}
    if not turning or None in counts.values():
        return brief
    measured = measured_values(brief)
    left_over = [number for number in said if number not in measured]
    for count in counts.values():
        if count in left_over:
            left_over.remove(count)
    strange = [index for index, count in counts.items() if count and count > 1 and count not in said]
    if len(left_over) != 1 or left_over[0] < 2:
        return brief
    if not strange and sum(count or 0 for count in counts.values()) != left_over[0]:
        strange = [index for index in turning if _is_plain(brief.clauses[index])] if len(turning) == 2 else []
    if len(strange) != 1:
        return brief
    others = sum(count or 0 for index, count in counts.items() if index != strange[0])
    right = left_over[0] - others
    if right < 1:
        return brief
    clauses = list(brief.clauses)
    clauses[strange[0]] = clauses[strange[0]].model_copy(update={"count": exactly(right)})
    return brief.model_copy(update={"clauses": tuple(clauses)})


def _total_kept(brief: Brief, text: SlottedText, said: set[int]) -> Brief:
    """Adds the number of turns that the text gives, if all counts are in the text and none add up to it."""
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    counts = [_exact(clause.count) for clause in turning]
    if brief.turns or not 2 <= len(counts) <= MOST_COUNTS or not said.issuperset(n or 0 for n in counts):
        return brief
    sums = {sum(some) for some in _subsets([turns_of(clause)[0] for clause in turning])}
    explained = sums | {*counts, len(counts)} | measured_values(brief)
    total = next((n for n in _before_turns(text) if n > 1 and n not in explained), None)
    return brief.model_copy(update={"turns": exactly(total)}) if total else brief


def _before_turns(text: SlottedText) -> Iterator[int]:
    """Yields the numbers that stand right before a word for turns."""
    for word, after in pairwise(text.words):
        if word.text.isdecimal() and word.written and after.text in TURNS:
            yield int(word.text)


def _subsets(numbers: list[float]) -> Iterator[tuple[float, ...]]:
    return chain.from_iterable(combinations(numbers, size) for size in range(1, len(numbers) + 1))


def measured_values(brief: Brief) -> set[float | None]:
    """Returns every number of the plan that is not a count."""
    amounts = [brief.steepest, brief.climb]
    things: list[Brief | Clause] = [brief, *brief.clauses]
    for thing in things:
        amounts += [thing.degrees, thing.radius, thing.length, thing.incline]
    return {bound for amount in amounts if amount for bound in (amount.lo, amount.hi)}


def _exact(amount: Amount) -> int | None:
    return int(amount.lo) if amount.exact and amount.lo is not None else None


def _is_plain(clause: Clause) -> bool:
    return clause == Clause(kind="turn", count=clause.count)
