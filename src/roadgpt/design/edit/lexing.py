"""Splits a change request into lexemes: words, phrases and numbers, each with its meaning."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache

from roadgpt.brief.grammar.tokens import Token, plain, tokens
from roadgpt.design.edit.vocabulary import NUMBERS, ORDINALS, WORDS

UNKNOWN = "?"
ALIKE = 0.84  # share of letters in common from which a word may be another one mistyped
LEAST_LETTERS = 5  # of a word that may be mistyped
_ELIDED = re.compile(r"\b(l|d|un|dell|all|nell|dall|sull|qu)['’](?=\w)", re.I)
_OWNER = re.compile(r"\b(turn|bend|curve|corner|straight|road|hairpin|end|start|\d+)['’]s\b", re.I)
_ENDINGS = frozenset({"st", "nd", "rd", "th", "er", "ere", "eme", "re", "a", "o", "ª", "º", "e"})
SIGNS = {",": "comma", ";": "then", ".": "stop", "!": "stop", "\n": "then", "%": "%", "°": "deg",
         "&": "and", "+": "plus", "(": "open", ")": "close"}  # fmt: skip


@dataclass(frozen=True, slots=True)
class RequestLexeme:
    """A word, phrase or number of a request.

    ``name`` is its meaning in the vocabulary, "#" for a number, or "ord" for an ordinal.
    """

    name: str
    text: str
    value: float = 0.0
    unit: str = ""
    """The unit of a number: deg, m, %, times, or empty if it has none."""


@cache
def _phrases() -> dict[tuple[str, ...], tuple[str, float]]:
    """Meaning and value of every phrase; what is listed first wins."""
    out: dict[tuple[str, ...], tuple[str, float]] = {}
    for number, listed in ORDINALS.items():
        for phrase in _listed(listed):
            out.setdefault(phrase, ("ord", float(number)))
    for name, listed in WORDS.items():
        for phrase in _listed(listed):
            out.setdefault(phrase, (name, 0.0))
    for number, listed in NUMBERS.items():
        for phrase in _listed(listed):
            out.setdefault(phrase, ("#", float(number)))
    return out


def _listed(listed: str) -> list[tuple[str, ...]]:
    single, *rest = listed.split("|")
    # a hyphen between words is written as a sign, or not at all
    return [(word,) for word in plain(single).split()] + [
        tuple(phrase.split()) for phrase in map(plain, rest) if phrase.strip()
    ]


@cache
def _longest() -> int:
    return max(len(phrase) for phrase in _phrases())


def lexemes(words: str) -> list[RequestLexeme]:
    """Returns the lexemes of a request in order; words without a meaning are UNKNOWN, and words without
    effect are left out.
    """
    found = tokens(_OWNER.sub(r"\1", _ELIDED.sub(r"\1 ", words)))
    out: list[RequestLexeme] = []
    at = 0
    while at < len(found):
        token = found[at]
        if token.sort in ("number", "ratio"):
            at = _number(found, at, out)
            continue
        size, name, value = _longest_phrase(found, at)
        if not name:
            name, value = _sign_or_slip(token)
        text = " ".join(t.raw for t in found[at : at + size])
        at += size
        if name == "-" and text.lower() == "one" and out and out[-1].name in ("turn", "straight"):
            name, value = "#", 1.0  # 'turn one'
        if name != "-":
            first, *rest = name.split() or [name]
            out += [RequestLexeme(first, text, value), *(RequestLexeme(part, "", value) for part in rest)]
    return _with_units(out)


def _number(found: Sequence[Token], at: int, out: list[RequestLexeme]) -> int:
    """A number, or an ordinal: '2nd', '2. Kurve', '2e virage'."""
    token = found[at]
    after = found[at + 1] if at + 1 < len(found) else None
    if token.sort == "ratio":
        out.append(RequestLexeme("#", token.raw, token.value, "%"))
        return at + 1
    is_whole = token.value == int(token.value) and 1 <= token.value < 100
    beyond = found[at + 2] if at + 2 < len(found) else None
    if after and is_whole:
        glued = after.sort == "word" and after.text in _ENDINGS and after.text not in ("a", "e", "o")
        dotted = after.text == "." and beyond is not None and _is_thing(beyond)
        if glued or dotted:
            out.append(RequestLexeme("ord", f"{token.raw}{after.raw}", token.value))
            return at + 2
    out.append(RequestLexeme("#", token.raw, token.value))
    return at + 1


def _is_thing(token: Token) -> bool:
    name, _ = _phrases().get((token.text,), ("", 0.0))
    return name.split(" ")[-1] in ("turn", "straight", "hairpin")


def _longest_phrase(found: Sequence[Token], at: int) -> tuple[int, str, float]:
    for size in range(min(_longest(), len(found) - at), 0, -1):
        meaning = _phrases().get(tuple(token.text for token in found[at : at + size]))
        if meaning:
            return size, *meaning
    return 1, "", 0.0


def _sign_or_slip(token: Token) -> tuple[str, float]:
    if token.sort == "sign":
        if token.text == "-":
            return "dash", 0.0
        return SIGNS.get(token.text, "-"), 0.0
    if stem := _stem(token.text):
        return _phrases()[(stem,)]
    if len(token.text) == LEAST_LETTERS - 1:  # 'raod': two letters changed places
        near = [
            w for (w, *more) in _phrases() if not more and w[0] == token.text[0] and _has_letters(w, token)
        ]
        if near:
            return _phrases()[(near[0],)]
    if len(token.text) >= LEAST_LETTERS:
        known = [words[0] for words in _phrases() if len(words) == 1]
        near = get_close_matches(token.text, known, n=1, cutoff=ALIKE)
        if near and near[0][0] == token.text[0]:
            return _phrases()[(near[0],)]
    return UNKNOWN, 0.0


def _stem(word: str) -> str:
    """The verb of 'widened', 'flipped' and 'removing'; empty where it is none that is known."""
    for ending in ("ed", "d", "ing"):
        stem = word.removesuffix(ending)
        if stem != word and len(stem) >= 3:
            doubled = stem[:-1] if stem[-1] == stem[-2] else stem
            for known in (stem, f"{stem}e", doubled):
                if _phrases().get((known,), ("",))[0] not in ("", "-", "not", "#", "ord"):
                    return known
    return ""


def _has_letters(word: str, token: Token) -> bool:
    return sorted(word) == sorted(token.text)


UNITS = {"deg": ("deg", 1.0), "m": ("m", 1.0), "km": ("m", 1000.0), "ft": ("m", 0.3048), "%": ("%", 1.0)}
UNITS["times"] = ("times", 1.0)


def _with_units(given: Sequence[RequestLexeme]) -> list[RequestLexeme]:
    """Numbers with the unit behind them; 'twenty five' put together; dashes that say nothing left out."""
    out: list[RequestLexeme] = []
    for lexeme in given:
        before = out[-1] if out else None
        if before and before.name == "#" and not before.unit:
            if lexeme.name in UNITS:
                unit, factor = UNITS[lexeme.name]
                out[-1] = RequestLexeme("#", f"{before.text} {lexeme.text}", before.value * factor, unit)
                continue
            if lexeme.name == "#" and before.value in (20, 30, 50, 90) and lexeme.value < 10:
                out[-1] = RequestLexeme("#", f"{before.text} {lexeme.text}", before.value + lexeme.value)
                continue
            if lexeme.name == "dash":
                out.append(lexeme)
                continue
        if lexeme.name in ("twice", "thrice", "half", "quarter"):
            value = {"twice": 2.0, "thrice": 3.0, "half": 0.5, "quarter": 0.25}[lexeme.name]
            out.append(RequestLexeme("#", lexeme.text, value, "times"))
            continue
        if lexeme.name == "dash":
            continue
        if before and before.name == "dash":
            if lexeme.name == "#":
                out[-1] = RequestLexeme("to", "-")
            else:
                out.pop()
                if lexeme.name in UNITS and out and out[-1].name == "#" and not out[-1].unit:
                    unit, factor = UNITS[lexeme.name]
                    out[-1] = RequestLexeme("#", out[-1].text, out[-1].value * factor, unit)
                    continue
        out.append(lexeme)
    return out
