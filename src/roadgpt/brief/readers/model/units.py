"""Units and other words that occur next to numbers, in five languages, in lower case without accents."""

from typing import Literal

from roadgpt.brief.readers.model.word_set import word_set

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
