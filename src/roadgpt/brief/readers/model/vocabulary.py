"""The tokens that the model writes: plans split into words, with slots in place of measured numbers.

turn x3 left; straight len=91.4 | up        ->  turn x 3 left ; straight len= [1] | up
"""

import re
from collections.abc import Iterable, Sequence

from roadgpt.brief.readers.model.measures import LARGEST_SEEN
from roadgpt.brief.readers.model.slots import SLOTS, NumberSlot

REFUSALS = ("!nonsense", "!contradiction", "!impossible")
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
FIXED = ("15", "30", "45", "60", "90", "120", "180")
"""Angles in degrees that words imply without naming them: a kink, a dog-leg, a right angle."""
NUMBERS = [*(str(number) for number in range(LARGEST_SEEN + 1)), *(n for n in FIXED if int(n) > LARGEST_SEEN)]
SLOT_TOKENS = [f"[{index + 1}]" for index in range(SLOTS)]
ENDS = ("<pad>", "<start>", "<end>")
TOKENS: tuple[str, ...] = tuple(
    dict.fromkeys(
        [
            *ENDS, *REFUSALS, ";", "|", ")", "..", "-", "x", *KINDS, *SIDES, *SHARPNESS, *SIZES, *SLOPES,
            "alternating", "hard", *CLAUSE_KEYS, *ROAD_KEYS, *PLACES, *NUMBERS, *SLOT_TOKENS,
        ]
    )
)  # fmt: skip
NUMBER_OF = {token: index for index, token in enumerate(TOKENS)}
PIECE = re.compile(r"![a-z]+|starts\(|ends\(|[a-z_]+=|x(?=[\d.])|\.\.|-?\d+(?:\.\d+)?|[a-z_]+|[;|)]")
MEASURES = frozenset({"deg=", "r=", "len=", "pct=", "steepest=", "climb="})
UNIT_OF = {
    "deg=": "degrees", "r=": "metres", "len=": "metres", "climb=": "metres",
    "pct=": "percent", "steepest=": "percent",
}  # fmt: skip


def tokens_of(plan: str, slots: Sequence[NumberSlot]) -> list[str] | None:
    """Returns the tokens of a plan; None if the plan has a number for which there is neither a slot nor a
    token.
    """
    out: list[str] = []
    key = ""
    taken: set[int] = set()
    for piece in PIECE.findall(plan):
        if piece.endswith("=") or piece == "x":
            key = piece
        if re.fullmatch(r"-?\d+(?:\.\d+)?", piece):
            found = _number_tokens(piece, key, slots, taken)
            if found is None:
                return None
            out += found
        else:
            out.append(piece)
    return out


def _number_tokens(piece: str, key: str, slots: Sequence[NumberSlot], taken: set[int]) -> list[str] | None:
    sign, digits = (["-"], piece[1:]) if piece.startswith("-") else ([], piece)
    value = float(digits)
    fits = [index for index, slot in enumerate(slots) if abs(slot.value - value) < 0.051]
    if key in MEASURES:
        same_unit = [index for index in fits if slots[index].unit == UNIT_OF[key]]
        bare = [index for index in fits if not slots[index].unit]
        fits = same_unit or bare
    else:
        fits = [index for index in fits if not slots[index].unit]
    free = [index for index in fits if index not in taken]
    if fits:
        taken.add((free or fits)[0])
        return [*sign, SLOT_TOKENS[(free or fits)[0]]]
    return [*sign, digits] if digits in NUMBER_OF else None


def plan_of(tokens: Iterable[str], slots: Sequence[NumberSlot]) -> str:
    """Returns the plan that the tokens represent, with the values of the slots filled in."""
    out: list[str] = []
    for word in tokens:
        if word in SLOT_TOKENS:
            index = SLOT_TOKENS.index(word)
            out.append(f"{slots[index].value:.1f}".rstrip("0").rstrip(".") if index < len(slots) else "0")
        elif word in (";", "|", ")"):
            out.append(word + " ")
        else:
            out.append(word)
    text = ""
    for word in out:
        follows = text.endswith(("=", "(", "-", " x")) or (text.endswith("..") and word[0].isdigit())
        text += word if follows or word == ".." or word[0] in ";)" else f" {word}"
    return re.sub(r"\s+", " ", text).strip()
