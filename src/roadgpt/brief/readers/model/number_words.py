"""Makes sets of words from strings in which spaces separate the words."""

import re
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Literal


def word_set(*lines: str) -> frozenset[str]:
    """Returns the set of the words in some strings."""
    return frozenset(word for line in lines for word in line.split())


LEFT = word_set(
    "left lefts lefthand leftward linke links linkskurven gauche izquierda sinistra l lh sx izq izda"
)
RIGHT = word_set(
    "right rights righthand rightward rechte rechts rechtskurven droite derecha destra r rh dx dcha"
)
TURNS = word_set("turns bends corners curves kurven virages tournants courbes curvas")
"""Plural nouns for turns in general; Italian "curve" is left out, since it is singular in English."""
SHAPES = word_set("hairpins switchbacks kehren tournants epingles horquillas tornanti")
"""Plural nouns for turns of a particular shape."""
ONE_TURN = word_set("turn bend curve corner hairpin switchback kurve kehre virage tournant curva")
COUNTED = TURNS | SHAPES | {"curve"}
"""Nouns that a number can count."""


Unit = Literal["metres", "percent", "degrees", "kmh", ""]

WORDS_OF_UNITS: tuple[tuple[Unit, float, str], ...] = (
    ("metres", 1.0, "m mt mts mtr mtrs metre metres meter meters metern metro metros metri meteres"),
    ("metres", 1000.0, "km kms kilometre kilometres kilometer kilometers kilometern"),
    ("metres", 1000.0, "kilometro kilometros chilometro chilometri"),
    ("metres", 0.01, "cm centimetre centimetres centimeter centimeters zentimeter zentimetern"),
    ("metres", 0.01, "centimetro centimetros centimetri"),
    ("metres", 0.3048, "ft feet foot fuß fuss pied pieds pie pies piede piedi"),
    ("metres", 0.9144, "yd yds yard yards yarda yardas iarde"),
    ("metres", 1609.344, "mile miles meile meilen mille_marin milla millas miglio miglia"),
    ("percent", 1.0, "% pct percent procent prozent per_cent pour_cent por_ciento per_cento"),
    ("percent", 1.0, "pourcent porciento"),
    ("percent", 0.1, "‰ promille permille permil per_mille per_mil pour_mille por_mil"),
    ("degrees", 1.0, "° º deg degs degree degrees degre degres grad grado grados gradi"),
    ("degrees", 0.9, "gon gons gradians grades_centesimaux"),
    ("kmh", 1.0, "kmh kph mph km/h"),
)
"""Units in plans (such as metres), the factor that converts to each, and the words of the unit."""
UNITS = {
    tuple(word.split("_")): (unit, factor) for unit, factor, words in WORDS_OF_UNITS for word in words.split()
}
TIMES = word_set("h hr hrs hour std stunde heure hora ora s sec second sekunde seconde segundo secondo")
"""Units of time: a length divided by one of them is a speed."""
ONES = word_set("a an one ein eine einen einem eins un une uno una")
"""Words that mean the number one before a unit ("a kilometre") or in a ratio ("one in ten")."""
SHARES: dict[str, float] = {
    word: share
    for share, words in {
        1 / 2: "half halber halben halbe halbes demi medio media mezzo mezza",
        1 / 4: "quarter quarters viertel quart quarts cuarto cuartos quarto quarti",
        1 / 3: "third thirds drittel tiers tercio tercios terzo terzi",
        1 / 8: "eighth eighths achtel huitieme octavo ottavo",
        1 / 5: "fifth fifths fuenftel cinquieme quinto quinti quintos",
        1 / 10: "tenth tenths zehntel dixieme decimo decimi decimos",
    }.items()
    for word in words.split()
}
"""Fractions of a unit: "half a mile", "drei viertel Kilometer"."""
MILLIONS = word_set("million millions millionen millones millon milione milioni billion milliarde")
SHARE_FILLERS = frozenset(
    {"of", "a", "an", "de", "d", "'", "un", "di", "eines", "einem", "-", "full", "whole", "ganzer"}
)
"""Words that may occur between a fraction and its unit."""
RATIO = frozenset({":", "in", "zu", "sur", "su", "en", "auf"})
"""Words between the two numbers of a ratio: "1:8", "one in eight", "1 zu 8"."""
JOINTS = word_set("to - and or through bis und oder a et ou y o e u ed od , al / till until ..")
"""Words between two numbers that share the unit after the second: "40 to 60 metres"."""
SETS: dict[tuple[str, ...], int] = {
    tuple(key.split()): number
    for number, keys in {
        2: "a couple of|couple of|a pair of|pair of|a couple|un par de|un paio di|une paire de|ein paar zwei",
        6: "half a dozen|half dozen|a half dozen"
        "|ein halbes dutzend|halbes dutzend|une demi douzaine|demi douzaine"
        "|media docena|una media docena|mezza dozzina|una mezza dozzina|half a dozen of|media docena de"
        "|une demi douzaine de|mezza dozzina di|una mezza dozzina di|una media docena de",
        10: "une dizaine de|dizaine de|une dizaine d|una decina di|decina di|una decena de|decena de",
        15: "une quinzaine de|quinzaine de|una quindicina di|quindicina di|una quincena de",
        20: "une vingtaine de|vingtaine de|una ventina di|ventina di|una veintena de|veintena de",
        30: "une trentaine de|trentaine de|d une trentaine de|una trentina di|trentina di|una treintena de",
        40: "une quarantaine de|quarantaine de|una quarantina di|quarantina di|una cuarentena de",
        50: "une cinquantaine de|cinquantaine de|una cinquantina di|cinquantina di|una cincuentena de",
        60: "une soixantaine de|soixantaine de|una sessantina di|sessantina di",
        80: "una ottantina di|ottantina di|un ottantina di",
        100: "une centaine de|centaine de|un centinaio di|centinaio di|un centenar de|centenar de",
        24: "a couple of dozen|couple of dozen|a couple dozen|couple dozen",
        200: "a couple of hundred|couple of hundred|a couple hundred|couple hundred",
        1000: "un millier de|millier de|un millar de|millar de|un migliaio di|migliaio di",
        2000: "a couple of thousand|couple of thousand|a couple thousand|couple thousand",
        12: "a dozen|dozen|ein dutzend|dutzend|une douzaine|une douzaine de|una docena|una docena de"
        "|una dozzina|una dozzina di",
    }.items()
    for key in keys.split("|")
}
"""Words for a set of things ("a couple of"), and the number of things they mean."""
VAGUE_SETS: dict[tuple[str, ...], tuple[int, int]] = {
    tuple(key.split()): between
    for between, keys in {
        (20, 50): "a few tens of|few tens of|quelques dizaines de|unas decenas de|algunas decenas de"
        "|qualche decina di|alcune decine di",
        (24, 60): "a few dozen|few dozen|ein paar dutzend|einige dutzend|quelques douzaines de"
        "|unas docenas de|qualche dozzina di|alcune dozzine di",
        (30, 90): "several tens of|plusieurs dizaines de|varias decenas de|diverse decine di"
        "|parecchie decine di",
        (36, 90): "several dozen|mehrere dutzend|plusieurs douzaines de|varias docenas de",
        (20, 90): "tens of|dizaines de|decenas de|decine di",
        (200, 500): "a few hundred|few hundred|a few hundreds of|ein paar hundert|einige hundert"
        "|wenige hundert|quelques centaines de|unos cientos de|algunos cientos de|unos centenares de"
        "|algunos centenares de|qualche centinaio di|alcune centinaia di|poche centinaia di",
        (300, 900): "several hundred|several hundreds of|mehrere hundert|plusieurs centaines de"
        "|varios cientos de|varios centenares de|diverse centinaia di|parecchie centinaia di",
        (200, 900): "hundreds of|hunderte|hunderte von|centaines de|cientos de|centenares de|centinaia di",
        (2000, 5000): "a few thousand|few thousand|ein paar tausend|einige tausend|quelques milliers de"
        "|unos miles de|qualche migliaio di|alcune migliaia di",
    }.items()
    for key in keys.split("|")
}
"""Words for a vague number of units ("a few hundred metres"), with the least and the greatest number that
the words mean.
"""
ORDINALS = frozenset(["st", "nd", "rd", "th", "er", "ere", "eme", "e", "a", "o", "nde", "ste", "te"])
FUNCTION_WORDS: dict[str, frozenset[str]] = {
    code: frozenset(its.split())
    for code, its in {
        "en": "the a an and with then of to road turn turns bend bends that left right for is it in all",
        "de": "der die das und mit eine ein einer dann nach strasse straße kurve kurven links"
        " rechts bergauf bergab"
        " nicht auf den dem es ist",
        "fr": "le la les et avec une un des puis route virage virages gauche droite de du en pas"
        " est sur a montee"
        " descente",
        "es": "el la los las y con una un carretera curva curvas izquierda derecha de del luego"
        " que por sin en es"
        " despues",
        "it": "il la le e con una un strada curva curve sinistra destra di poi che per senza in"
        " del salita discesa"
        " dopo",
    }.items()
}
"""Frequent words of each language, used to guess the language, since some words are numbers in one language
only."""
AMBIGUOUS = word_set(
    "once due sei cent mille elf dos sept tres tre mil cien six dix nove seis sette null zero cento dieci",
    "fourty vier acht neuf huit ochenta",
)
"""Number words that mean something else in another language ("once", "très", "due to")."""


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
SPANISH_HUNDREDS = dict(
    enumerate(
        [
            "ciento",
            "doscientos",
            "trescientos",
            "cuatrocientos",
            "quinientos",
            "seiscientos",
            "setecientos",
            "ochocientos",
            "novecientos",
        ],
        1,
    )
)
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
