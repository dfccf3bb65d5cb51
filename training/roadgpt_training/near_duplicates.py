"""Finds descriptions that are nearly the same: more than 60 % of the shorter one's 5-grams are in both.

Numbers and words of the same kind (such as left and right, or turn and bend) are masked first, so texts that
fill the same template with different words are found too.
"""

import re
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from roadgpt.brief.readers.model.number_words import numbers_in_words, plain
from roadgpt_training.phrasebook import phrases_of

GRAM = 5
MOST_SHARED = 0.6
MASKS: dict[str, str] = phrases_of("masks")
"""Maps each mask to the words that are replaced by the mask."""
MASK_OF = {word: mask for mask, its in MASKS.items() for word in its.split()}


@dataclass(frozen=True, slots=True)
class NearDuplicate:
    """Two descriptions, by index, that have too many 5-grams in common; ``shared`` is the fraction, 0 to 1,
    of the shorter one's 5-grams that the other one also has.
    """

    shared: float
    first: int
    second: int


def masked(text: str) -> tuple[str, ...]:
    """Returns the words of a text, with masks for numbers and for words such as left and right."""
    return tuple(_mask(word) for word in re.findall(r"\d+(?:[.,]\d+)?|[^\W\d_]+", plain(text)))


@cache
def _mask(word: str) -> str:
    if word[0].isdigit() or numbers_in_words((word,)):
        return "0"
    return MASK_OF.get(word, word)


def grams(text: str) -> Counter[tuple[str, ...]]:
    """Counts the 5-grams of a text (five words in a row); all words of a shorter text form a single gram."""
    said = masked(text)
    size = min(GRAM, len(said))
    return Counter(said[at : at + size] for at in range(max(1, len(said) - size + 1)))


def near_duplicates(texts: Sequence[str]) -> list[NearDuplicate]:
    """Returns all pairs of texts in which more than 60 % of the shorter text's 5-grams also occur in the
    longer text, worst first.

    A pair is skipped if both texts have fewer than five words, or if one text has only masked words, such as
    "two left bends". There are few ways to write such texts.
    """
    counted = [grams(text) for text in texts]
    places: dict[tuple[str, ...], list[int]] = defaultdict(list)
    shared: Counter[tuple[int, int]] = Counter()
    found: list[NearDuplicate] = []
    for index, own in enumerate(counted):
        shared.clear()
        for gram, times in own.items():
            for other in places[gram]:
                shared[other, index] += min(times, counted[other][gram])
            places[gram].append(index)
        for (other, _), number in shared.items():
            share = number / min(own.total(), counted[other].total())
            if share > MOST_SHARED and not _are_bare(own, counted[other]):
                found.append(NearDuplicate(share, other, index))
    return sorted(found, key=lambda pair: (-pair.shared, pair.first, pair.second))


def _are_bare(one: Counter[tuple[str, ...]], other: Counter[tuple[str, ...]]) -> bool:
    """True if one of the two has only masks, or both are shorter than a gram."""
    short = all(counter.total() == 1 and len(next(iter(counter))) < GRAM for counter in (one, other))
    masks = {*MASKS}
    return short or any(all(masks >= {*gram} for gram in counter) for counter in (one, other))


def report(texts: Mapping[str, Sequence[str]]) -> list[str]:
    """Returns a sentence for each pair of near-duplicates; ``texts`` maps the name of each split to its
    texts.
    """
    side = [name for name, its in texts.items() for _ in its]
    every = [text for its in texts.values() for text in its]
    return [
        f"{pair.shared:.0%} shared ({side[pair.first]}/{side[pair.second]}):"
        f" '{every[pair.first]}' and '{every[pair.second]}'"
        for pair in near_duplicates(every)
    ]
