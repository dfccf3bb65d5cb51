"""Numbers that a text gives relative to its other numbers: sums and multiples of slots in a plan.

In "a straight of 40 m, a bend, and a straight twice as long", the network writes ``len= [1] x 2`` for the
last straight; in "each 15 degrees more than the one before", it writes ``deg= [1] + [2] x 2`` for the third
turn.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations

from roadgpt.brief.readers.model.slots import NumberSlot

FACTORS = ("2", "0.5", "3", "1.5", "0.333", "4", "0.25", "0.75", "0.667", "2.5", "1.333", "1.25")
"""The factors of one slot, the usual ones first."""
KEYS = frozenset(["deg=", "r=", "len=", "pct=", "climb="])
"""The keys of plans whose numbers may be computed."""
ONE = frozenset(["pct=", "climb="])
"""The keys of numbers that may differ by 1 from another number without a figure: "a percent steeper"."""
STEPS = ("2", "3", "4", "5", "6", "7", "8")
"""How often a difference can be added or subtracted, if more than once."""
SIGNS = ("+", "-")
MULTIPLE = re.compile(
    r"\b(?:"
    r"twice|thrice|doubl|tripl|quadrupl|half|halv|third|quarter|times|fold\b"
    r"|as (?:much|far|long|large|big)|\w*halb|haelfte|halft|doppelt|zweimal|dreimal|viermal"
    r"|\w+fach|mal\b|drittel|viertel|anderthalb|nochmal|fois|moiti|demi|tiers|quart|mitad"
    r"|medi[oa]|dobl|veces|tercer|terci|cuart|doppi|divis|dimezz|meta\b|mezz|volte|terz"
    r")"
)
"""Words that can give a number as a multiple of another number, in texts without accents."""
DIFFERENCE = re.compile(
    r"[+=]|\b(?:"
    r"more|less|fewer|further|farther|add|plus|minus|off|each|every|step|increas|decreas|grow"
    r"|shrink|drop|gain|by|than|next|together|sum|both|on top|extra"
    r"|(?:long|short|wid|tight|larg|small|bigg|steep|gentl|flatt|high|low|sharp|great|strong)er"
    r"|mehr|weniger|jede|je\b|jeweils|zunehm|abnehm|wachs|dazu|zusatzlich|ansteig|aufsteig"
    r"|schritt|um\b|als|zusammen"
    r"|(?:lang|kurz|eng|weit|gross|klein|steil|flach|hoh|nied\w*|sanft|scharf|stark|schwach)er\w*"
    r"|moins|chaque|augment|diminu|croi|ajout|ensemble|reuni|somme|mas|menos|cada|aument"
    r"|disminu|crec|junt|piu|meno|ogni|ciascun|cresc|diminui|aggiung|insieme|cale|cala|punt"
    r"|scend|partir|bout"
    r")"
)
"""Words that can give a number by its difference from another number, in texts without accents."""
SHAPE = re.compile(
    r"(?:"
    r"right.angle|square|quarter|half.(?:circle|turn)|viertelkreis|cuarto de|quart de"
    r"|quarto di|recht\w* wink|rechtwink|halbkreis|angles? droits?|equerre"
    r"|demi.(?:cercle|tour)|angul\w+ rect|semic|media vuelta|angol\w rett|mezzo giro"
    r")"
)
"""Words for an angle of 90 or 180 degrees."""
ROUND = ("90", "180")
DIGITS = re.compile(r"(?<![\w.])\d+(?![\w.])")


@dataclass(frozen=True, slots=True)
class Compared:
    """Whether a text may give numbers relative to other numbers: by a factor, or by a difference."""

    by_factor: bool = False
    by_difference: bool = False
    plain: frozenset[str] = frozenset()
    """Numbers that the text has without a unit, or as a word for an angle; they are not computed."""

    @classmethod
    def of(cls, text: str) -> "Compared":
        """Returns what the words of a text allow; the text must be in lower case and without accents."""
        plain = frozenset([*DIGITS.findall(text), *(ROUND if SHAPE.search(text) else ())])
        return cls(MULTIPLE.search(text) is not None, DIFFERENCE.search(text) is not None, plain)


def computed(
    value: float, said: Sequence[str], slots: Sequence[NumberSlot], compared: Compared
) -> list[str] | None:
    """Returns the tokens for a value that is computed from numbers of the text; None if there is no way.

    ``said`` has the tokens of these numbers, the likelier ones first. Multiples are preferred to sums.
    """
    ways: list[Iterator[tuple[float, list[str]]]] = []
    if compared.by_factor:
        ways.append(_multiples(said, slots))
    if compared.by_difference:
        ways.append(_sums(said, slots))
    return next((tokens for way in ways for made, tokens in way if abs(made - value) < 0.051), None)


def _multiples(said: Sequence[str], slots: Sequence[NumberSlot]) -> Iterator[tuple[float, list[str]]]:
    for factor in FACTORS:
        for base in said:
            yield round(value_of(base, slots) * _exact(factor), 1), [base, "x", factor]


def _sums(said: Sequence[str], slots: Sequence[NumberSlot]) -> Iterator[tuple[float, list[str]]]:
    for times in ("", *STEPS):
        for base, step in permutations(said, 2):
            for sign in SIGNS:
                change = value_of(step, slots) * float(times or 1) * (1 if sign == "+" else -1)
                more = ["x", times] if times else []
                yield value_of(base, slots) + change, [base, sign, step, *more]


def with_values(tokens: Iterable[str], slots: Sequence[NumberSlot]) -> list[str]:
    """Returns the tokens of a plan, with the value in place of each sum and each multiple of slots."""
    rest = list(tokens)
    out: list[str] = []
    at, is_amount = 0, False
    while at < len(rest):
        made = _value_at(rest, at, slots) if is_amount else None
        goes_on = is_amount and (rest[at] in ("..", "-") or _is_number(rest[at], slots))
        is_amount = rest[at] in KEYS or goes_on
        out.append(rest[at] if made is None else f"{made[0]:.1f}".removesuffix(".0"))
        at = at + 1 if made is None else made[1]
    return out


def _value_at(tokens: Sequence[str], at: int, slots: Sequence[NumberSlot]) -> tuple[float, int] | None:
    """Returns the value of the sum or multiple that begins at a token, and the index behind it."""
    behind = tokens[at + 1 : at + 3]
    if len(behind) < 2 or not _is_number(tokens[at], slots):
        return None
    base, (sign, other) = value_of(tokens[at], slots), behind
    if sign == "x":
        return base * _exact(other), at + 3
    if sign not in SIGNS or not _is_number(other, slots):
        return None
    is_repeated = tokens[at + 3 : at + 4] == ["x"] and at + 4 < len(tokens)
    times = float(tokens[at + 4]) if is_repeated else 1.0
    return base + times * value_of(other, slots) * (1 if sign == "+" else -1), at + (5 if is_repeated else 3)


def _is_number(token: str, slots: Sequence[NumberSlot]) -> bool:
    return token.isdecimal() or (token[:1] == "[" and int(token[1:-1]) <= len(slots))


def value_of(token: str, slots: Sequence[NumberSlot]) -> float:
    """Returns the value of a number or a slot, such as "[1]", in a plan."""
    return float(token) if token.isdecimal() else slots[int(token[1:-1]) - 1].value


def _exact(factor: str) -> float:
    """Returns the factor of a token; "0.333" is a third."""
    return round(float(factor) * 12) / 12
