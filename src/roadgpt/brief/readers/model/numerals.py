"""Number words in five languages: ``spell`` writes a number as words; ``numbers_in_words`` reads them.

"two thousand five hundred", "zweitausendfünfhundert", "quinze cents", "dos mil", "duemila": a number is so
many thousands, so many hundreds, and the rest. Only the numbers below 100 are looked up, and the Spanish
hundreds. Numbers are read up to 999,999.
"""

import re
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

LANGUAGES = ("en", "de", "fr", "es", "it")
SMALL: Mapping[str, list[str]] = {
    language: words.split()
    for language, words in {
        "en": "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen"
        " sixteen seventeen eighteen nineteen",
        "de": "null ein zwei drei vier fünf sechs sieben acht neun zehn elf zwölf dreizehn vierzehn fünfzehn"
        " sechzehn siebzehn achtzehn neunzehn",
        "fr": "zéro un deux trois quatre cinq six sept huit neuf dix onze douze treize quatorze quinze seize"
        " dix-sept dix-huit dix-neuf",
        "es": "cero uno dos tres cuatro cinco seis siete ocho nueve diez once doce trece catorce quince"
        " dieciséis diecisiete dieciocho diecinueve veinte veintiuno veintidós veintitrés veinticuatro"
        " veinticinco veintiséis veintisiete veintiocho veintinueve",
        "it": "zero uno due tre quattro cinque sei sette otto nove dieci undici dodici tredici quattordici"
        " quindici sedici diciassette diciotto diciannove",
    }.items()
}
"""The numbers from 0 that are single words."""
TENS: Mapping[str, list[str]] = {
    language: words.split()
    for language, words in {
        "en": "- - twenty thirty forty fifty sixty seventy eighty ninety",
        "de": "- - zwanzig dreißig vierzig fünfzig sechzig siebzig achtzig neunzig",
        "fr": "- - vingt trente quarante cinquante soixante soixante quatre-vingt quatre-vingt",
        "es": "- - - treinta cuarenta cincuenta sesenta setenta ochenta noventa",
        "it": "- - venti trenta quaranta cinquanta sessanta settanta ottanta novanta",
    }.items()
}
SPANISH_HUNDREDS = {
    1: "ciento",
    2: "doscientos",
    3: "trescientos",
    4: "cuatrocientos",
    5: "quinientos",
    6: "seiscientos",
    7: "setecientos",
    8: "ochocientos",
    9: "novecientos",
}
LONGEST = 10
"""The most words that one number has: "nine thousand nine hundred and ninety-nine" has seven."""
THOUSAND, HUNDRED = 1000, 100


@dataclass(frozen=True, slots=True)
class NumberWords:
    """How a language puts numbers together."""

    sizes: Mapping[int, str]
    """The patterns of the words for 1000 and for 100, by the number, the larger number first."""
    joint: str
    """The pattern of what may stand between such a word and the rest of the number, such as "and"."""


COMPOSITIONS: Mapping[str, NumberWords] = {
    "en": NumberWords({THOUSAND: r" ?\bthousand\b", HUNDRED: r" ?\bhundred\b"}, " (?:and )?"),
    "de": NumberWords({THOUSAND: " ?tausend", HUNDRED: " ?hundert"}, "(?: |und|)"),
    "fr": NumberWords({THOUSAND: r" ?\bmille\b", HUNDRED: r" ?\bcent\b|(?<=.) cents\b"}, " "),
    "es": NumberWords({THOUSAND: r" ?\bmil\b"}, " "),
    "it": NumberWords({THOUSAND: r"(?<=.) ?mila|\bmille", HUNDRED: " ?cento"}, "(?: e | |)"),
}
SIZES: Mapping[str, int] = {
    **dict.fromkeys(("hundred", "hundert", "cent", "cents", "cento"), HUNDRED),
    **dict.fromkeys(("thousand", "tausend", "mille", "mil", "mila"), THOUSAND),
}
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


def spell(number: int, language: str) -> str:
    """Returns a whole number from 0 to 9999 in words."""
    if number < len(SMALL[language]):
        return SMALL[language][number]
    return _SPELL[language](number, SMALL[language], TENS[language])


def _english(n: int, small: list[str], tens: list[str]) -> str:
    if n < 100:
        return tens[n // 10] + (f"-{small[n % 10]}" if n % 10 else "")
    size, name = (1000, "thousand") if n >= 1000 else (100, "hundred")
    rest = n % size
    return f"{small[n // size]} {name}" + (f" and {spell(rest, 'en')}" if rest else "")


def _german(n: int, small: list[str], tens: list[str]) -> str:
    if n < 100:
        return (f"{small[n % 10]}und" if n % 10 else "") + tens[n // 10]
    size, name = (1000, "tausend") if n >= 1000 else (100, "hundert")
    rest = n % size
    return ("" if n // size == 1 else small[n // size]) + name + (spell(rest, "de") if rest else "")


def _french(n: int, small: list[str], tens: list[str]) -> str:
    if n < 100:
        many, ones = divmod(n, 10)
        if many in (7, 9):
            ones += 10
        if not ones:
            return tens[many] + ("s" if many == 8 else "")
        return tens[many] + (" et " if ones in (1, 11) and many < 8 else "-") + small[ones]
    size, name = (1000, "mille") if n >= 1000 else (100, "cent")
    many, rest = divmod(n, size)
    head = name if many == 1 else f"{small[many]} {name}{'s' if name == 'cent' and not rest else ''}"
    return head + (f" {spell(rest, 'fr')}" if rest else "")


def _spanish(n: int, small: list[str], tens: list[str]) -> str:
    if n < 100:
        return tens[n // 10] + (f" y {small[n % 10]}" if n % 10 else "")
    if n == 100:
        return "cien"
    size = 1000 if n >= 1000 else 100
    many, rest = divmod(n, size)
    thousands = "mil" if many == 1 else f"{small[many]} mil"
    head = thousands if size == 1000 else SPANISH_HUNDREDS[many]
    return head + (f" {spell(rest, 'es')}" if rest else "")


def _italian(n: int, small: list[str], tens: list[str]) -> str:
    if n < 100:
        ten, ones = tens[n // 10], n % 10
        return (ten[:-1] if ones in (1, 8) else ten) + (small[ones] if ones else "")
    size = 1000 if n >= 1000 else 100
    many, rest = divmod(n, size)
    one, several = ("mille", "mila") if size == 1000 else ("cento", "cento")
    head = one if many == 1 else small[many] + several
    return head + (spell(rest, "it") if rest else "")


_SPELL = {"en": _english, "de": _german, "fr": _french, "es": _spanish, "it": _italian}


@cache
def numbers_in_words(key: tuple[str, ...]) -> Mapping[str, int]:
    """Returns the number that some words mean, in each language in which they mean one.

    The number 1 is left out: as a word it is mostly an article or a pronoun ("un virage", "the last one").

    Args:
        key: the words in lower case, without accents and hyphens; all of them belong to the number.
    """
    text = " ".join(key)
    found = {language: _value(text, language) for language in LANGUAGES}
    return {language: value for language, value in found.items() if value is not None and value != 1}


@cache
def number_word(word: str) -> int:
    """Returns the number that a word stands for, in the first language in which the word is a number; 0 if
    there is no such language.
    """
    return next(iter(numbers_in_words((word,)).values()), 0)


@cache
def begins_number(word: str) -> bool:
    """Returns whether a number in words can begin with this word, as in "a hundred" or "eighty metres"."""
    return word == "a" or any(_value(word, language) is not None for language in LANGUAGES)


def _value(text: str, language: str) -> int | None:
    """Returns the value of a number in words; None if they are no number."""
    text = _one_spelling(text, language)
    found = _small_numbers(language).get(text)
    if found is not None:
        return found
    its = COMPOSITIONS[language]
    for size, name in its.sizes.items():
        for match in re.finditer(rf"(?:{name})", text):
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
    joint = re.match(COMPOSITIONS[language].joint, text)
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
    text = spell(number, language)
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
            yield tens + (" et un" if ones == 1 else f" {spell(ones, 'fr')}" if ones else "")
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
