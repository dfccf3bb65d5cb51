"""Finds the unit of each number in a description, even if the unit does not directly follow the number.

Slopes in degrees are converted to percent: "a slope of 4 degrees" is read as 7 percent, and not as a turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import radians, tan

from roadgpt.brief.readers.model.nouns import COUNTED, LEFT, ONE_TURN, RIGHT
from roadgpt.brief.readers.model.units import JOINTS, TIMES, UNITS, Unit
from roadgpt.brief.readers.model.word_set import word_set

LARGEST_SEEN = 20
"""The largest number without a unit that remains as digits in the text for the model. Larger ones become
slots."""
LAST_TURN = 9  # a number up to this one behind "turn" says which turn
SIDES = LEFT | RIGHT | {"g", "d", "i", "der", "sn", "ds"}
"""Words for left and right, and their abbreviations that occur only before numbers, as in "G90"."""
RADIUS = frozenset(
    ["radius", "radii", "rad", "halbmesser", "radien", "rayon", "rayons", "ray", "radio", "radios", "raggio"]
    + ["raggi"]
)
LEADING_TO = word_set(
    "= : . of is about around roughly approximately approx ca circa von etwa rund ungefahr de environ unos",
    "aproximadamente di",
)
"""What can stand between a word for a radius and its number."""
STEEPEST = 45.0  # degrees: anything steeper is a turn, or nonsense that the network refuses itself
SLOPES = word_set(
    "slope slopes grade grades gradient gradients incline inclines inclination climb ascent ascents",
    "descent descents rise decline steigung gefalle anstieg neigung pente pentes montee descente",
    "pendiente pendientes subida bajada inclinacion pendenza pendenze salita discesa inclinazione",
)
SLOPING = word_set(
    "climbs climbing rises rising ascends ascending descends descending drops dropping falls falling",
    "uphill downhill steigt steigend fallt fallend bergauf bergab monte descend sube baja sale scende",
)
BETWEEN = word_set(
    "of at is are : = by with an angle angled about around roughly von mit um de d ' di con del der"
)
TURNING = COUNTED | ONE_TURN | LEFT | RIGHT | {"heading"}
SKIPPED = frozenset(["-", "of", "to", "the", "nach", "a", "la", "vers"])
MOST_BETWEEN = 4
"""How many of the words in BETWEEN may separate the slope from its number."""


@dataclass(slots=True)
class Number:
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
    and how many words the unit takes up in the text.
    """
    for size in (2, 1):
        found = UNITS.get(tuple(tokens[at : at + size]))
        if found:
            unit, factor = found
            over, time = [*tokens[at + size : at + size + 2], "", ""][:2]
            if unit == "metres" and over == "/" and time in TIMES:
                return "kmh", 1.0, size + 2  # a speed
            if tokens[at] in ("km", "kilometers") and list(tokens[at + 1 : at + 3]) in (
                ["per", "hour"],
                ["an", "hour"],
            ):
                return "kmh", 1.0, size + 2
            return unit, factor, size
    return None


def take_unit(number: Number, tokens: list[str]) -> None:
    """Assigns to a number the unit that follows it, and converts its value to metres, percent or degrees."""
    if number.unit:
        return
    at = number.last + 1
    for skip in (0, 1):
        if skip and (at >= len(tokens) or tokens[at] not in ("-", "'")):
            break
        found = unit_at(tokens, at + skip)
        if found and not (tokens[at + skip] in ("º", "a", "e") and number.value < 10):
            unit, factor, size = found
            number.value, number.unit = round(number.value * factor, 1), unit
            number.spread *= factor
            number.last, number.is_bare, number.factor = at + skip + size - 1, False, factor
            return
    number.value = round(number.value, 1)


def share_units(numbers: list[Number], tokens: list[str]) -> None:
    """Assigns to "40" in "40 to 60 metres" the unit of "60"; works backwards, so that it also handles longer
    lists.
    """
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


def take_unit_of_all(numbers: list[Number], tokens: list[str]) -> None:
    """Treats numbers without a unit, except counts, as feet or yards if the description says so, as in
    "lengths in feet: 250 straight".
    """
    factors = {UNITS.get((unit,), ("", 0.0)) for word, unit in pairwise(tokens) if word in ("in", "en")}
    sizes = [factor for unit, factor in factors if unit == "metres" and factor < 1.0]
    if len(sizes) != 1 or any(number.unit == "metres" for number in numbers):
        return
    for number in numbers:
        is_after_side = number.first > 0 and tokens[number.first - 1] in SIDES
        if number.is_bare and not is_count(tokens, number) and not is_after_side:
            number.value, number.unit = round(number.value * sizes[0], 1), "metres"
            number.is_bare, number.factor = False, sizes[0]


def is_count(tokens: Sequence[str], number: Number) -> bool:
    """Returns True if the number may be a count: whole, not too large, and not a radius."""
    return (
        number.value <= LARGEST_SEEN and number.value == int(number.value) and not is_radius(tokens, number)
    )


def is_radius(tokens: Sequence[str], number: Number) -> bool:
    """Returns True if the number is 10 or more and follows "R" or a word for a radius, as in "R15"."""
    at = number.first - 1
    while at >= 0 and tokens[at] in LEADING_TO:
        at -= 1
    return number.value >= 10 and at >= 0 and (tokens[at] == "r" or tokens[at] in RADIUS)


def as_grade(number: Number, tokens: Sequence[str]) -> None:
    """Converts degrees to percent if the words next to the number show that it is a slope.

    Only a number close to a word for a slope is a slope; "climbs 30 degrees to the left" remains a turn.
    """
    if number.unit == "degrees" and number.value <= STEEPEST and _is_tilt(number, tokens):
        number.value, number.unit = round(100 * tan(radians(number.value)), 1), "percent"


def _is_tilt(number: Number, tokens: Sequence[str]) -> bool:
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
