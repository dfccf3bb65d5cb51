"""The tokens that the model writes: plans split into words, with slots in place of measured numbers.

turn x3 left; straight len=91.4 | up        ->  turn x 3 left ; straight len= [1] | up
"""

import re
from collections.abc import Iterable, Mapping, Sequence

from roadgpt.brief.plan import with_halfway
from roadgpt.brief.readers.model.computed_numbers import KEYS as COMPUTED_KEYS
from roadgpt.brief.readers.model.computed_numbers import ONE, Compared, computed, with_values
from roadgpt.brief.readers.model.measures import LARGEST_SEEN
from roadgpt.brief.readers.model.slots import SLOTS, NumberSlot

REFUSALS = ("!nonsense", "!contradiction", "!impossible", "!unclear")
# The weights know these words by their positions, so the order here is fixed and differs from the Brief's.
KINDS = [
    "straight",
    "crest",
    "dip",
    "turn",
    "hairpin",
    "switchback",
    "u_turn",
    "s_bend",
    "chicane",
    "slalom",
    "serpentine",
    "zigzag",
    "winding",
]
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
PIECE = re.compile(
    r"//|\|\||![a-z]+|(?:left|right)(?:\+(?:right|straight))+|[a-z_]+\(|[a-z_]+=|x(?=-?[\d.])|half[12]|\.\.|-?\d+(?:\.\d+)?|[a-z_]+|[;|):,=+]|-(?=\d)"
)
WAYS = re.compile(r"(?<=route=)(?:left|right|straight)(?:[+ ](?:left|right|straight))*")
"""The ways of a route through a map. As tokens they follow each other without a "+"."""
LISTED = re.compile(r",(?=\s*-?\d)")
"""A comma between numbers of a list; it has no token, so the numbers directly follow each other."""
NUMERIC = re.compile(r"-?\d+(?:\.\d+)?")
UNIT_OF = {
    "deg=": "degrees", "angle=": "degrees", "r=": "metres", "d=": "metres",
    "len=": "metres", "taper=": "metres", "climb=": "metres",
    "turning=": "degrees", "pct=": "percent", "steepest=": "percent", **MEASURED,
}  # fmt: skip
"""The unit of the number after a key; numbers after other keys are counts."""
CLOSE = 0.0051
"""A factor is taken for a number in the text, or for a usual factor, if it differs by less than this."""


def tokens_of(plan: str, slots: Sequence[NumberSlot], compared: Compared | None = None) -> list[str] | None:
    """Returns the tokens of a plan; None if the plan has a number for which there is neither a slot nor a
    token. Without ``compared``, no number is computed from others.
    """
    out: list[str] = []
    key = ""
    taken: dict[int, str] = {}
    known = compared.plain if compared else frozenset()
    line = WAYS.sub(lambda ways: ways[0].replace("+", " "), with_halfway(plan))
    for piece in PIECE.findall(LISTED.sub(" ", line)):
        if NUMERIC.fullmatch(piece):
            if out[-1] == "x" and key in MEASURED:
                found = _factor_tokens(float(piece), slots)
                out.pop()
            else:
                is_count = out[-1] in ("x", *NOUNS, *KINDS, *NUMBERS)
                found = _number_tokens(piece, "" if is_count else key, slots, taken)
                is_said = found is not None and (found[-1] in SLOT_TOKENS or found[-1] in known)
                if compared and key in COMPUTED_KEYS and not (is_count or is_said or "roundabout" in out):
                    sign, value = ["-"] * piece.startswith("-"), abs(float(piece))
                    made = computed(value, _bases(key, slots, taken, known), slots, compared)
                    found = [*sign, *made] if made else found
            if out[-1] == "r=" and "roundabout" in out and (found is None or found[0] not in SLOT_TOKENS):
                across = _number_tokens(f"{2 * float(piece):g}", key, slots, taken)
                if across and across[0] in SLOT_TOKENS:  # the text gives the diameter
                    out[-1], found = "d=", across
            if found is None:
                return None
            out += found
            continue
        if (piece.endswith("=") and len(piece) > 1) or piece in MEASURED:
            key = piece
        elif piece not in ("..", "=", "+", "-", "x", *SLOPES):
            key = ""
        out.append(ORDER if piece in OF_ORDER else piece)
    return out


def _bases(
    key: str, slots: Sequence[NumberSlot], taken: Mapping[int, str], plain: Iterable[str]
) -> list[str]:
    """Returns the tokens of the numbers from which a number may be computed: first those already used for the
    same key, the last one first, then those of the same unit, then those without a unit.
    """
    used = [index for index in reversed(list(taken)) if taken[index] == key]
    free = [index for index in range(len(slots)) if index not in taken]
    alike = [index for index in free if slots[index].unit == UNIT_OF[key]]
    bare = [index for index in free if not slots[index].unit]
    small = sorted((number for number in plain if number in NUMBERS and number not in FIXED), key=int)
    one = ["1"] if key in ONE and "1" not in small else []
    return [*(SLOT_TOKENS[index] for index in (*used, *alike, *bare)), *reversed(small), *one]


def _factor_tokens(factor: float, slots: Sequence[NumberSlot]) -> list[str] | None:
    """Returns the tokens of a factor: a percentage or a number in the text, or a usual factor."""
    for index, slot in enumerate(slots):
        if slot.unit in ("percent", ""):
            share = slot.value / 100
            ways = {"x+": 1 + share, "x-": 1 - share, "x%": share}
            near = next((way for way, value in ways.items() if abs(value - factor) < CLOSE), None)
            if near and (slot.unit or slot.value > 4):
                return [near, SLOT_TOKENS[index]]
        if not slot.unit and abs(slot.value - factor) < CLOSE:
            return ["x", SLOT_TOKENS[index]]
    usual = next((word for word in FACTORS if abs(float(word) - factor) < CLOSE), None)
    return ["x", usual] if usual else None


def _number_tokens(
    piece: str, key: str, slots: Sequence[NumberSlot], taken: dict[int, str]
) -> list[str] | None:
    sign, digits = (["-"], piece[1:]) if piece.startswith("-") else ([], piece)
    value = float(digits)
    fits = [index for index, slot in enumerate(slots) if abs(slot.value - value) < 0.051]
    if key in UNIT_OF:
        same_unit = [index for index in fits if slots[index].unit == UNIT_OF[key]]
        bare = [index for index in fits if not slots[index].unit]
        fits = same_unit or bare
    else:
        fits = [index for index in fits if not slots[index].unit]
    free = [index for index in fits if index not in taken]
    if fits:
        taken[(free or fits)[0]] = key
        return [*sign, SLOT_TOKENS[(free or fits)[0]]]
    return [*sign, digits] if digits in NUMBERS else None


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
