"""Makes generated texts look typed by people: typing errors, capitals, missing full stops, polite phrases."""

import re

import numpy as np

from roadgpt_training.phrasebook import one_of, phrases_of

NEIGHBOURS = {
    "a": "sqz", "b": "vn", "c": "xv", "d": "sf", "e": "wr", "f": "dg", "g": "fh", "h": "gj", "i": "uo",
    "j": "hk",
    "k": "jl", "l": "k", "m": "n", "n": "bm", "o": "ip", "p": "o", "q": "wa", "r": "et", "s": "ad", "t": "ry",
    "u": "yi", "v": "cb", "w": "qe", "x": "zc", "y": "tu", "z": "x",
}  # fmt: skip
WORDS = phrases_of("typing")
SLIPS: dict[str, list[tuple[str, str]]] = WORDS["slips"]
"""Pairs of a word and a common misspelling or abbreviation of it, by language."""
BEFORE: dict[str, list[str]] = WORDS["before"]
AFTER: dict[str, list[str]] = WORDS["after"]
"""Polite phrases to add after a description, by language."""


def tidy(text: str, language: str = "en") -> str:
    """Corrects the spaces, and in English the articles, in a text that was put together by grammar rules."""
    text = re.sub(r"\s+", " ", text)
    text = re.sub(r"\s+([,.;:!?])(?!\d)", r"\1", text)
    text = re.sub(r"([,.;:])(?:\s*[,;])+", r"\1", text)
    text = re.sub(r"\.\s*\.", ".", text)
    if language == "en":
        text = re.sub(r"\b([Aa]) (?=[aeiouAEIO])(?!one|u-|U-|uturn|uni)", r"\1n ", text)
    return text.strip(" ,;:")


def noisy(text: str, language: str, rng: np.random.Generator) -> str:
    """Returns the text with random typing errors or polite phrases, as if typed by a person."""
    if rng.random() < 0.12:
        text = one_of(BEFORE[language], rng) + text
    if rng.random() < 0.15:
        text = text.rstrip(".") + one_of(AFTER[language], rng)
    if rng.random() < 0.12:
        for _ in range(int(rng.integers(1, 5))):
            word, short = one_of(SLIPS[language], rng)
            text = re.sub(rf"\b{word}\b", short, text, count=1)
    if rng.random() < 0.16:
        for _ in range(int(rng.integers(1, 1 + max(2, len(text) // 25)))):
            text = _slip(text, rng)
    return _dressed(text, rng)


def _slip(text: str, rng: np.random.Generator) -> str:
    """Makes one typing error: two letters swapped, one dropped, doubled or hit on a key beside it, or a space
    dropped.
    """
    places = [m.start() for m in re.finditer(r"(?<=[a-zà-ÿ])[a-zà-ÿ]", text)]
    if not places:
        return text
    at = one_of(places, rng)
    kind = rng.random()
    if kind < 0.35:
        return text[: at - 1] + text[at] + text[at - 1] + text[at + 1 :]
    if kind < 0.65:
        return text[:at] + text[at + 1 :]
    if kind < 0.8:
        return text[:at] + text[at] + text[at:]
    if kind < 0.95:
        return text[:at] + one_of(NEIGHBOURS.get(text[at], text[at]), rng) + text[at + 1 :]
    space = text.find(" ", at)
    return text if space < 0 else text[:space] + text[space + 1 :]


def _dressed(text: str, rng: np.random.Generator) -> str:
    """Varies capitals and punctuation."""
    dress = rng.random()
    if dress < 0.25:
        text = text[:1].upper() + text[1:] + ("." if rng.random() < 0.5 and text[-1:].isalnum() else "")
    elif dress < 0.28:
        text = text.upper()
    elif dress < 0.31:
        text = re.sub(r"[,;:.](?=\s)", "", text)
    elif dress < 0.34:
        text = re.sub(r"\s*([,;/])\s*", r"\1", text)
    return text
