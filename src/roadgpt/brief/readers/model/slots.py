"""Replaces the numbers in a description by slots before the model reads it, so that the model only copies
slots.

    "three bends in 300 ft at 1:8"  ->  3 bends in [1] metres at [2] percent        [1] = 91.4, [2] = 12.5

Small numbers without a unit remain digits, because the model must know the counts ("4 turns, the first two
uphill"). Every other number becomes a slot: a token whose value is stored separately, in metres, degrees or
percent."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import radians, tan

from roadgpt.brief.languages import (
    FUNCTION_WORDS,
    TABLE,
    language_of,
    pattern_of,
    with_plain_numbers,
    word_set,
)
from roadgpt.brief.readers.model.number_words import (
    COUNTED,
    LEFT,
    LONGEST,
    ONE_TURN,
    ONES,
    ORDINALS,
    RIGHT,
    SETS,
    SHARE_FILLERS,
    SHARES,
    SIZES,
    UNITS,
    VAGUE_SETS,
    Unit,
    begins_number,
    number_word,
    numbers_in_words,
    plain,
)

LARGEST_SEEN = 20
"""The largest number without a unit that remains as digits in the text for the model. Larger ones become
slots."""
LAST_TURN = 9  # a number up to this one behind "turn" says which turn
SIDES = LEFT | RIGHT | word_set("short_sides")
STEEPEST = 45.0  # degrees: anything steeper is a turn, or nonsense that the network refuses itself
AMBIGUOUS, MILLIONS, JOINTS = word_set("ambiguous"), word_set("millions"), word_set("joints")
RATIO, TIMES, POINTS = word_set("ratio"), word_set("times"), word_set("points")
SECONDS = word_set("seconds")
MILES_PER_HOUR = 1.609344
IN_MILES, SPEEDING, SLOWING = word_set("in_miles"), word_set("speeding"), word_set("slowing")
VAGUELY, OF_SPEED, BEHIND_SPEED = word_set("vaguely"), word_set("of_speed"), word_set("behind_speed")
USUAL_SPEEDS = range(5, 121)
"""Numbers without a unit that may be miles per hour."""
SQUARED = [each.split() for each in ("s²", "s 2", "s ^ 2", "s / s", "sec 2", "sec ^ 2")]
SQUARED += [["second", "squared"], ["second", "per", "second"]]
MOST_G = 1.5
"""The largest number of which "g" is an acceleration; "50 g 3" is 50 m and a left turn of a rally."""
RADIUS, LEADING_TO = word_set("radius"), word_set("leading_to")
SLOPES, SLOPING = word_set("slopes"), word_set("sloping")
BETWEEN, SKIPPED = word_set("before_slope"), word_set("skipped")
WHOLE_AND, OF_A_CIRCLE = word_set("whole_and"), word_set("of_a_circle")
TURNING = COUNTED | ONE_TURN | LEFT | RIGHT | {"heading"}
MOST_BETWEEN = 4
"""How many words may separate the slope from its number."""


@dataclass(slots=True)
class NumberInText:
    """A number, its position in the text, and its unit."""

    value: float
    first: int
    last: int  # index of its last word, unit included
    unit: Unit = ""
    is_bare: bool = True
    factor: float = 1.0
    spread: float = 0
    """Tolerance: 1 for "four turns, plus or minus one", which accepts 3 to 5 turns. For a measure, the
    tolerance has the unit of the value."""


def unit_at(tokens: Sequence[str], at: int) -> tuple[Unit, float, int] | None:
    """Returns the unit that begins at token ``at``; None if no unit begins there.

    Returns three values: the corresponding unit in plans (such as metres), the factor that converts to it,
    and how many words the unit takes up in the text."""
    for size in (3, 2, 1):
        found = UNITS.get(tuple(tokens[at : at + size]))
        if found:
            unit, factor = found
            over, time, *more = [*tokens[at + size : at + size + 4], "", "", "", ""][:4]
            if unit == "metres" and over in ("/", "per", "pro", "par", "por", "al"):
                squared = next((each for each in SQUARED if [time, *more][: len(each)] == each), None)
                if squared:
                    return "mps2", factor, size + 1 + len(squared)
                if time in TIMES:
                    return "kmh", factor * (3.6 if time in SECONDS else 0.001), size + 2
            return unit, factor, size
    return None


def take_unit(number: NumberInText, tokens: list[str]) -> None:
    """Assigns to a number the unit that follows it, and converts its value to metres, percent or degrees."""
    if number.unit:
        return
    at = number.last + 1
    for skip in (0, 1):
        if skip and (at >= len(tokens) or tokens[at] not in ("-", "'")):
            break
        found = unit_at(tokens, at + skip)
        is_weight = tokens[at + skip : at + skip + 1] == ["g"] and (
            number.value > MOST_G or number.value.is_integer()
        )
        if found and not (tokens[at + skip] in ("º", "a", "e") and number.value < 10) and not is_weight:
            unit, factor, size = found
            number.value, number.unit = round(number.value * factor, 3 if factor == 1 else 1), unit
            number.spread *= factor
            number.last, number.is_bare, number.factor = at + skip + size - 1, False, factor
            return
    number.value = round(number.value, 2)


def share_units(numbers: list[NumberInText], tokens: list[str]) -> None:
    """Assigns to "40" in "40 to 60 metres" the unit of "60"; works backwards, so that it also handles longer
    lists."""
    is_shared = False
    for one, other in zip(numbers[-2::-1], numbers[:0:-1], strict=False):
        was_shared, is_shared = is_shared, False
        between = tokens[one.last + 1 : other.first]
        while between and between[-1] in ("about", "than", "de", "di", "maximal", "another"):
            between = between[:-1]
        if one.unit or not other.unit or not 1 <= len(between) <= 2 or is_radius(tokens, one):
            continue
        before = tokens[one.first - 1] if one.first > 0 else ""
        if before in SIDES or (before in ONE_TURN and one.value <= LAST_TURN):
            continue  # "L90 - 40 m" is an angle and a length, "turn 2 to 20 m" the second turn
        if any(token not in JOINTS for token in between) or (between == [","] and one.value < LARGEST_SEEN):
            continue
        if len(between) == 2 and between[0] == "," and between[1] not in ("or", "and", "to"):
            continue
        if between == [","] and not was_shared:
            continue  # "radius 40, 5 % up" lists two wishes, "40, 50 and 60 m" three lengths
        one.value, one.unit = round(one.value * other.factor, 1), other.unit
        one.is_bare, one.factor, is_shared = False, other.factor, True


def take_unit_of_all(numbers: list[NumberInText], tokens: list[str]) -> None:
    """Treats numbers without a unit, except counts, as feet or yards if the description says so, as in
    "lengths in feet: 250 straight"."""
    factors = {UNITS.get((unit,), ("", 0.0)) for word, unit in pairwise(tokens) if word in ("in", "en")}
    sizes = [factor for unit, factor in factors if unit == "metres" and factor < 1.0]
    if len(sizes) != 1 or any(number.unit == "metres" for number in numbers):
        return
    for number in numbers:
        is_after_side = number.first > 0 and tokens[number.first - 1] in SIDES
        if number.is_bare and not is_count(tokens, number) and not is_after_side:
            number.value, number.unit = round(number.value * sizes[0], 1), "metres"
            number.is_bare, number.factor = False, sizes[0]


def take_miles_per_hour(numbers: list[NumberInText], tokens: list[str], said: Sequence[str]) -> None:
    """Treats numbers without a unit that are told as speeds, as in "70 in a 55 zone", as miles per hour,
    if the description counts in miles, feet or yards or has words of those who do, and has no metric unit."""
    speeds = {number.factor for number in numbers if number.unit == "kmh"}
    lengths = {number.factor for number in numbers if number.unit == "metres"}
    is_metric = any(factor in (1.0, 3.6) for factor in speeds) or not lengths.isdisjoint((1.0, 1000.0))
    is_in_miles = bool(speeds or lengths) or not IN_MILES.isdisjoint(tokens)
    if is_metric or not is_in_miles:
        return
    was_told = False
    for index, number in enumerate(numbers):
        between = tokens[numbers[index - 1].last + 1 : number.first] if index else []
        goes_on = was_told and between in (["to"], ["-"], ["or"])
        was_told = (
            number.is_bare and not number.unit and number.value in USUAL_SPEEDS
            and (goes_on or _is_told_as_speed(number, tokens, said))
            and not stands_for(tokens, number.first, number.last)
        )  # fmt: skip
        if was_told:
            number.value, number.unit = round(number.value * MILES_PER_HOUR, 1), "kmh"
            number.is_bare, number.factor = False, MILES_PER_HOUR


def _is_told_as_speed(number: NumberInText, tokens: Sequence[str], said: Sequence[str]) -> bool:
    after = [*tokens[number.last + 1 : number.last + 3], "", ""]
    if after[0] in OF_SPEED or (after[0] == "as" and after[1] in ("posted", "allowed")):
        return True
    before = [each for each in tokens[max(number.first - 6, 0) : number.first] if each not in VAGUELY]
    is_clear = not after[0].isalpha() or (after[0] in BEHIND_SPEED and said[number.last + 1].islower())
    if not before or not is_clear or after[0] in ("%", "/", ":"):
        return False
    is_slowing = before[-1] in ("to", "from") and not SLOWING.isdisjoint(before[-4:-1])
    is_in_a = before[-2:] in (["in", "a"], ["in", "the"]) and not after[0].isalpha()
    return before[-1] in SPEEDING or is_slowing or is_in_a


def is_count(tokens: Sequence[str], number: NumberInText) -> bool:
    """Returns True if the number may be a count: whole, not too large, and not a radius."""
    return (
        number.value <= LARGEST_SEEN and number.value == int(number.value) and not is_radius(tokens, number)
    )


def is_radius(tokens: Sequence[str], number: NumberInText) -> bool:
    """Returns True if the number is 10 or more and follows "R" or a word for a radius, as in "R15"."""
    at = number.first - 1
    while at >= 0 and tokens[at] in LEADING_TO:
        at -= 1
    return number.value >= 10 and at >= 0 and (tokens[at] == "r" or tokens[at] in RADIUS)


def as_grade(number: NumberInText, tokens: Sequence[str]) -> None:
    """Converts degrees to percent if the words next to the number show that it is a slope.

    Only a number close to a word for a slope is a slope; "climbs 30 degrees to the left" remains a turn."""
    if number.unit == "degrees" and number.value <= STEEPEST and _is_tilt(number, tokens):
        number.value, number.unit = round(100 * tan(radians(number.value)), 1), "percent"


def _is_tilt(number: NumberInText, tokens: Sequence[str]) -> bool:
    after = [token for token in tokens[number.last + 1 : number.last + 5] if token not in SKIPPED]
    if after and after[0] in SLOPES:
        return not TURNING.intersection(after[1:2])
    if TURNING.intersection(after[:2]):
        return False
    at = number.first - 1
    while at >= 0 and tokens[at] in BETWEEN and number.first - 1 - at < MOST_BETWEEN:
        at -= 1
    if at < 0:
        return False
    # "climb 40 degrees" says too little: it may climb and turn
    return at < number.first - 1 and tokens[at] in SLOPES | SLOPING


FAR = 100
"""A unit of this many metres or more, without a number, means one unit, as in "mile and a half"."""
DENOMINATORS = ("2", "3", "4", "5", "8", "10")
"""What may stand below the stroke of a fraction of a unit: "3/4 mile"."""
SHARE = re.compile(r"0[.,]\d+")
"""A share of a unit in decimals: "0.3 of a mile"."""
GERMAN_HALF = re.compile(r"(ander|\w*?)(?:ein|und|t)?(halb|viertel)(tausend)?")
"""A German number with its fraction in one word: "zweieinhalb", "dreieinviertel"."""
MOST_WORDS = 3
"""The largest number of words that decimals have; a hyphen counts as a word."""


def unit_fraction(tokens: list[str], at: int) -> NumberInText | None:
    """Reads "3/4 mile", "1 1/2 miles" and "0.3 of a mile"."""
    if SHARE.fullmatch(tokens[at]) and tokens[at + 1 : at + 2] == ["of"]:
        return _of_unit(float(tokens[at].replace(",", ".")), tokens, at, at)
    is_number_of_turn = at > 0 and tokens[at - 1] in ONE_TURN | COUNTED
    for first in (at + 1, at + 2) if tokens[at].isdecimal() and not is_number_of_turn else ():
        share = _share(tokens, first)
        is_joined = first == at + 1 or WHOLE_AND.issuperset(tokens[at + 1 : at + 2])
        if share and is_joined and tokens[first + 3 : first + 4] != ["-"]:
            return _of_unit(int(tokens[at]) + share, tokens, at, first + 2)
    share = _share(tokens, at)
    return _of_unit(share, tokens, at, at + 2) if share else None


def _share(tokens: list[str], at: int) -> float | None:
    """Returns the value of a fraction such as "3/4" at this place; None if there is none."""
    above, stroke, below = (*tokens[at : at + 3], "", "", "")[:3]
    is_fraction = stroke == "/" and above.isdecimal() and below in DENOMINATORS
    return int(above) / int(below) if is_fraction else None


def _of_unit(value: float, tokens: list[str], at: int, last: int) -> NumberInText | None:
    """Returns a number from token ``at`` to ``last`` and the words before its unit, a length.

    None if no unit follows, or if it is a fraction of a unit as small as a metre: "turns 3/4 m wide"."""
    while tokens[last + 1 : last + 2] and tokens[last + 1] in SHARE_FILLERS:
        last += 1
    unit = unit_at(tokens, last + 1)
    is_small = unit is not None and unit[1] < FAR and (value < 1 or last - at < 3)
    return (
        None if unit is None or unit[0] != "metres" or is_small else NumberInText(value, at, last, "", False)
    )


def whole_and_share(tokens: list[str], at: int) -> NumberInText | None:
    """Reads "two and a half kilometres", "three and a quarter miles", "zweieinhalb Kilometer" and "one and a
    half thousand metres"."""
    value = _german_half(tokens[at])
    if value is not None:
        return _before_unit(value, tokens, at, at)
    whole = float(tokens[at]) if tokens[at].isdecimal() else float(number_word(tokens[at]))
    whole = 1.0 if tokens[at] in ONES else whole
    if not whole or tokens[at + 1 : at + 2] == [] or tokens[at + 1] not in WHOLE_AND - {"-"}:
        return None
    share, last = _share_in_words(tokens, at + 2)
    return _before_unit(whole + share, tokens, at, last) if share else None


def take_share(number: NumberInText, tokens: list[str]) -> None:
    """Adds to "two kilometres" the half of a kilometre in "two kilometres and a half"."""
    joint = tokens[number.last + 1 : number.last + 2]
    if number.unit != "metres" or number.factor < FAR or not joint or joint[0] not in WHOLE_AND - {"-"}:
        return
    share, last = _share_in_words(tokens, number.last + 2)
    behind = [token for token in tokens[last + 1 :] if token not in SHARE_FILLERS - {"-"}][:1]
    if not share or (behind and (behind[0] in OF_A_CIRCLE | ONE_TURN | COUNTED or unit_at(behind, 0))):
        return
    number.value, number.last = round(number.value + share * number.factor, 1), last


def _share_in_words(tokens: list[str], at: int) -> tuple[float, int]:
    many, place = 1, at
    if tokens[at : at + 1] and (tokens[at] in ONES or number_word(tokens[at]) == 3):  # three quarters
        many, place = (1 if tokens[at] in ONES else 3), at + 1
    share = SHARES.get(tokens[place], 0.0) if place < len(tokens) else 0.0
    return (many * share, place) if many * share < 1 else (0.0, place)


def _german_half(word: str) -> float | None:
    """Returns the value of "zweieinhalb", "anderthalb" or "dreieinhalbtausend"; None for any other word."""
    found = GERMAN_HALF.fullmatch(word)
    if found is None:
        return None
    whole, share, thousand = found.groups()
    many = {"ander": 1, "ein": 1}.get(whole) or number_word(whole)
    if not many or (whole == "ander" and share != "halb"):
        return None
    if share == "viertel" and "ein" not in word.removeprefix(whole):
        value = many / 4 if many == 3 else 0.0  # "dreiviertel" is 3/4
    else:
        value = many + (0.5 if share == "halb" else 0.25)
    return value * (1000 if thousand else 1) or None


def _before_unit(value: float, tokens: list[str], at: int, last: int) -> NumberInText | None:
    """Returns a number from token ``at`` to ``last``, or to "thousand" behind it; None if no unit follows."""
    size = SIZES.get(tokens[last + 1], 1) if tokens[last + 1 : last + 2] else 1
    last += size > 1
    while tokens[last + 1 : last + 2] and tokens[last + 1] in SHARE_FILLERS - {"-"}:
        last += 1
    return NumberInText(value * size, at, last, "", False) if unit_at(tokens, last + 1) else None


def with_decimals(number: NumberInText, tokens: Sequence[str]) -> NumberInText:
    """Returns a number with the decimals that follow in words; unchanged without decimals and a unit."""
    if not number.is_bare or number.unit or number.value != int(number.value):
        return number
    if tokens[number.last + 1 : number.last + 2] == [] or tokens[number.last + 1] not in POINTS:
        return number
    decimals, key = "", tuple[str, ...]()
    last = end = number.last + 1
    for word in tokens[number.last + 2 : number.last + 2 + MOST_WORDS]:
        end += 1
        key += (word,) if word != "-" else ()
        digits = "".join("1" if each in ONES else _decimals_of((each,)) for each in key)
        both = _decimals_of(key)
        if len(both) == 2 or (len(digits) == len(key) > 0):  # "vingt-cinq", or "two five"
            decimals, last = both if len(both) == 2 else digits, end
    if not decimals or unit_at(tokens, last + 1) is None:  # "point one a dip point two a left"
        return number
    return replace(number, value=float(f"{number.value:.0f}.{decimals}"), last=last)


def one_with_decimals(tokens: Sequence[str], at: int) -> NumberInText | None:
    """Reads "one point five" and "due virgola cinque": "one" and "due" are numbers only with decimals."""
    value = 1 if tokens[at] in ONES else number_word(tokens[at])
    found = with_decimals(NumberInText(float(value), at, at), tokens) if value else None
    return found if found is not None and found.last > at else None


def _decimals_of(key: tuple[str, ...]) -> str:
    return str(next(iter(numbers_in_words(key).values()), ""))


PLUS_MINUS = frozenset(tuple(sign.split()) for sign in TABLE["plus_minus"]["signs"].split("|"))
OPENING = frozenset([",", "(", "-"])
LONGEST_SIGN = 4
"""The number of words of the longest expression for "plus or minus", including a bracket before it."""


def tolerances_first(said: Sequence[str]) -> list[str]:
    """Moves a noun behind a tolerance: "five turns, give or take 1" becomes "five, give or take 1 turns"."""
    words = [*said]
    tokens = [plain(word) for word in words]
    for at in range(1, len(words) - 2):
        if tokens[at] not in COUNTED:
            continue
        for last in range(at + 2, min(at + 2 + LONGEST_SIGN, len(words))):
            if _is_tolerance(tokens[at + 1 : last]) and _is_count(tokens, last):
                last += "(" in tokens[at:last] and tokens[last + 1 : last + 2] == [")"]
                words[at : last + 1] = [*words[at + 1 : last + 1], words[at]]
                return words
    return words


def _is_count(tokens: Sequence[str], at: int) -> bool:
    token = tokens[at]
    return (token.isdecimal() or token in ONES or numbers_in_words((token,)) != {}) and not unit_at(
        tokens, at + 1
    )


def with_tolerances(numbers: Sequence[NumberInText], tokens: Sequence[str]) -> list[NumberInText]:
    """Removes the numbers that are tolerances; the number that has the tolerance keeps it as ``spread``."""
    out: list[NumberInText] = []
    for number in numbers:
        if out and _is_tolerance(tokens[out[-1].last + 1 : number.first]) and number.value < out[-1].value:
            _take(out[-1], number, tokens)
        else:
            out.append(number)
    for number in out:
        _take_one(number, tokens)
    return out


def _take_one(number: NumberInText, tokens: Sequence[str]) -> None:
    """Sets the tolerance of a count to 1 if the text gives the tolerance as a word such as "one" or "eine".

    Such words are not read as numbers elsewhere, since they are mostly articles."""
    if not (number.is_bare and is_count(tokens, number)) or number.spread:
        return
    for place in range(number.last + 1, min(number.last + 2 + LONGEST_SIGN, len(tokens))):
        if tokens[place] in ONES and _is_tolerance(tokens[number.last + 1 : place]):
            number.spread, number.last = 1, place
            return


def _is_tolerance(between: Sequence[str]) -> bool:
    words = [*between]
    while words and words[0] in OPENING:
        words = words[1:]
    return tuple(words) in PLUS_MINUS


def _take(number: NumberInText, tolerance: NumberInText, tokens: Sequence[str]) -> None:
    both_counts = number.is_bare and tolerance.is_bare and is_count(tokens, number)
    if number.is_bare and tolerance.unit in ("metres", "degrees"):
        number.value = round(number.value * tolerance.factor, 1)
        number.unit, number.is_bare = tolerance.unit, False
    if not both_counts:
        number.spread = _in_unit_of(number, tolerance)
    elif tolerance.value == int(tolerance.value):
        number.spread = tolerance.value
    is_open = "(" in tokens[number.last + 1 : tolerance.first]
    closes = tolerance.last + 1 < len(tokens) and tokens[tolerance.last + 1] == ")"
    number.last = tolerance.last + (is_open and closes)


def _in_unit_of(number: NumberInText, tolerance: NumberInText) -> float:
    """Returns the tolerance of a measure in the unit of its value; a percentage of a length is one of it."""
    if tolerance.unit == number.unit:
        return tolerance.value
    if tolerance.unit == "percent":
        return number.value * tolerance.value / 100
    return tolerance.value * number.factor if tolerance.is_bare else 0


SLOTS = 12
"""The largest number of slots in one description; the values of further numbers are lost."""
SYMBOLS = str.maketrans({
    "–": "-", "—": "-", "−": "-", "’": "'", "‘": "'", "“": '"', "”": '"', "×": "x",
    "→": " then ", "½": " 0.5 ", "¼": " 0.25 ", "¾": " 0.75 ", "⅓": " 1/3 ", "⅔": " 2/3 ", "⁄": "/",
    "≥": ">", "≤": "<", "…": ".", "\u00a0": " ", "+": " + ", ">": " > ", "<": " < ",
})  # fmt: skip
WORD = re.compile(r"\d+(?:[.,]\d+)*|[^\W\d_]+|[^\w\s]|_")
CHANGE = "[unused13]"
"""The token in front of a change request, which tells the model that the text is not a description."""
MIXED = re.compile(r"(\d)([½¼¾])")
"""A whole number with a fraction behind it, as in "1½"."""
ORDINAL_SIGN = re.compile(r"(?<=\d)(?:e|\.?ª)(?!\w)")
"""Letters that make an ordinal of the number before them: "4e" in French, "4ª" in Spanish and Italian."""
BARE_POINT = re.compile(r"(?<![\w.])\.(?=\d)")
MILLION = 1e6


@dataclass(frozen=True, slots=True)
class Word:
    """A word of a description: ``text`` is what the model reads, ``written`` the original spelling."""

    text: str
    written: str


@dataclass(frozen=True, slots=True)
class NumberSlot:
    """A number that a slot stands for.

    The value is in metres, degrees, percent, km/h or m/s2, as it is told, or converted and rounded to one
    decimal; ``unit`` is empty if the text gives no unit, and the value has two decimals then."""

    value: float
    unit: Unit


@dataclass(frozen=True, slots=True)
class SlottedText:
    """A description whose numbers have been replaced by slots."""

    words: tuple[Word, ...]
    slots: tuple[NumberSlot, ...]

    @property
    def text(self) -> str:
        """The words as the model reads them, joined by spaces."""
        return " ".join(word.text for word in self.words)

    @property
    def is_change(self) -> bool:
        """Whether the text is a change request."""
        return self.words[:1] == (Word(CHANGE, ""),)


def slotted(text: str, is_change: bool = False) -> SlottedText:
    """Returns the text with its numbers replaced by slots; a change request gets CHANGE as its first word."""
    text = ORDINAL_SIGN.sub("eme", MIXED.sub(_sum, with_plain_numbers(text)))
    said = tolerances_first(WORD.findall(BARE_POINT.sub("0.", text.translate(SYMBOLS))))
    tokens = _with_miles([plain(word) for word in said])
    numbers = _numbers(tokens)
    for number in numbers:
        take_unit(number, tokens)
        take_share(number, tokens)
    numbers = [each for n, each in enumerate(numbers) if not n or each.first > numbers[n - 1].last]
    share_units(numbers, tokens)
    take_unit_of_all(numbers, tokens)
    if not is_change:
        take_miles_per_hour(numbers, tokens, said)
    numbers = with_tolerances(numbers, tokens)
    for number in numbers:
        as_grade(number, tokens)
    found = _replaced(tokens, said, numbers, is_change)
    return SlottedText((Word(CHANGE, ""), *found.words), found.slots) if is_change else found


def _sum(mixed: re.Match[str]) -> str:
    """Returns "1.5" for "1½"."""
    return mixed[1] + SYMBOLS[ord(mixed[2])].strip().removeprefix("0")


def slot_name(index: int) -> str:
    """Returns the token for the slot with this index (from 0): one of BERT's unused vocabulary entries."""
    return f"[unused{index + 1}]"


def _numbers(tokens: list[str]) -> list[NumberInText]:
    language = language_of(tokens)
    numbers: list[NumberInText] = []
    at = 0
    while at < len(tokens):
        number = (
            unit_fraction(tokens, at) or whole_and_share(tokens, at) or _ratio(tokens, at, language)
            or _millions(tokens, at) or _part(tokens, at) or _digits(tokens, at) or _set(tokens, at)
            or _spelled(tokens, at, language) or one_with_decimals(tokens, at)
        )  # fmt: skip
        if number:
            number = with_decimals(number, tokens)
            numbers.append(number)
            at = number.last
        at += 1
    return numbers


def _with_miles(tokens: list[str]) -> list[str]:
    """Returns the tokens with "mile" for "mi" behind a number of an English text; in others it is a word."""
    if "mi" not in tokens or language_of(tokens) != "en" or FUNCTION_WORDS["en"].isdisjoint(tokens):
        return tokens
    beside = zip(["", *tokens], [*tokens[1:], ""], strict=False)
    return [
        "mile" if word == "mi" and before[:1].isdigit() and after != "-" else word
        for word, (before, after) in zip(tokens, beside, strict=False)
    ]


def _ratio(tokens: list[str], at: int, language: str) -> NumberInText | None:
    """Reads "one in ten" and "1:8" as percent."""
    places = [place for place in range(at, min(at + 5, len(tokens))) if tokens[place] != "-"][:3]
    here = [tokens[place] for place in places]
    if len(here) < 3 or here[0] not in {"1", *ONES} - {"a", "an"} or here[1] not in RATIO:
        return None
    spelled = _spelled(tokens, places[2], language)  # the whole of "fifty-five"
    below, last = (spelled.value, spelled.last) if spelled else (_digit_value(here[2]) or 0.0, places[2])
    if not 3 <= below <= 100 or unit_at(tokens, last + 1):
        return None
    return NumberInText(round(100 / below, 1), at, last, "percent", False)


def _millions(tokens: list[str], at: int) -> NumberInText | None:
    """Reads "a million", "two billion" and the like as one million, which is too many for any road."""
    if tokens[at] in MILLIONS:
        return NumberInText(MILLION, at, at)
    is_number = tokens[at] in ONES or tokens[at].isdecimal() or number_word(tokens[at]) > 0
    is_many = is_number and not MILLIONS.isdisjoint(tokens[at + 1 : at + 2])
    return NumberInText(MILLION, at, at + 1) if is_many else None


def _digit_value(token: str) -> float | None:
    if not token[0].isdecimal():
        return None
    parts = token.replace(",", ".").split(".")
    return float(".".join(parts[:2]))


def _digits(tokens: list[str], at: int) -> NumberInText | None:
    value = _digit_value(tokens[at])
    if value is None:
        return _point(tokens, at)
    after = tokens[at + 1 : at + 3]
    if value < 10 and len(after) == 2 and after[0] == "/" and after[1] in ("2", "3", "4"):
        return None  # a share of the road, which a plan cannot express
    size = SIZES.get(after[0], 0) if after and after[1:] != ["marin"] else 0
    is_clear = bool(after) and (after[0] in ("hundred", "thousand") or unit_at(tokens, at + 2) is not None)
    if is_clear and value * size <= MILLION and value < size:
        return NumberInText(round(value * size, 1), at, at + 1)
    return NumberInText(value, at, at)


def _point(tokens: list[str], at: int) -> NumberInText | None:
    """Reads "point two" as 0.2."""
    if tokens[at] != "point" or at + 1 >= len(tokens):
        return None
    tenths = number_word(tokens[at + 1])
    return NumberInText(tenths / 10, at, at + 1) if 0 < tenths < 10 else None


def _set(tokens: list[str], at: int) -> NumberInText | None:
    """Reads "half a dozen", "a few hundred metres" and the like, with or without hyphens."""
    best: NumberInText | None = None
    key: list[str] = []
    for place in range(at, min(at + 6, len(tokens))):
        if tokens[place] == "-" and key:
            continue
        key.append(tokens[place])
        if tuple(key) in SETS:
            best = NumberInText(SETS[tuple(key)], at, place)
        if tuple(key) in VAGUE_SETS and unit_at(tokens, place + 1):
            least, most = VAGUE_SETS[tuple(key)]
            best = NumberInText((least + most) / 2, at, place, spread=(most - least) / 2)
    return best


def _part(tokens: list[str], at: int) -> NumberInText | None:
    """Reads "half a mile", "three quarters of a kilometre", "one and a half miles", if a unit follows."""
    many = _digit_value(tokens[at]) or number_word(tokens[at])
    many = 1.0 if tokens[at] in ONES else many
    share_at = at + 1 if many else at
    while share_at < len(tokens) and tokens[share_at] == "-" and share_at > at:
        share_at += 1
    share = SHARES.get(tokens[share_at]) if share_at < len(tokens) else None
    last = share_at if share else at
    while last + 1 < len(tokens) and tokens[last + 1] in SHARE_FILLERS and last - at < 6:
        last += 1
    found = unit_at(tokens, last + 1)
    place = at + (tokens[at] in ONES)
    unit = None if share else unit_at(tokens, place)
    if unit and unit[1] >= FAR and tokens[place + 1 : place + 4] == ["and", "a", "half"]:
        return NumberInText(round(1.5 * unit[1], 1), at, place + 3, "metres", False)
    if not found or (not share and many != 1):
        return None
    if not share and (found[0] != "metres" or (found[1] < 100 and tokens[at] in ("a", "an", "un", "una"))):
        return None
    return NumberInText(many * share if share and many else share or 1.0, at, last, "", False)


def _spelled(tokens: list[str], at: int, language: str) -> NumberInText | None:
    """Reads the longest number word at this place, with or without hyphens."""
    if not begins_number(tokens[at]):
        return None
    best: NumberInText | None = None
    key: list[str] = []
    place = at
    while place < len(tokens) and len(key) < LONGEST:
        if tokens[place] == "-" and key:
            place += 1
            continue
        if not tokens[place].isalpha():
            break
        key.append(tokens[place])
        found = numbers_in_words(tuple(key))
        is_doubtful = key[0] in AMBIGUOUS and len(key) == 1 and unit_at(tokens, place + 1) is None
        is_part = len(key) > 1 and next((each for each in tokens[place + 1 :] if each != "-"), "") in SIZES
        if found and (language in found or not is_doubtful) and not is_part:
            best = NumberInText(found.get(language, next(iter(found.values()))), at, place)
        place += 1
    if best and best.value == 0 and tokens[at] == "null" and language != "de":
        return None
    return best


def _replaced(
    tokens: list[str], said: list[str], numbers: list[NumberInText], is_change: bool
) -> SlottedText:
    out: list[Word] = []
    slots: list[NumberSlot] = []
    starts = {number.first: number for number in numbers}
    at = 0
    while at < len(tokens):
        number = starts.get(at)
        if number is None:
            out.append(Word(tokens[at], said[at]))
            at += 1
            continue
        aside = stands_for(tokens, number.first, number.last) if number.is_bare else ""
        if aside:
            out.append(Word(aside, ""))
            at = number.last + 1
            continue
        spoken = " ".join(said[number.first : number.last + 1])
        is_figure = number.is_bare and number.first == number.last and tokens[at].isdigit()
        after = "".join(tokens[number.last + 1 : number.last + 2])
        if is_figure and number.value < 13 and after in ORDINALS - {"a", "o", "e"}:
            out.append(Word(tokens[at] + after, spoken + said[number.last + 1]))
            at = number.last + 2
            continue
        if number.is_bare and is_count(tokens, number):
            out += _count(number, spoken)
        else:
            out += _measure(number, spoken, slots, is_change)
        at = number.last + 1
    return SlottedText(tuple(out), tuple(slots))


def _measure(number: NumberInText, spoken: str, slots: list[NumberSlot], is_change: bool) -> list[Word]:
    """Returns the words for a measure and adds its slot to ``slots``; one with a tolerance becomes a range.

    In a change request the tolerance is left out, because a change has one target."""
    has_range = 0 < number.spread < number.value and not is_change
    ends = (-number.spread, number.spread) if has_range else (0.0,)
    if len(slots) + len(ends) > SLOTS:
        return [Word("[unused20]", spoken)]
    out: list[Word] = []
    for end in ends:
        value = round(number.value + end, 2 if not number.unit else 3 if number.factor == 1 else 1)
        out += [Word("to", "")] if out else []
        out.append(Word(slot_name(len(slots)), spoken))
        slots.append(NumberSlot(value, number.unit))
        out += [Word(text, "") for text in _tail(value, number.unit)]
        spoken = ""
    return out


def _count(number: NumberInText, spoken: str) -> list[Word]:
    """Returns a small number without a unit as digits; with a tolerance, as a range such as "3 to 5"."""
    value, spread = int(number.value), int(number.spread)
    if not spread:
        return [Word(str(value), spoken)]
    return [Word(str(max(value - spread, 0)), spoken), Word("to", ""), Word(str(value + spread), spoken)]


def _tail(value: float, unit: Unit) -> list[str]:
    """Returns the unit, and a mark if the size of the number matters for what the words mean."""
    marks = {
        "percent": ((15.0, "[unused21]"),),
        "metres": ((1500.0, "[unused21]"),),
        "degrees": ((210.0, "[unused21]"), (99.9, "[unused24]")),
    }  # fmt: skip
    tail: list[str] = [unit] if unit else []
    tail += [mark for limit, mark in marks.get(unit, ()) if value > limit][:1]
    if unit == "metres" and value < 20:
        tail.append("[unused22]" if value < 15 else "[unused23]")
    if unit == "degrees" and value < 15:
        tail.append("[unused22]")
    return tail


PERSON = pattern_of("person")
"""The end of a word for a person, whose age follows in brackets."""
AGES, MONTHS, ROUTES, DAY = (word_set(name) for name in ("ages", "months", "numbered_routes", "time_of_day"))
DATE = re.compile(r"(?=.*\d{4})\d{1,4}([-/.])\d{1,4}\1\d{1,4}")
YEARS = range(1950, 2036)
ROUND_YEAR = 2000  # more often metres than a year
PREFIXES = (["i"], ["us"], ["sr"], ["cr"])
LARGE = 20
"""A number behind "route" that is not larger may count something: "a route, 3 turns"."""
NEAR = 5
"""How many words before and behind a number are looked at."""


def stands_for(tokens: Sequence[str], first: int, last: int) -> str:
    """Returns the word for a number without a unit that is set aside, from one word to another; empty if the
    number is of the road or may be."""
    said = tokens[first]
    before = [each for each in tokens[max(first - NEAR, 0) : first] if each not in "-.,"]
    after = [each for each in tokens[last + 1 : last + 1 + NEAR] if each not in "-.,'"]
    if first != last or not said[0].isdecimal():
        return "age" if AGES.intersection(after[:1]) and _is_age(after) else ""
    if before[-1:] == ["aged"] or (AGES.intersection(after[:1]) and _is_age(after)):
        return "age"
    brackets = [*tokens[first - 1 : first], *tokens[last + 1 : last + 2]] if first > 1 else []
    if brackets == ["(", ")"] and PERSON.search(tokens[first - 2]):
        return "age"
    if not MONTHS.isdisjoint([*before[-1:], *after[:1]]) or _is_of_date(tokens, first):
        return "date"
    if _is_clock(tokens, first) or not DAY.isdisjoint(after[:1]):
        return "time"
    if said.isdecimal() and len(said) == 4 and int(said) in YEARS and int(said) != ROUND_YEAR:
        return "year"
    if not said.isdecimal():
        return ""
    if said[0] == "0" and len(said) > 1:
        return "number"
    is_named = before[-1:] in PREFIXES and tokens[first - 1] == "-"
    is_alone = tokens[last + 1 : last + 2] == [] or not tokens[last + 1].isalpha() or int(said) > LARGE
    return "number" if is_named or (not ROUTES.isdisjoint(before[-1:]) and is_alone) else ""


def _is_age(after: Sequence[str]) -> bool:
    is_of_years = after[0] in ("year", "years", "jahre", "anos", "anni")
    return not is_of_years or after[1:2] in (["old"], ["alt"])


def _is_clock(tokens: Sequence[str], at: int) -> bool:
    """Returns whether a number is one of the two of a time such as "18:40"."""
    hour, minute = (at, at + 2) if tokens[at + 1 : at + 2] == [":"] else (at - 2, at)
    if hour < 0 or minute >= len(tokens) or tokens[hour + 1] != ":":
        return False
    both = tokens[hour], tokens[minute]
    is_minute = both[1].isdecimal() and len(both[1]) == 2 and int(both[1]) < 60
    return is_minute and both[0].isdecimal() and int(both[0]) < 25


def _is_of_date(tokens: Sequence[str], at: int) -> bool:
    """Returns whether a number is one of three of a date such as "12/05/2012" or "2012-05-12"."""
    dates = ("".join(tokens[first : first + 5]) for first in (at, at - 2, at - 4) if first >= 0)
    return any(map(DATE.fullmatch, dates))
