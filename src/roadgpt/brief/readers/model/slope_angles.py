"""Converts slopes given in degrees to percent: "a slope of 4 degrees" is 7 percent, not a turn.

Only numbers close to a word for a slope are converted; "climbs 30 degrees to the left" remains a turn.
"""

from collections.abc import Sequence
from math import radians, tan

from roadgpt.brief.readers.model.measures import Number
from roadgpt.brief.readers.model.nouns import COUNTED, LEFT, ONE_TURN, RIGHT
from roadgpt.brief.readers.model.word_set import word_set

STEEPEST = 45.0  # degrees: anything steeper is a turn, or nonsense that the network refuses itself
NOUNS = word_set(
    "slope slopes grade grades gradient gradients incline inclines inclination climb ascent ascents",
    "descent descents rise decline steigung gefalle anstieg neigung pente pentes montee descente",
    "pendiente pendientes subida bajada inclinacion pendenza pendenze salita discesa inclinazione",
)
VERBS = word_set(
    "climbs climbing rises rising ascends ascending descends descending drops dropping falls falling",
    "uphill downhill steigt steigend fallt fallend bergauf bergab monte descend sube baja sale scende",
)
BETWEEN = word_set(
    "of at is are : = by with an angle angled about around roughly von mit um de d ' di con del der"
)
TURNING = COUNTED | ONE_TURN | LEFT | RIGHT | {"heading"}
SKIPPED = frozenset(["-", "of", "to", "the", "nach", "a", "la", "vers"])
REACH = 4
"""How many of the words in BETWEEN may separate the slope from its number."""


def as_grade(number: Number, tokens: Sequence[str]) -> None:
    """Converts a number of degrees to percent if the words next to it show that it is a slope."""
    if number.unit == "degrees" and number.value <= STEEPEST and _is_tilt(number, tokens):
        number.value, number.unit = round(100 * tan(radians(number.value)), 1), "percent"


def _is_tilt(number: Number, tokens: Sequence[str]) -> bool:
    after = [token for token in tokens[number.last + 1 : number.last + 5] if token not in SKIPPED]
    if after and after[0] in NOUNS:
        return not TURNING.intersection(after[1:2])
    if TURNING.intersection(after[:2]):
        return False
    at = number.first - 1
    while at >= 0 and tokens[at] in BETWEEN and number.first - 1 - at < REACH:
        at -= 1
    if at < 0:
        return False
    # "climb 40 degrees" says too little: it may climb and turn
    return at < number.first - 1 and tokens[at] in NOUNS | VERBS
