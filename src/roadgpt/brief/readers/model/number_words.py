"""Numbers in words: how five languages put them together, from the words in ``languages.toml``."""

import re
import unicodedata
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Literal

from roadgpt.brief.languages import TABLE, word_set


def _sets_in(part: str) -> Iterator[tuple[tuple[str, ...], str]]:
    """Yields the words of each set of a part of the table, with what the set means."""
    for meaning, keys in TABLE[part].items():
        for key in keys.split("|"):
            yield tuple(key.split()), meaning


LEFT, RIGHT = word_set("left"), word_set("right")
TURNS, ONE_TURN = word_set("turns"), word_set("one_turn")
COUNTED = TURNS | word_set("shapes") | {"curve"}
"""Nouns that a number can count."""
Unit = Literal["metres", "percent", "degrees", "kmh", "mps2", ""]
UNITS: dict[tuple[str, ...], tuple[Unit, float]] = {
    tuple(word.split("_")): (unit, factor)
    for unit, factor, words in TABLE["units"]["rows"]
    for word in words.split()
}
"""The unit in plans (such as metres) of each unit in texts, and the factor that converts to it."""
ONES, SHARE_FILLERS = word_set("ones"), word_set("share_fillers")
SHARES: dict[str, float] = {
    word: 1 / int(below) for below, words in TABLE["shares"].items() for word in words.split()
}
SETS = {key: int(number) for key, number in _sets_in("sets")}
VAGUE_SETS = {
    key: (int(least), int(most))
    for key, ends in _sets_in("vague_sets")
    for least, _, most in [ends.partition("-")]
}
ORDINALS = word_set("ordinals")
LANGUAGES = ("en", "de", "fr", "es", "it")
SMALL: Mapping[str, list[str]] = {code: words.split() for code, words in TABLE["small"].items()}
TENS: Mapping[str, list[str]] = {code: words.split() for code, words in TABLE["tens"].items()}
SPANISH_HUNDREDS = dict(enumerate(TABLE["hundreds"]["es"].split(), 1))
LONGEST = 10
"""The most words that one number has: "nine thousand nine hundred and ninety-nine" has seven."""
THOUSAND, HUNDRED = 1000, 100


SIZES = {word: int(size) for size, words in TABLE["sizes"].items() for word in words.split()}
"""Words that multiply the number before them."""
FRENCH_TENS = {70: ("septante",), 80: ("huitante", "octante"), 90: ("nonante",)}
"""The tens of Switzerland and Belgium."""


def plain(text: str) -> str:
    """Returns the text in lower case without accents; every character keeps its position."""
    return "".join(_plain_letter(letter) for letter in text)


@cache
def _plain_letter(letter: str) -> str:
    bare = unicodedata.normalize("NFD", letter)[0].lower()
    return bare if len(bare) == 1 else letter


def below_hundred(number: int, language: str) -> str:
    """Returns a whole number from 0 to 99 in words."""
    small, tens = SMALL[language], TENS[language]
    ten, one = divmod(number, 10)
    if number < len(small):
        return small[number]
    match language:
        case "de":
            return (f"{small[one]}und" if one else "") + tens[ten]
        case "fr" if one or ten in (7, 9):
            one += 10 * (ten in (7, 9))
            return tens[ten] + (" et " if one in (1, 11) and ten < 8 else "-") + small[one]
        case "fr":
            return tens[ten] + ("s" if ten == 8 else "")
        case "es":
            return tens[ten] + (f" y {small[one]}" if one else "")
        case "it":
            return (tens[ten][:-1] if one in (1, 8) else tens[ten]) + (small[one] if one else "")
    return tens[ten] + (f"-{small[one]}" if one else "")


@cache
def numbers_in_words(key: tuple[str, ...]) -> Mapping[str, int]:
    """Returns the number that some words mean, in each language in which they mean one.

    The number 1 is left out: as a word it is mostly an article or a pronoun ("un virage", "the last one").

    Args:
        key: the words in lower case, without accents and hyphens; all of them belong to the number."""
    text = " ".join(key)
    found = {language: _value(text, language) for language in LANGUAGES}
    return {language: value for language, value in found.items() if value is not None and value != 1}


@cache
def number_word(word: str) -> int:
    """Returns the number that a word stands for, in the first language in which the word is a number; 0 if
    there is no such language."""
    return next(iter(numbers_in_words((word,)).values()), 0)


@cache
def begins_number(word: str) -> bool:
    """Returns whether a number in words can begin with this word, as in "a hundred" or "eighty metres"."""
    return word == "a" or any(_value(word, language) is not None for language in LANGUAGES)


def _value(text: str, language: str) -> int | None:
    text = _one_spelling(text, language)
    found = _small_numbers(language).get(text)
    if found is not None:
        return found
    its = TABLE["compositions"][language]
    for size in (THOUSAND, HUNDRED):
        for match in re.finditer(rf"(?:{its[str(size)]})", text) if str(size) in its else ():
            many = _many(text[: match.start()].strip(), size, language)
            rest = _rest(text[match.end() :], size, language)
            if many is not None and rest is not None:
                return many * size + rest
    return None


def _many(text: str, size: int, language: str) -> int | None:
    """Returns how many thousands or hundreds there are: "twenty-five hundred" has 25."""
    is_one = text == "" or (text == "a" and language == "en")
    many = 1 if is_one else _value(text, language)
    if not many or many >= THOUSAND or (size == HUNDRED and (many >= HUNDRED or many % 10 == 0)):
        return None
    return many


def _rest(text: str, size: int, language: str) -> int | None:
    """Returns what is added to thousands or hundreds; None if it is no number below one of them."""
    if not text:
        return 0
    joint = re.match(TABLE["compositions"][language]["joint"], text)
    rest = _value(text[joint.end() :], language) if joint else None
    is_round = rest is not None and size == THOUSAND and rest % HUNDRED == 0
    is_list = joint is not None and joint[0] == " e " and not is_round  # "mille e cinquecento" is 1500
    return rest if rest and rest < size and not is_list else None


@cache
def _small_numbers(language: str) -> Mapping[str, int]:
    """Returns the numbers of a language that are looked up, by their words."""
    small = {
        _one_spelling(plain(text).replace("-", " "), language): number
        for number in range(HUNDRED)
        for text in _spellings(number, language)
    }
    return small | _spanish_hundreds(small) if language == "es" else small


def _spellings(number: int, language: str) -> Iterator[str]:
    text = below_hundred(number, language)
    yield text
    if language == "en" and number // 10 == 4:
        yield text.replace("forty", "fourty")
    if language == "de" and number in (1, 2):
        yield ("eins", "zwo")[number - 1]
    if language == "fr" and number % 10 == 1:
        yield text + "e"
    if language == "fr" and number >= 70:
        for tens in FRENCH_TENS[number // 10 * 10]:
            ones = number % 10
            yield tens + (" et un" if ones == 1 else f" {below_hundred(ones, 'fr')}" if ones else "")
    if language == "es" and number % 10 == 1:
        yield text.removesuffix("o")
        yield text.removesuffix("o") + "a"
    if language == "it" and number % 10 == 1 and number > 20:
        yield text.removesuffix("o")


def _spanish_hundreds(small: Mapping[str, int]) -> dict[str, int]:
    """Returns the numbers from 100 to 999 by their words; the hundreds have a feminine."""
    out = {"cien": HUNDRED}
    for hundreds, name in SPANISH_HUNDREDS.items():
        for head in {name, re.sub("tos$", "tas", name)}:
            out |= {f"{head} {rest}".strip(): hundreds * HUNDRED + n for rest, n in {"": 0, **small}.items()}
    return out


def _one_spelling(text: str, language: str) -> str:
    """Returns a number without umlauts and "ß", however these are written; an Italian one with all vowels."""
    if language == "de":
        return text.replace("fuenf", "funf").replace("zwoelf", "zwolf").replace("ß", "ss")
    return text.replace("centott", "centoott") if language == "it" else text
