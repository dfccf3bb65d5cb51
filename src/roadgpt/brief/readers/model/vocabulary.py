"""The tokens that the model writes: plans split into words, with slots in place of measured numbers.

turn x3 left; straight len=91.4 | up        ->  turn x 3 left ; straight len= [1] | up
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from roadgpt.brief.readers.model.slots import LARGEST_SEEN, SLOTS, NumberSlot

MULTIPLES = ("2", "0.5", "3", "1.5", "0.333", "4", "0.25", "0.75", "0.667", "2.5", "1.333", "1.25")
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
# The weights know these words by their positions, so the order here is fixed and differs from the Brief's.
KINDS = [
    "straight", "crest", "dip", "turn", "hairpin", "switchback", "u_turn", "s_bend", "chicane", "slalom",
    "serpentine", "zigzag", "winding",
]  # fmt: skip
SIDES = ["left", "right"]
SHARPNESS = ["gentle", "sweeping", "sharp"]
SIZES = ["long", "short"]
SLOPES = ["up", "down", "flat", "nearly_flat", "gently_up", "gently_down", "steeply_up", "steeply_down"]
CLAUSE_KEYS = ["deg=", "r=", "len=", "pct="]
ROAD_KEYS = ["turns=", "lefts=", "rights=", "steepest=", "climb=", "hills=", "deg=", "r=", "len=", "pct="]
PLACES = ["starts(", "ends("]
FIXED = ("15", "30", "45", "60", "90", "120", "135", "180")
"""Angles in degrees that words imply without naming them: a kink, a dog-leg, a right angle."""
NEWER = ("135",)
"""Angles that were added later; their tokens therefore do not stand with those of the other numbers."""
OLDER_NUMBERS = [
    *(str(number) for number in range(LARGEST_SEEN + 1)),
    *(number for number in FIXED if int(number) > LARGEST_SEEN and number not in NEWER),
]
NUMBERS = [*OLDER_NUMBERS, *NEWER]
SLOT_TOKENS = [f"[{index + 1}]" for index in range(SLOTS)]
ENDS = ("<pad>", "<start>", "<end>")
OLDEST = [
    *ENDS, "!nonsense", "!contradiction", "!impossible", ";", "|", ")", "..", "-", "x", *KINDS, *SIDES,
    *SHARPNESS, *SIZES, *SLOPES, "alternating", "hard", *CLAUSE_KEYS, *ROAD_KEYS, *PLACES, *OLDER_NUMBERS,
    *SLOT_TOKENS,
]  # fmt: skip
CAUSES = [
    "turns", "sides", "order", "sharpness", "degrees", "radius", "slope", "steepness", "climb", "length",
    "grade", "loop", "junction", "crossroads", "roundabout", "merge", "exit", "lane_change", "bridge",
    "tunnel",
    "railway_crossing", "zebra_crossing", "parking", "bus_stop", "roadworks", "traffic_light", "sign",
    "speed_bump", "pothole", "kerb", "guardrail", "obstacle", "traffic", "pedestrian", "cyclist", "animal",
    "rain", "fog", "snowfall", "wind", "night", "sun", "trees", "buildings", "water", "landscape", "gravel",
    "cobbles", "size", "place", "compared", "alike", "wet", "snow", "ice", "lanes", "lane_width", "bank",
    "speed",
]  # fmt: skip
"""Causes of refusals, and names in ``Brief.beside``, in the order in which the weights know them."""
NOUNS = ["turn", "straight", "start", "end", "road"]
SUPERLATIVES = ["longest", "shortest", "sharpest", "gentlest", "steepest", "flattest"]
HALVES = ["half1", "half2"]
NEXT_TO = ["after(", "before(", "between(", "on("]
"""The positions of a feature that a change adds, relative to a place on the road."""
POSITIONS = [*NEXT_TO, "from(", "up_to("]
ENDS_OF_ROAD = ["at_start", "at_end", "at_middle"]
MEASURED = {"angle": "degrees", "radius": "metres", "length": "metres", "slope": "percent", "climb": "metres"}
"""The properties to which a change can give a value, with the unit of the value."""
ALONE = ["straighten", "remove", "mirror", "alternate"]
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
CHANGES = [
    "!unclear", *CAUSES, "beside(", ",", "add", ":", *NOUNS, "all", "middle", *SUPERLATIVES, *HALVES,
    *POSITIONS, *ENDS_OF_ROAD, "but(", *MEASURED, "side", "other", "shape", *ALONE, "=", "+", *PERCENTS,
    "slightly", "much", "more", "less", "whole", *FACTORS, *NEWER, "turning=",
]  # fmt: skip
JUNCTIONS = ["t_junction", "y_junction", "crossroads", "star", "junction"]
RAMPS = ["merge", "diverge"]
LANE_KINDS = ["lane_drop", "lane_gain"]
TAKES = ["straight", "back", "sharp_left", "sharp_right", "slight_left", "slight_right"]
ROUNDABOUT = "roundabout"
RING_SIZES = ["mini", "normal", "large"]
CONTROLS = ["priority", "yield", "stop", "lights", "none"]
FLAGS = ["skew", "all_way", "crosswalk"]
NEWER_FLAGS = ["others_stop"]
LISTED_WAYS = ["left+right", "left+straight", "right+straight", "left+right+straight"]
CENTRES = ["solid", "broken", "double", "none"]
NETWORKS = [
    "//", "||", *JUNCTIONS, ROUNDABOUT, *RAMPS, *LANE_KINDS, "lane_change", *TAKES, "ramp", "main",
    *RING_SIZES, *CONTROLS, *FLAGS, "side=", "ways=", *LISTED_WAYS, "exit=", "arms=", "lanes=", "against=",
    "oneway", "divided", "centre=", *CENTRES, "left_hand", "motorway", "map", "columns=", "rows=", "halfway",
    "d=", *NEWER_FLAGS, "angle=", "in=", "out=", "dead_ends=", "taper=",
    "blocks=", "route=",
]  # fmt: skip
"""Tokens of routes with junctions and of maps."""
OF_ROADS: tuple[str, ...] = tuple(dict.fromkeys([*OLDEST, *CHANGES]))
"""All tokens of single roads and changes. Networks for single roads know no other tokens and cannot write a
plan that needs one.
"""
TOKENS: tuple[str, ...] = tuple(dict.fromkeys([*OF_ROADS, *NETWORKS]))
"""All tokens. The weights know the tokens by their positions, so new tokens are added at the end."""
NUMBER_OF = {token: index for index, token in enumerate(TOKENS)}
WAYS = re.compile(r"(?<=route=)(?:left|right|straight)(?:[+ ](?:left|right|straight))*")
"""The ways of a route through a map. As tokens they follow each other without a "+"."""
UNIT_OF = {
    "deg=": "degrees", "angle=": "degrees", "r=": "metres", "d=": "metres",
    "len=": "metres", "taper=": "metres", "climb=": "metres",
    "turning=": "degrees", "pct=": "percent", "steepest=": "percent", **MEASURED,
}  # fmt: skip
"""The unit of the number after a key; numbers after other keys are counts."""


def plan_of(tokens: Iterable[str], slots: Sequence[NumberSlot]) -> str:
    """Returns the plan that the tokens represent, with the values of the slots filled in."""
    out: list[str] = []
    for word in with_values(tokens, slots):
        index = SLOT_TOKENS.index(word) if word in SLOT_TOKENS else SLOTS
        value = slots[index].value if index < len(slots) else 0.0
        percent = out[-1] if out and out[-1] in PERCENTS else ""
        if percent:
            share = value / 100
            out[-1:] = ["x", _plain({"x+": 1 + share, "x-": 1 - share, "x%": share}[percent], 4)]
        elif word in SLOT_TOKENS:
            out.append(_plain(value, 1))
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


def _plain(value: float, digits: int) -> str:
    return f"{value:.{digits}f}".rstrip("0").rstrip(".")
