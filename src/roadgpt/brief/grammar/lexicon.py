"""Looks up phrases in the vocabularies, the longest match first, and tolerates simple typing errors."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache

from roadgpt.brief.grammar.english import ROAD_WORDS
from roadgpt.brief.grammar.english_function_words import FUNCTION_WORDS
from roadgpt.brief.grammar.german import GERMAN
from roadgpt.brief.grammar.romance import ROMANCE
from roadgpt.brief.grammar.tokens import Token, tokens
from roadgpt.brief.grammar.unsupported_words import UNSUPPORTED_WORDS

ALIKE = 0.75
"""The least similarity, from 0 to 1 (``difflib``), at which an unknown word is taken for a mistyped known
one."""
LEAST_LETTERS = 5  # of a word in which a typing error is corrected; shorter ones are too similar
MOST_LETTERS = 20
UNKNOWN = "?"
NEED_A_NUMBER_AFTER = frozenset({">", "<", "exact"})
NEED_A_NUMBER_BEFORE = frozenset({"or_more", "or_less"})
BOUNDS = NEED_A_NUMBER_AFTER | NEED_A_NUMBER_BEFORE
Meanings = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Lexeme:
    """A meaning and the tokens from which it was read, from index ``start`` up to but excluding ``stop``."""

    name: str
    start: int
    stop: int
    value: float = 0.0
    text: str = ""


@dataclass(frozen=True, slots=True)
class Lexicon:
    """A dictionary that maps phrases, as tuples of words, to their meanings."""

    phrases: dict[tuple[str, ...], tuple[Meanings, ...]]
    longest: dict[str, int]
    """For each word, the number of words of the longest phrase that begins with it."""

    @classmethod
    def of(cls, vocabularies: Iterable[dict[str, str]]) -> "Lexicon":
        """Builds a Lexicon from vocabularies; if several contain a phrase, its meanings are listed in the
        order of the vocabularies.
        """
        phrases: dict[tuple[str, ...], tuple[Meanings, ...]] = {}
        longest: dict[str, int] = {}
        for vocabulary in vocabularies:
            for key, listed in vocabulary.items():
                meanings = tuple(key.split())
                for phrase in listed.split(" | "):
                    words = tuple(token.text for token in tokens(phrase)) or (phrase.strip(" "),)
                    known = phrases.get(words, ())
                    if meanings not in known:
                        phrases[words] = (*known, meanings)
                    longest[words[0]] = max(longest.get(words[0], 0), len(words))
        return cls(phrases, longest)


@cache
def lexicon() -> Lexicon:
    """Returns the lexicon built from all vocabularies: first the words that a Brief cannot express, then
    English, then the other languages.
    """
    return Lexicon.of((UNSUPPORTED_WORDS, ROAD_WORDS, FUNCTION_WORDS, GERMAN, ROMANCE))


def lex(found: Sequence[Token]) -> list[Lexeme]:
    """Returns the meanings in a description in text order; words without a meaning become UNKNOWN."""
    known, out, at = lexicon(), list[Lexeme](), 0
    while at < len(found):
        token = found[at]
        if token.sort in ("number", "ratio"):
            out.append(Lexeme(token.text, at, at + 1, token.value))
            at += 1
            continue
        size, meanings = _longest(known, found, at, out)
        if not meanings and token.sort == "word":
            meanings = _forgiven(token.text)
        for name in meanings or ((UNKNOWN,) if token.sort == "word" else ()):
            out.append(Lexeme(name, at, at + size, text=token.text))
        at += size
    return out


def _longest(
    known: Lexicon, found: Sequence[Token], at: int, before: Sequence[Lexeme]
) -> tuple[int, Meanings]:
    most = min(known.longest.get(found[at].text, 1), len(found) - at)
    for size in range(most, 0, -1):
        words = tuple(token.text for token in found[at : at + size])
        if words == AT_ONCE and before and before[-1].name in ("a", "long", "short"):
            continue  # 'a long straight after the turn' is a straight
        readings = known.phrases.get(words)
        if readings and (meanings := _reading(readings, found, at + size, before)):
            return size, meanings
    bound = known.phrases.get((found[at].text,))
    return 1, ("-",) if bound else ()


def _reading(
    readings: tuple[Meanings, ...], found: Sequence[Token], stop: int, before: Sequence[Lexeme]
) -> Meanings:
    """Returns the first reading, except that 'over' needs a number after it to be a bound, and 'or more'
    one before.
    """
    number_near = any(lexeme.name.startswith("#") for lexeme in before[-2:])  # '3 turns or more'
    number_before = bool(before) and (before[-1].name.startswith("#") or before[-1].name in UNITS)
    number_after = stop < len(found) and _is_number(found[stop])
    for meanings in readings:
        if meanings[-1] in NEED_A_NUMBER_AFTER and number_after:
            return meanings
        near = number_before or (number_near and found[stop - 1].text in ("more", "fewer", "less"))
        if meanings[-1] in NEED_A_NUMBER_BEFORE and near and not number_after:
            return meanings
        if meanings[-1] == "in_ten" and number_before and number_after:
            return meanings
    plain = [meanings for meanings in readings if meanings[-1] not in BOUNDS and meanings != ("in_ten",)]
    return plain[0] if plain else ()


AT_ONCE = ("straight", "after")
UNITS = frozenset({"m", "km", "ft", "yd", "mile", "%", "deg"})


def _is_number(token: Token) -> bool:
    if token.sort in ("number", "ratio"):
        return True
    readings = lexicon().phrases.get((token.text,), ())
    return any(meanings[0].startswith("#") for meanings in readings)


def similar(word: str) -> str | None:
    """Returns the word about roads that a mistyped word resembles, such as 'turns' for 'trns'; None if
    there is none.
    """
    known = {w for listed in ROAD_WORDS.values() for w in listed.split() if len(w) > 3 and w.isalpha()}
    near = get_close_matches(word, sorted(known), n=1, cutoff=ALIKE)
    return near[0] if near else None


def is_strange(word: str) -> bool:
    """Returns True if no phrase of any vocabulary begins with this word."""
    return word not in lexicon().longest


@cache
def _with_a_letter_missing() -> dict[str, set[str]]:
    """Indexes the words of the vocabularies by what remains when one letter, or none, is left out."""
    index: dict[str, set[str]] = {}
    for words in lexicon().phrases:
        if len(words) == 1 and len(words[0]) >= LEAST_LETTERS:
            for form in _shorter(words[0]):
                index.setdefault(form, set()).add(words[0])
    return index


def _shorter(word: str) -> set[str]:
    return {word, *(word[:i] + word[i + 1 :] for i in range(len(word)))}


def _forgiven(word: str) -> Meanings:
    """Returns the meaning of the only known word that differs by one letter more, less, other or swapped."""
    if not LEAST_LETTERS <= len(word) <= MOST_LETTERS:
        return ()
    index, phrases = _with_a_letter_missing(), lexicon().phrases
    near = {
        w for form in _shorter(word) for w in index.get(form, ()) if w[0] == word[0] and _one_slip(word, w)
    }
    meanings = {phrases[(w,)][0] for w in near}
    return meanings.pop() if len(meanings) == 1 else ()


def _one_slip(one: str, other: str) -> bool:
    head = next(
        (i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other))
    )
    rest, rest_other = one[head:], other[head:]
    swapped = len(rest) > 1 and rest[1] + rest[0] + rest[2:] == rest_other
    return swapped or rest[1:] == rest_other[1:] or rest[1:] == rest_other or rest == rest_other[1:]
