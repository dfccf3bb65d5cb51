"""Chooses few pairs out of many that are alike, so that a slow law is tried on each word of the plans."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise

WORD = re.compile(r"[a-z_]+=?|[^a-z_ ]")


def covering(plans: Sequence[str], times: int = 1) -> list[int]:
    """Returns the places of plans that together have each word, and each two words in a row, ``times`` times.

    Numbers count as one word; a plan is chosen if one of its words stands in fewer than ``times`` before.
    """
    seen: Counter[tuple[str, ...]] = Counter()
    chosen = []
    for place, plan in enumerate(plans):
        its = {*_words(plan)}
        if any(seen[each] < times for each in its):
            chosen.append(place)
            seen.update(its)
    return chosen


def _words(plan: str) -> Iterator[tuple[str, ...]]:
    words = WORD.findall(re.sub(r"\d+(?:\.\d+)?", "0", plan))
    yield from ((word,) for word in words)
    yield from pairwise(words)
