"""Finds what the words of descriptions mean, by counting which tokens the plans of these descriptions have.

There are two results. Filler words, such as "the", "please" or "question", mean nothing in a plan, so
readers do not report them as unused. Each other word asks for certain tokens: those that a plan usually has
if the word is in its description.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from importlib.resources import files

from roadgpt.brief.readers.model.numerals import plain
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.used_words import GROUPS, NEGATORS, with_groups
from roadgpt.brief.readers.model.vocabulary import tokens_of
from roadgpt.learn.pair import Pair

OFTEN = 10  # a word that occurs in at least this many pairs may be a filler
LEAST = 4  # a word and a token are unrelated if fewer pairs than this have both
RELATED = ((0.3, 2.5), (0.75, 1.5))
"""Lower limits of a share and a lift. A word asks for a token if both values reach the two limits of one
entry. The share is the share of the word's pairs that have the token. The lift is how many times more often
than by chance the word and the token occur together.
"""
COMMON = frozenset({";", "|", ")", ":", ",", "turn", "x"})
"""Tokens that say nothing about what the words mean."""
STRUCTURE = frozenset({"//", "||", "(", "..", "=", "+"})
"""Tokens that no word asks for."""
OF_EVERY_CHANGE = frozenset({"side", "shape", "-"})
"""Tokens that no word of a change request asks for: "right" asks for "right", and not for "side" alone."""
OF_GROUP = 40  # pairs that must have both, before a word asks for a group of tokens
OF_MOST = 0.5  # smallest lift of a word's other tokens, as a share of its largest lift


@dataclass
class _Counts:
    """How many pairs have each word, each token, and both."""

    pairs: int = 0
    of_word: Counter[str] = field(default_factory=Counter)
    of_token: Counter[str] = field(default_factory=Counter)
    both: Counter[tuple[str, str]] = field(default_factory=Counter)

    def add(self, said: set[str], tokens: set[str]) -> None:
        self.pairs += 1
        self.of_word.update(said)
        self.of_token.update(tokens)
        self.both.update((word, token) for word in said for token in tokens)

    def share(self, word: str, token: str) -> float:
        """Returns the share of a word's pairs that have the token."""
        return self.both[word, token] / self.of_word[word]

    def lift(self, word: str, token: str) -> float:
        """Returns how many times more often than by chance a word and a token occur together."""
        return self.share(word, token) * self.pairs / self.of_token[token]

    def is_asked(self, word: str, token: str) -> bool:
        """Returns whether a word asks for a token."""
        share, lift = self.share(word, token), self.lift(word, token)
        is_often = self.both[word, token] >= (OF_GROUP if token in GROUPS else LEAST)
        return is_often and any(share >= low and lift >= least for low, least in RELATED)


def _counted(pairs: Iterable[Pair], has_groups: bool) -> _Counts:
    counts = _Counts()
    for pair in pairs:
        text = slotted(pair.text, pair.is_change)
        tokens = {t for t in tokens_of(pair.plan, text.slots) or () if t not in COMMON and t[0] != "["}
        said = {word.text for word in text.words if word.text.isalpha()}
        counts.add(said, set(with_groups(tokens)) if has_groups else tokens)
    return counts


def filler_words(pairs: Iterable[Pair]) -> list[str]:
    """Returns the filler words in alphabetical order: all function words, such as "and", and all words that
    occur in at least 10 pairs and ask for no token. Words of negation are left out.
    """
    counts = _counted(pairs, has_groups=False)
    meaning = {word for word, token in counts.both if counts.is_asked(word, token)}
    frequent = {word for word, times in counts.of_word.items() if times >= OFTEN} - meaning
    joints = (files("roadgpt.learn") / "words" / "joints.txt").read_text(encoding="utf-8")
    return sorted((frequent | {*plain(joints).split()}) - NEGATORS)


def word_meanings(pairs: Iterable[Pair], of_changes: bool = False) -> dict[str, list[str]]:
    """Returns for each word the tokens that it usually asks for in descriptions, or ``of_changes`` in change
    requests, the token with the largest lift first; refusals are not counted.

    Tokens with less than half of the word's largest lift are left out: "priority" often occurs with
    crossroads, but does not ask for crossroads. A group of tokens is returned only for a word that asks for
    no single token. Words of negation have no entry.
    """
    told = (pair for pair in pairs if pair.is_change == of_changes and not pair.is_refusal)
    counts = _counted(told, has_groups=not of_changes)
    lifts: dict[str, dict[str, float]] = {}
    for word, token in counts.both:
        is_empty = token in STRUCTURE or (of_changes and (token in OF_EVERY_CHANGE or token.isdecimal()))
        if counts.is_asked(word, token) and not is_empty and word not in NEGATORS:
            lifts.setdefault(word, {})[token] = counts.lift(word, token)
    return {word: _own(found) for word, found in sorted(lifts.items())}


def _own(lifts: Mapping[str, float]) -> list[str]:
    """Returns the tokens with the largest lifts; groups only if there are no others."""
    own = {token: lift for token, lift in lifts.items() if token not in GROUPS} or lifts
    least = OF_MOST * max(own.values())
    return sorted((token for token in own if own[token] >= least), key=lambda token: (-own[token], token))
