"""The tokens that the model writes: plans split into words, with slots in place of measured numbers.

turn x3 left; straight len=91.4 | up        ->  turn x 3 left ; straight len= [1] | up"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from roadgpt.brief.amount import figure
from roadgpt.brief.languages import pattern_of
from roadgpt.brief.plan import SCENE
from roadgpt.brief.readers.model.slots import LARGEST_SEEN, SLOTS, NumberSlot
from roadgpt.language.table import MANEUVERS, PARTS, ROADS, WEATHER, named_in
from roadgpt.language.table import NUMBERS as NUMBERS_OF_SCENES
from roadgpt.reading import read_text

MULTIPLES = ("2", "0.5", "3", "1.5", "0.333", "4", "0.25", "0.75", "0.667", "2.5", "1.333", "1.25")
"""The factors of one slot, the usual ones first."""
KEYS = frozenset(f"{part.key}=" for part in PARTS["clause"].values() if part.key)
"""The keys of plans whose numbers may be computed."""
ONE = frozenset(["pct=", "climb="])
"""The keys of numbers that may differ by 1 from another number without a figure: "a percent steeper"."""
STEPS = ("2", "3", "4", "5", "6", "7", "8")
"""How often a difference can be added or subtracted, if more than once."""
SIGNS = ("+", "-")
MULTIPLE, DIFFERENCE, SHAPE = map(pattern_of, ("multiple", "difference", "shape"))
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
        return base * exact_factor(other), at + 3
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


def exact_factor(factor: str) -> float:
    """Returns the factor of a token; "0.333" is a third."""
    return round(float(factor) * 12) / 12


REFUSALS = ("!nonsense", "!contradiction", "!impossible", "!unclear")
KINDS: tuple[str, ...] = named_in("features")
SLOPES: tuple[str, ...] = named_in("slopes")
FIXED = ("15", "30", "45", "60", "90", "120", "135", "180")
"""Angles in degrees that words imply without naming them: a kink, a dog-leg, a right angle."""
NUMBERS = [*map(str, range(LARGEST_SEEN + 1)), *(each for each in FIXED if int(each) > LARGEST_SEEN)]
ROUNDABOUT = "roundabout"
WISHES = ":"
"""The token before wishes for a road that stand apart from its shape, in the tokens of a description."""
RAINS = {"drizzle": "rain ..2.5", "downpour": "rain 7.6.."}
"""Tokens of rains that words tell without a number, with what stands in plans."""
SLOT_TOKENS = [f"[{index + 1}]" for index in range(SLOTS)]
NOUNS, MEASURED = named_in("nouns"), ROADS["measures"]
"""The properties to which a change can give a value, with the unit of the value."""
ORDER = "order"
"""The token for "swap", and of the whole road for "reverse"; weights know it as a cause of refusals, too."""
OF_ORDER = ("swap", "reverse")
FACTORS = (
    "-1", "0.1", "0.2", "0.25", "0.3", "0.333", "0.4", "0.5", "0.6", "0.667", "0.7", "0.75", "0.8", "0.9",
    "1.1", "1.2", "1.25", "1.333", "1.5", "1.75", "2", "2.5", "3", "4",
)  # fmt: skip
"""The factors that words imply without a number: "a third longer"."""
PERCENTS = ["x+", "x-", "x%"]
"""Tokens before a factor that the text gives in percent: "more by N %", "less by N %", "to N %"."""
TOKENS: tuple[str, ...] = tuple(read_text(Path(__file__).with_name("tokens.txt")).split())
"""All tokens. The weights know the tokens by their positions, so new tokens are added at the end."""
OF_ROADS = TOKENS[: TOKENS.index("//")]
"""All tokens of single roads and changes. Networks for single roads know no other tokens and cannot write a
plan that needs one."""
NUMBER_OF = {token: index for index, token in enumerate(TOKENS)}


def written(names: Iterable[str]) -> list[str]:
    """Returns those names of rows of the table of the language that the networks can write."""
    return [name for name in names if name in NUMBER_OF]


WAYS = re.compile(r"(?<=route=)(?:left|right|straight)(?:[+ ](?:left|right|straight))*")
"""The ways of a route through a map. As tokens they follow each other without a "+"."""
IN_TEXTS = {
    "metres": "metres", "percent": "percent", "degrees": "degrees", "km/h": "kmh", "m/s sideways": "kmh",
    "m/s2": "mps2",
}  # fmt: skip
"""The units in which texts give numbers of a scene, by those of the table."""
UNIT_OF = {
    **{f"{key}=": part.unit for parts in PARTS.values() for part in parts.values() if part.unit
       for key in filter(None, (part.key, part.double))}, **MEASURED,
    **{f"{each.key}=": IN_TEXTS.get(each.unit, "") for each in NUMBERS_OF_SCENES.values()},
    **{f"{kind}=": "" if row.falls else "metres" for kind, row in WEATHER.items()},
}  # fmt: skip
"""The unit of the number after a key, empty where a text gives it in a unit that is not read, such as
seconds; numbers after other keys are counts."""
SCALES = {"lat=": 1 / 3.6}
"""What a value of a text is multiplied by in plans: speeds sideways are in m/s."""


KEY_OF_TOKENS = re.compile(r"\b([a-z]+)= ?")
NEW = re.compile(r"\badd ")


def usual_key(doing: str) -> str:
    """Returns the key of the number that stands without one behind an action, such as "decel=" for "brake";
    empty if there is none."""
    first = next((name for what, its in MANEUVERS.items() if what == doing for name in its.numbers), "")
    return f"{NUMBERS_OF_SCENES[first].key}=" if first else ""


def change_of(tokens: Iterable[str], slots: Sequence[NumberSlot]) -> str:
    """Returns the plan of changes that the tokens represent."""
    return in_changes_of_scene(KEY_OF_TOKENS, r"\1 ", plan_of(tokens, slots, is_change=True))


def in_changes_of_scene(found: re.Pattern[str], by: str, line: str) -> str:
    """Replaces what is found in the changes of the scene, but not in what they add."""
    road, mark, scene = line.partition(SCENE)
    parts = list[str]()
    for part in scene.split(";"):
        new = NEW.search(part)
        at = new.start() if new else len(part)
        parts.append(found.sub(by, part[:at]) + part[at:])
    return road + mark + ";".join(parts)


def plan_of(tokens: Iterable[str], slots: Sequence[NumberSlot], is_change: bool = False) -> str:
    """Returns the plan, or the plan of changes, that the tokens represent, with the values of the slots
    filled in."""
    out: list[str] = []
    key = ""
    for word in with_values(tokens, slots):
        if word in UNIT_OF:
            key = word
        elif is_change and word in MANEUVERS:
            key = usual_key(word)
        elif word not in ("..", "-", "=", "+") and word not in SLOT_TOKENS:
            key = ""
        index = SLOT_TOKENS.index(word) if word in SLOT_TOKENS else SLOTS
        value = slots[index].value if index < len(slots) else 0.0
        percent = out[-1] if out and out[-1] in PERCENTS else ""
        if percent:
            share = value / 100
            out[-1:] = ["x", figure({"x+": 1 + share, "x-": 1 - share, "x%": share}[percent], 4)]
        elif word in SLOT_TOKENS:
            has_unit = index < len(slots) and bool(slots[index].unit)
            decimals = 2 if not has_unit else 1 if key in SCALES else 3
            out.append(figure(value * SCALES.get(key, 1) if has_unit else value, decimals))
        elif word in RAINS:
            out.append(RAINS[word])
        elif word in (";", "|", ")", ","):
            out.append(word + " ")
        elif word == ORDER and out[-1:] == [":"]:
            out.append("reverse" if out[-2:] == ["road", ":"] else "swap")
        else:
            out.append(word)
    text = ""
    for word in out:
        # a minus or an equals sign after a space belongs to a change; it also has no space after it
        follows = text.endswith(("=", "(", "-", "+", " x")) or (
            text.endswith("..") and (word[0].isdigit() or word == "-")
        )
        is_bound = word == ".." and text[-1:].isdigit()
        if text[-1:].isdigit() and (word.isdigit() or word == "-"):
            text += ","  # numbers of a list
        text += word if follows or is_bound or word[0] in ";),:" else f" {word}"
    text = re.sub(r"\s+", " ", text).strip()
    return WAYS.sub(lambda ways: ways[0].replace(" ", "+"), text)
