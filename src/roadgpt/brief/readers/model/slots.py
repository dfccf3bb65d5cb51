"""Replaces the numbers in a description by slots before the model reads it, so that the model only copies
slots.

    "three bends in 300 ft at 1:8"  ->  3 bends in [1] metres at [2] percent        [1] = 91.4, [2] = 12.5

Small numbers without a unit remain digits, because the model must know the counts ("4 turns, the first two
uphill"). Every other number becomes a slot: a token whose value is stored separately, in metres, degrees or
percent.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from roadgpt.brief.readers.model.measures import (
    Number,
    as_grade,
    is_count,
    share_units,
    take_unit,
    take_unit_of_all,
    unit_at,
)
from roadgpt.brief.readers.model.numerals import (
    LONGEST,
    SIZES,
    begins_number,
    number_word,
    numbers_in_words,
    plain,
)
from roadgpt.brief.readers.model.tolerances import tolerances_first, with_tolerances
from roadgpt.brief.readers.model.unit_fractions import (
    FAR,
    one_with_decimals,
    take_share,
    unit_fraction,
    whole_and_share,
    with_decimals,
)
from roadgpt.brief.readers.model.units import (
    AMBIGUOUS,
    FUNCTION_WORDS,
    MILLIONS,
    ONES,
    ORDINALS,
    RATIO,
    SETS,
    SHARE_FILLERS,
    SHARES,
    VAGUE_SETS,
    Unit,
)

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
THOUSANDS = re.compile(r"[1-9]\d{0,2}[.,]\d{3}")


@dataclass(frozen=True, slots=True)
class Word:
    """A word of a description: ``text`` is what the model reads, ``written`` the original spelling."""

    text: str
    written: str


@dataclass(frozen=True, slots=True)
class NumberSlot:
    """A number that a slot stands for.

    The value is in metres, degrees or percent, rounded to one decimal; ``unit`` is empty if the text gives no
    unit. A speed has the unit "kmh" and the value that the text gives, even in miles per hour.
    """

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
    text = ORDINAL_SIGN.sub("eme", MIXED.sub(_sum, text))
    said = tolerances_first(WORD.findall(BARE_POINT.sub("0.", text.translate(SYMBOLS))))
    tokens = _with_miles([plain(word) for word in said])
    numbers = _numbers(tokens)
    for number in numbers:
        take_unit(number, tokens)
        take_share(number, tokens)
    numbers = [each for n, each in enumerate(numbers) if not n or each.first > numbers[n - 1].last]
    share_units(numbers, tokens)
    take_unit_of_all(numbers, tokens)
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


def language_of(tokens: Sequence[str]) -> str:
    """Returns the code, such as "de", of the language with the most function words in the text.

    If several languages have the most, English ("en") is preferred, then the first in ``FUNCTION_WORDS``.
    """
    found = set(tokens)
    return max(FUNCTION_WORDS, key=lambda code: (len(found & FUNCTION_WORDS[code]), code == "en"))


def _numbers(tokens: list[str]) -> list[Number]:
    language = language_of(tokens)
    numbers: list[Number] = []
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


def _ratio(tokens: list[str], at: int, language: str) -> Number | None:
    """Reads "one in ten" and "1:8" as percent."""
    places = [place for place in range(at, min(at + 5, len(tokens))) if tokens[place] != "-"][:3]
    here = [tokens[place] for place in places]
    if len(here) < 3 or here[0] not in {"1", *ONES} - {"a", "an"} or here[1] not in RATIO:
        return None
    spelled = _spelled(tokens, places[2], language)  # the whole of "fifty-five"
    below, last = (spelled.value, spelled.last) if spelled else (_digit_value(here[2]) or 0.0, places[2])
    if not 3 <= below <= 100 or unit_at(tokens, last + 1):
        return None
    return Number(round(100 / below, 1), at, last, "percent", False)


def _millions(tokens: list[str], at: int) -> Number | None:
    """Reads "a million", "two billion" and the like as one million, which is too many for any road."""
    if tokens[at] in MILLIONS:
        return Number(MILLION, at, at)
    is_number = tokens[at] in ONES or tokens[at].isdecimal() or number_word(tokens[at]) > 0
    is_many = is_number and not MILLIONS.isdisjoint(tokens[at + 1 : at + 2])
    return Number(MILLION, at, at + 1) if is_many else None


def _digit_value(token: str) -> float | None:
    if not token[0].isdecimal():
        return None
    if THOUSANDS.fullmatch(token):
        return float(re.sub(r"\D", "", token))
    parts = token.replace(",", ".").split(".")
    return float(".".join(parts[:2]))


def _digits(tokens: list[str], at: int) -> Number | None:
    value = _digit_value(tokens[at])
    if value is None:
        return _point(tokens, at)
    after = tokens[at + 1 : at + 3]
    if len(after) == 2 and value < 10 and _is_fraction(tokens, at):
        return None
    size = SIZES.get(after[0], 0) if after and after[1:] != ["marin"] else 0
    is_clear = bool(after) and (after[0] in ("hundred", "thousand") or unit_at(tokens, at + 2) is not None)
    if is_clear and value * size <= MILLION and value < size:
        return Number(round(value * size, 1), at, at + 1)
    return Number(value, at, at)


def _point(tokens: list[str], at: int) -> Number | None:
    """Reads "point two" as 0.2."""
    if tokens[at] != "point" or at + 1 >= len(tokens):
        return None
    tenths = number_word(tokens[at + 1])
    return Number(tenths / 10, at, at + 1) if 0 < tenths < 10 else None


def _is_fraction(tokens: list[str], at: int) -> bool:
    """True for "2 / 3" and "1/2": shares of the road, which a plan cannot express."""
    return tokens[at + 1] == "/" and tokens[at + 2] in ("2", "3", "4")


def _set(tokens: list[str], at: int) -> Number | None:
    """Reads "half a dozen", "a few hundred metres" and the like, with or without hyphens."""
    best: Number | None = None
    key: list[str] = []
    for place in range(at, min(at + 6, len(tokens))):
        if tokens[place] == "-" and key:
            continue
        key.append(tokens[place])
        if tuple(key) in SETS:
            best = Number(SETS[tuple(key)], at, place)
        if tuple(key) in VAGUE_SETS and unit_at(tokens, place + 1):
            least, most = VAGUE_SETS[tuple(key)]
            best = Number((least + most) / 2, at, place, spread=(most - least) / 2)
    return best


def _part(tokens: list[str], at: int) -> Number | None:
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
        return Number(round(1.5 * unit[1], 1), at, place + 3, "metres", False)
    if not found or (not share and many != 1):
        return None
    if not share and (found[0] != "metres" or (found[1] < 100 and tokens[at] in ("a", "an", "un", "una"))):
        return None
    return Number(many * share if share and many else share or 1.0, at, last, "", False)


def _spelled(tokens: list[str], at: int, language: str) -> Number | None:
    """Reads the longest number word at this place, with or without hyphens."""
    if not begins_number(tokens[at]):
        return None
    best: Number | None = None
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
            best = Number(found.get(language, next(iter(found.values()))), at, place)
        place += 1
    if best and best.value == 0 and tokens[at] == "null" and language != "de":
        return None
    return best


def _replaced(tokens: list[str], said: list[str], numbers: list[Number], is_change: bool) -> SlottedText:
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


def _measure(number: Number, spoken: str, slots: list[NumberSlot], is_change: bool) -> list[Word]:
    """Returns the words for a measure and adds its slot to ``slots``; one with a tolerance becomes a range.

    In a change request the tolerance is left out, because a change has one target.
    """
    has_range = 0 < number.spread < number.value and not is_change
    ends = (-number.spread, number.spread) if has_range else (0.0,)
    if len(slots) + len(ends) > SLOTS:
        return [Word("[unused20]", spoken)]
    out: list[Word] = []
    for end in ends:
        value = round(number.value + end, 1)
        out += [Word("to", "")] if out else []
        out.append(Word(slot_name(len(slots)), spoken))
        slots.append(NumberSlot(value, number.unit))
        out += [Word(text, "") for text in _tail(value, number.unit)]
        spoken = ""
    return out


def _count(number: Number, spoken: str) -> list[Word]:
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
