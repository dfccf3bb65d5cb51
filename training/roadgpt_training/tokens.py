"""Splits plans into the tokens that the networks write, with slots of the text in place of its numbers.

``roadgpt.brief.readers.model.vocabulary.plan_of`` is the way back.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import permutations

from roadgpt.brief.amount import amount_text
from roadgpt.brief.plan import HALFWAY, SCENE, half_of_route
from roadgpt.brief.readers.model.slots import NumberSlot
from roadgpt.brief.readers.model.vocabulary import (
    FACTORS,
    FIXED,
    KEYS,
    KINDS,
    MEASURED,
    MULTIPLES,
    NOUNS,
    NUMBERS,
    OF_ORDER,
    ONE,
    ORDER,
    RAINS,
    SCALES,
    SIGNS,
    SLOPES,
    SLOT_TOKENS,
    STEPS,
    UNIT_OF,
    WAYS,
    Compared,
    exact_factor,
    in_changes_of_scene,
    usual_key,
    value_of,
)
from roadgpt.brief.scene import usual_weather
from roadgpt.language.table import MANEUVERS, WEATHER
from roadgpt.language.table import NUMBERS as OF_SCENES

PIECE = re.compile(
    r"//|\|\||&&|![a-z]+|(?:left|right)(?:\+(?:right|straight))+|[a-z_]+\(|[a-z_]+=|x(?=-?[\d.])|half[12]|\.\.|-?\d+(?:\.\d+)?|[a-z_]+|[;|):,=+]|-(?=\d)"
)
UNSAID = {
    **RAINS,
    **{str(name): f"{name} {amount_text(usual_weather(name).amount)}" for name in WEATHER},
    "slippery s=": "slippery mu=0.3 s=",
}
"""What plans have where a text gives no number, by what stands in the tokens."""
LISTED = re.compile(r",(?=\s*-?\d)")
"""A comma between numbers of a list; it has no token, so the numbers directly follow each other."""
NUMERIC = re.compile(r"-?\d+(?:\.\d+)?")
KEY_OF_CHANGE = re.compile(
    rf"\b({'|'.join(sorted({number.key for number in OF_SCENES.values()} | {*WEATHER}))}) "
    r"(?=[=+x-]|\.\.|-?\d|(?:slightly |much )?(?:more|less)\b)"
)
"""The name of a number of a scene in a plan of changes, "truck: v +5", where a description has "v=5"."""
CLOSE = 0.0051
"""A factor is taken for a number in the text, or for a usual factor, if it differs by less than this."""


def tokens_of(
    plan: str, slots: Sequence[NumberSlot], compared: Compared | None = None, is_change: bool = False
) -> list[str] | None:
    """Returns the tokens of a plan, or of a plan of changes; None if the plan has a number for which there is
    neither a slot nor a token. Without ``compared``, no number is computed from others.
    """
    out: list[str] = []
    key = ""
    taken: dict[int, str] = {}
    known = compared.plain if compared else frozenset()
    line = WAYS.sub(lambda ways: ways[0].replace("+", " "), _with_halfway(plan))
    if is_change:  # numbers of the scene get the keys that they have in tokens: "v= +5"
        line = in_changes_of_scene(KEY_OF_CHANGE, r"\1= ", line)
    for token, said in UNSAID.items():
        line = line.replace(said, token)
    for piece in PIECE.findall(LISTED.sub(" ", line)):
        if NUMERIC.fullmatch(piece):
            is_of_scene = is_change and SCENE in out
            if out[-1] == "x" and (key in MEASURED or (is_of_scene and key)):
                found = _factor_tokens(float(piece), slots)
                out.pop()
            else:
                is_count = out[-1] in ("x", *NOUNS, *KINDS, *NUMBERS)
                found = _number_tokens(piece, "" if is_count else key, slots, taken)
                if key in SCALES and not is_count:
                    scaled = _number_tokens(f"{float(piece) / SCALES[key]:.1f}", key, slots, taken)
                    found = scaled if scaled and scaled[-1] in SLOT_TOKENS else found
                is_said = found is not None and (found[-1] in SLOT_TOKENS or found[-1] in known)
                if compared and key in KEYS and not (is_count or is_said or "roundabout" in out):
                    sign, value = ["-"] * piece.startswith("-"), abs(float(piece))
                    made = _computed(value, _bases(key, slots, taken, known), slots, compared)
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
        elif piece in WEATHER:
            key = f"{piece}="
        elif is_change and SCENE in out and piece in MANEUVERS:
            key = usual_key(piece)
        elif is_change and SCENE in out and piece == ":" and key in (f"{name}=" for name in WEATHER):
            pass  # "fog: =50" changes the number of the fog
        elif piece not in ("..", "=", "+", "-", "x", *SLOPES):
            key = ""
        out.append(ORDER if piece in OF_ORDER and SCENE not in out else piece)
    return out


def _with_halfway(line: str) -> str:
    """Returns a plan with the word "halfway" in place of each length that means half of the whole route."""
    half = half_of_route(line)
    return re.sub(rf"{re.escape(half)}(?![\d.])", HALFWAY, line) if half else line


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


def _computed(
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
    for factor in MULTIPLES:
        for base in said:
            yield round(value_of(base, slots) * exact_factor(factor), 1), [base, "x", factor]


def _sums(said: Sequence[str], slots: Sequence[NumberSlot]) -> Iterator[tuple[float, list[str]]]:
    for times in ("", *STEPS):
        for base, step in permutations(said, 2):
            for sign in SIGNS:
                change = value_of(step, slots) * float(times or 1) * (1 if sign == "+" else -1)
                more = ["x", times] if times else []
                yield value_of(base, slots) + change, [base, sign, step, *more]
