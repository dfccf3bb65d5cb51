"""Finds the words that a reader does not report as unused: function words, and frequent words that mean
nothing in a plan, such as "please" or "question".
"""

from collections import Counter
from collections.abc import Iterable
from importlib.resources import files

from roadgpt.brief.readers.model.numerals import plain
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.used_words import NEGATORS
from roadgpt.brief.readers.model.vocabulary import tokens_of
from roadgpt.learn.generator import Pair

OFTEN = 10  # a word that occurs in at least this many pairs may be a filler
LEAST = 4  # a word and a token are unrelated if fewer pairs than this have both
SHARE = 0.3  # a word and a token are unrelated if at most this share of the word's pairs has the token
LIFT = 2.5
"""How many times more often than by chance a word must occur with a token of plans to have a meaning."""
COMMON = frozenset({";", "|", ")", ":", ",", "turn", "x"})
"""Tokens that say nothing about what the words mean."""


def filler_words(pairs: Iterable[Pair]) -> list[str]:
    """Returns the filler words in alphabetical order.

    Args:
        pairs: hand-written pairs, in which words are counted.
    """
    of_word: Counter[str] = Counter()
    of_token: Counter[str] = Counter()
    both: Counter[tuple[str, str]] = Counter()
    number = 0
    for pair in pairs:
        text = slotted(pair.text, pair.is_change)
        tokens = {t for t in tokens_of(pair.plan, text.slots) or () if t not in COMMON and t[0] != "["}
        said = {word.text for word in text.words if word.text.isalpha()}
        number += 1
        of_word.update(said)
        of_token.update(tokens)
        both.update((word, token) for word in said for token in tokens)
    meaning = {
        word
        for (word, token), times in both.items()
        if times >= LEAST
        and times > SHARE * of_word[word]
        and times * number >= LIFT * of_word[word] * of_token[token]
    }
    frequent = {word for word, times in of_word.items() if times >= OFTEN} - meaning
    return sorted((frequent | function_words()) - NEGATORS)


def function_words() -> frozenset[str]:
    """Returns function words, such as "and" or "the", in five languages."""
    text = (files("roadgpt.learn") / "words" / "joints.txt").read_text(encoding="utf-8")
    return frozenset(plain(text).split())
