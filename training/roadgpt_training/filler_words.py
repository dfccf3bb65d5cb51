"""Finds filler words, such as "the", "please" or "question", which mean nothing in a plan, so that readers do
not report them as unused: by counting which tokens the plans of descriptions have.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from importlib.resources import files

from roadgpt.brief.readers.model.number_words import plain
from roadgpt.brief.readers.model.slots import slotted
from roadgpt_training.pair import Pair
from roadgpt_training.tokens import tokens_of

OFTEN = 10  # a word that occurs in at least this many pairs may be a filler
LEAST = 4  # a word and a token are unrelated if fewer pairs than this have both
RELATED = ((0.3, 2.5), (0.75, 1.5))
"""Lower limits of a share and a lift. A word asks for a token if both values reach the two limits of one
entry. The share is the share of the word's pairs that have the token. The lift is how many times more often
than by chance the word and the token occur together.
"""
COMMON = frozenset({";", "|", ")", ":", ",", "turn", "x"})
"""Tokens that say nothing about what the words mean."""
NEGATORS = frozenset(
    [
        "no",
        "not",
        "never",
        "none",
        "neither",
        "nor",
        "nowhere",
        "without",
        "t",
        "nothing",
        "cannot",
        "dont",
        "doesnt",
        "don",
        "doesn",
        "isn",
        "shouldn",
        "only",
        "except",
        "kein",
        "keine",
        "keinen",
        "keiner",
        "keines",
        "nicht",
        "nichts",
        "nie",
        "niemals",
        "nirgends",
        "nirgendwo",
        "ohne",
        "weder",
        "nur",
        "ausser",
        "pas",
        "sans",
        "aucun",
        "aucune",
        "jamais",
        "nulle",
        "ni",
        "rien",
        "seulement",
        "sauf",
        "sin",
        "nunca",
        "ningun",
        "ninguna",
        "nada",
        "salvo",
        "excepto",
        "non",
        "senza",
        "mai",
        "nessun",
        "nessuna",
        "nessuno",
        "niente",
        "ne",
        "solo",
        "soltanto",
        "tranne",
    ]
)
"""Words that deny or limit something: a reading that stays the same without them has ignored them."""


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
        is_often = self.both[word, token] >= LEAST
        return is_often and any(share >= low and lift >= least for low, least in RELATED)


def _counted(pairs: Iterable[Pair]) -> _Counts:
    counts = _Counts()
    for pair in pairs:
        text = slotted(pair.text, pair.is_change)
        tokens = {t for t in tokens_of(pair.plan, text.slots) or () if t not in COMMON and t[0] != "["}
        said = {word.text for word in text.words if word.text.isalpha()}
        counts.add(said, tokens)
    return counts


def filler_words(pairs: Iterable[Pair]) -> list[str]:
    """Returns the filler words in alphabetical order: all function words, such as "and", and all words that
    occur in at least 10 pairs and ask for no token. Words of negation are left out.
    """
    counts = _counted(pairs)
    meaning = {word for word, token in counts.both if counts.is_asked(word, token)}
    frequent = {word for word, times in counts.of_word.items() if times >= OFTEN} - meaning
    joints = (files("roadgpt_training") / "words" / "joints.txt").read_text(encoding="utf-8")
    return sorted((frequent | {*plain(joints).split()}) - NEGATORS)
