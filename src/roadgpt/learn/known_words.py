"""Finds the words that a reader has learnt: words that correlate with the tokens of plans, and function
words.
"""

from collections import Counter
from collections.abc import Iterable
from importlib.resources import files

from roadgpt.brief.readers.model.numerals import plain
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.vocabulary import tokens_of
from roadgpt.learn.generator import Pair

LEAST = 4  # times that a word must have been seen with a token
LIFT = 2.5
"""How many times more often than by chance a word must occur with a plan token to count as learnt."""


def joints() -> frozenset[str]:
    """Returns function words, such as 'and' or 'the', in five languages."""
    text = (files("roadgpt.learn") / "words" / "joints.txt").read_text(encoding="utf-8")
    return frozenset(plain(text).split())


def known_words(pairs: Iterable[Pair]) -> list[str]:
    """Returns the learnt words in alphabetical order.

    A word counts as learnt if some plan token occurs far more often with this word than by chance. The word
    'lonely' has no such token, so 'lonely' is reported as unused in 'a lonely road'.
    """
    word_in: Counter[str] = Counter()
    token_in: Counter[str] = Counter()
    both: Counter[tuple[str, str]] = Counter()
    number = 0
    for pair in pairs:
        text = slotted(pair.text)
        tokens = {*(tokens_of(pair.plan, text.slots) or [])}
        said = {word.text for word in text.words if word.text.isalpha()}
        number += 1
        word_in.update(said)
        token_in.update(tokens)
        both.update((word, token) for word in said for token in tokens)
    learnt = {
        word
        for (word, token), times in both.items()
        if times >= LEAST
        and times * number > LIFT * word_in[word] * token_in[token]
        and times > 0.3 * word_in[word]
    }
    return sorted(learnt | joints())
