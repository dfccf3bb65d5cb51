"""Number words in five languages: ``spell`` writes a number as words; ``number_words`` reads them."""

import unicodedata
from functools import cache

LANGUAGES = ("en", "de", "fr", "es", "it")

ENGLISH = [
    "zero",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
    "thirteen",
    "fourteen",
    "fifteen",
    "sixteen",
    "seventeen",
    "eighteen",
    "nineteen",
]
ENGLISH_TENS = ["-", "-", "twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"]
GERMAN = [
    "null",
    "ein",
    "zwei",
    "drei",
    "vier",
    "fünf",
    "sechs",
    "sieben",
    "acht",
    "neun",
    "zehn",
    "elf",
    "zwölf",
    "dreizehn",
    "vierzehn",
    "fünfzehn",
    "sechzehn",
    "siebzehn",
    "achtzehn",
    "neunzehn",
]
GERMAN_TENS = [
    "-",
    "-",
    "zwanzig",
    "dreißig",
    "vierzig",
    "fünfzig",
    "sechzig",
    "siebzig",
    "achtzig",
    "neunzig",
]
FRENCH = [
    "zéro",
    "un",
    "deux",
    "trois",
    "quatre",
    "cinq",
    "six",
    "sept",
    "huit",
    "neuf",
    "dix",
    "onze",
    "douze",
    "treize",
    "quatorze",
    "quinze",
    "seize",
    "dix-sept",
    "dix-huit",
    "dix-neuf",
]
FRENCH_TENS = [
    "-",
    "-",
    "vingt",
    "trente",
    "quarante",
    "cinquante",
    "soixante",
    "soixante",
    "quatre-vingt",
    "quatre-vingt",
]
SPANISH = [
    "cero",
    "uno",
    "dos",
    "tres",
    "cuatro",
    "cinco",
    "seis",
    "siete",
    "ocho",
    "nueve",
    "diez",
    "once",
    "doce",
    "trece",
    "catorce",
    "quince",
    "dieciséis",
    "diecisiete",
    "dieciocho",
    "diecinueve",
    "veinte",
    "veintiuno",
    "veintidós",
    "veintitrés",
    "veinticuatro",
    "veinticinco",
    "veintiséis",
    "veintisiete",
    "veintiocho",
    "veintinueve",
]
SPANISH_TENS = ["-", "-", "-", "treinta", "cuarenta", "cincuenta", "sesenta", "setenta", "ochenta", "noventa"]
SPANISH_HUNDREDS = [
    "-",
    "ciento",
    "doscientos",
    "trescientos",
    "cuatrocientos",
    "quinientos",
    "seiscientos",
    "setecientos",
    "ochocientos",
    "novecientos",
]
ITALIAN = [
    "zero",
    "uno",
    "due",
    "tre",
    "quattro",
    "cinque",
    "sei",
    "sette",
    "otto",
    "nove",
    "dieci",
    "undici",
    "dodici",
    "tredici",
    "quattordici",
    "quindici",
    "sedici",
    "diciassette",
    "diciotto",
    "diciannove",
]
ITALIAN_TENS = [
    "-",
    "-",
    "venti",
    "trenta",
    "quaranta",
    "cinquanta",
    "sessanta",
    "settanta",
    "ottanta",
    "novanta",
]


def plain(text: str) -> str:
    """Returns the text in lower case without accents; every character keeps its position."""
    return "".join(_plain_letter(letter) for letter in text)


@cache
def _plain_letter(letter: str) -> str:
    bare = unicodedata.normalize("NFD", letter)[0].lower()
    return bare if len(bare) == 1 else letter


def spell(number: int, language: str) -> str:
    """Returns a whole number from 0 to 9999 in words."""
    return _SPELL[language](number)


def _english(n: int) -> str:
    if n < 20:
        return ENGLISH[n]
    if n < 100:
        return ENGLISH_TENS[n // 10] + (f"-{ENGLISH[n % 10]}" if n % 10 else "")
    size, name = (1000, "thousand") if n >= 1000 else (100, "hundred")
    rest = n % size
    return f"{ENGLISH[n // size]} {name}" + (f" and {_english(rest)}" if rest else "")


def _german(n: int) -> str:
    if n < 20:
        return GERMAN[n]
    if n < 100:
        return (f"{GERMAN[n % 10]}und" if n % 10 else "") + GERMAN_TENS[n // 10]
    size, name = (1000, "tausend") if n >= 1000 else (100, "hundert")
    rest = n % size
    return ("" if n // size == 1 else GERMAN[n // size]) + name + (_german(rest) if rest else "")


def _french(n: int) -> str:
    if n < 20:
        return FRENCH[n]
    if n < 100:
        tens, ones = divmod(n, 10)
        if tens in (7, 9):
            ones += 10
        if not ones:
            return FRENCH_TENS[tens] + ("s" if tens == 8 else "")
        return FRENCH_TENS[tens] + (" et " if ones in (1, 11) and tens < 8 else "-") + FRENCH[ones]
    size, name = (1000, "mille") if n >= 1000 else (100, "cent")
    many, rest = divmod(n, size)
    head = name if many == 1 else f"{FRENCH[many]} {name}{'s' if name == 'cent' and not rest else ''}"
    return head + (f" {_french(rest)}" if rest else "")


def _spanish(n: int) -> str:
    if n < 30:
        return SPANISH[n]
    if n < 100:
        return SPANISH_TENS[n // 10] + (f" y {SPANISH[n % 10]}" if n % 10 else "")
    if n == 100:
        return "cien"
    if n < 1000:
        return SPANISH_HUNDREDS[n // 100] + (f" {_spanish(n % 100)}" if n % 100 else "")
    return (
        ("" if n < 2000 else f"{SPANISH[n // 1000]} ")
        + "mil"
        + (f" {_spanish(n % 1000)}" if n % 1000 else "")
    )


def _italian(n: int) -> str:
    if n < 20:
        return ITALIAN[n]
    if n < 100:
        tens, ones = ITALIAN_TENS[n // 10], n % 10
        return (tens[:-1] if ones in (1, 8) else tens) + (ITALIAN[ones] if ones else "")
    if n < 1000:
        head = ("" if n < 200 else ITALIAN[n // 100]) + "cento"
        return head + (_italian(n % 100) if n % 100 else "")
    return ("mille" if n < 2000 else f"{ITALIAN[n // 1000]}mila") + (_italian(n % 1000) if n % 1000 else "")


_SPELL = {"en": _english, "de": _german, "fr": _french, "es": _spanish, "it": _italian}
