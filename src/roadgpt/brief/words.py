"""The table of what words such as "hairpin" mean, and of the numbers that can be required.

Everything takes these meanings and numbers from here: the readers, the Outline, the texts that RoadGPT writes
(descriptions, prompts, complaints about a road), and the documentation.

Every number is in everyday units (degrees, metres, percent with uphill positive) and applies to a measurement
on the finished geometry: the angle and the tightest radius of a turn, the length of a straight, the mean
grade of a feature. Designers aim well inside these ranges, and close to a number that was given; measured
curvature is averaged over 5 m."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from math import inf
from typing import Any, Literal, NamedTuple, get_args

from roadgpt.brief.ranges import Range
from roadgpt.language.names import Bump, Compass, Kind, Sharpness, Size, Slope
from roadgpt.language.table import ROADS
from roadgpt.settings import ROWS, span

MOST_LANES = 4  # in one direction
LandKind = Literal["flat", "rolling", "hilly", "mountain"]
"""How high the hills of a landscape are."""


def heading_from(compass: Compass) -> float:
    """Returns the heading of a car that comes from there, in degrees counter-clockwise from east."""
    return 45.0 * get_args(Compass).index(compass)


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a word requires of a road; a field that is None sets no requirement."""

    names: tuple[str, ...]
    """The English words with this meaning; RoadGPT's own texts use the first one."""
    turns: Range | None = None
    """The number of turns in one feature of this kind, if the description gives no number."""
    alternating: bool = False
    whole: bool = False
    shaped: bool = False
    own_angle: bool = False
    wide: bool = False
    """See ``roads.toml``."""
    degrees: Range | None = None
    """The change of heading of each turn in degrees; for a straight, the total change of heading along it."""
    aim: Range | None = None
    """The range of degrees that designers aim for, if some allowed values would be poor examples of the
    word."""
    radius: Range | None = None
    """The radius in metres at the tightest place of each turn."""
    length: Range | None = None
    """The length of the feature in metres."""
    grade: Range | None = None
    """The mean grade of the feature in percent, uphill positive."""


def _range(ends: Sequence[float]) -> Range:
    low, high, *number = [*ends, inf][: max(len(ends), 2)]
    return Range(low, high, *number)


def _meanings(part: str) -> dict[Any, Meaning]:
    """Returns the meanings of the words in a part of the table."""
    known = {each.name for each in fields(Meaning)} - {"names"}

    def of(row: Mapping[str, Any]) -> dict[str, Any]:
        return {each: row[each] if row[each] is True else _range(row[each]) for each in known & row.keys()}

    return {name: Meaning(tuple(row["names"]), **of(row)) for name, row in ROADS[part].items()}


KINDS: Mapping[Kind, Meaning] = _meanings("features")
NO_TURN = _range(ROADS["features"]["straight"]["degrees"])  # degrees: a straight turns no more than this
LEAST_STRAIGHT = float(ROADS["features"]["straight"]["length"][0])
"""In metres; a shorter straight cannot be seen between two turns."""
SHARPNESS: Mapping[Sharpness, Meaning] = _meanings("sharpness")
SIZES: Mapping[Size, Meaning] = _meanings("sizes")
SLOPES: Mapping[Slope, Meaning] = _meanings("slopes")
OVER: Mapping[Bump, str] = ROADS["bumps"]
"""The phrase for a crest or a dip inside a turn."""

LEAST_GRADE = 1.0  # percent: a road that climbs or falls less is level
FIGURE_WINS = 0.6
"""If a description gives both a word and a number, such as a "wide" turn and its radius, the number takes
precedence. The number may lie outside the usual range of the word: down to this factor times the lower end,
or up to the upper end divided by this factor."""

HILLS = 3
"""The least number of changes between climbing and falling of 'a hilly road': up, down, up, down."""

MOTORWAY_RADIUS = 600.0  # metres, for every turn of 'a motorway' if the map can hold it: see brief.map_fit
MOTORWAY_GRADE = 5.0  # percent, up or down, at its steepest place

LEAST_RADIUS = 14.326  # metres: 47 ft, the tightest turn of the SBFT competition
USUAL_MAP = float(ROWS["world"]["map_size"]["default"])  # metres along one side
LONGEST_ROAD = 50_000.0  # metres
SMALLEST_MAP, LARGEST_MAP = span(ROWS["world"]["map_size"])  # metres along one side
STEEPEST = 15.0  # percent, up or down: the system prompt of RoadGPT's thesis

PERCENT_SLACK = 1.0  # percentage points, around a grade that was given as a number
LENGTH_SLACK = 0.15  # ratio, around the length of a straight or the radius of a turn
ROAD_LENGTH_SLACK = 0.10  # ratio, around the length of the whole road
PART_CLIMB_SLACK = 0.25  # ratio, around the height of one turn or straight, whose ends are rounded
TURNING_SLACK = 0.10  # ratio, around the degrees of all turns together


def degrees_slack(degrees: float) -> float:
    """Returns the tolerance of an angle in degrees: 10 % of the angle, but at most 7 degrees for angles below
    90 degrees, and at most 10 degrees for angles from 90 degrees on."""
    return min(0.1 * abs(degrees), 7.0 if abs(degrees) < 90 else 10.0)


class Quantity(NamedTuple):
    """A measurable quantity of a road: its tolerance, and phrases in which ``{}`` stands for a range."""

    asked: str
    """The phrase for a requirement in prompts, complaints and advice."""
    measured: str
    """The phrase for a measured value in complaints; here ``{}`` stands for the value."""
    slack: Callable[[float], float]
    """Returns the tolerance around an exact number, in the unit of the number."""
    tolerance: str
    """The tolerance in words."""
    on_heights: bool = False
    """Whether the quantity depends only on the heights of the road."""
    unit: str = ""
    """The unit after a range, with a space before it."""
    said: str = ""
    """The phrase for a requirement of a feature in the sentence of a Brief."""


Tolerance = tuple[Callable[[float], float], str]


def _share(share: float, least: float = 0.0) -> Tolerance:
    """Returns a tolerance of ``share`` of the number, but at least ``least`` metres, as code and in words."""
    more = f", at least {least:g} m" if least else ""
    return lambda number: max(share * abs(number), least), f"{100 * share:g} %{more}"


_METRES = _share(LENGTH_SLACK)
_PERCENT: Tolerance = (lambda _: PERCENT_SLACK, f"{PERCENT_SLACK:g} percentage point")
_DEGREES = (degrees_slack, "10 %, at most 7 degrees, or at most 10 from 90 degrees on")
_COUNT: Tolerance = (lambda _: 0.0, "none")

ROAD = {
    "turning": Quantity("{} degrees of turning in all", "{:.0f}", *_share(TURNING_SLACK)),
    "steepest": Quantity("a steepest place of {} %", "{:.1f} %", *_PERCENT, True),
    "climb": Quantity("a climb of {} m", "{:.1f} m", *_share(LENGTH_SLACK, 1.0), True),
    "hills": Quantity("{} changes between climbing and falling", "{}", *_COUNT, True),
    "length": Quantity("a length of {} m", "{:.0f} m", *_share(ROAD_LENGTH_SLACK)),
    "radius": Quantity("a tightest place of {} m radius", "{:.1f} m", *_METRES),
}
"""The quantities of a whole road, by their names in the Outline, the Measures and (but the radius) the Brief.
"""

FEATURE = {
    "degrees": Quantity("{} degrees", "turns {:.0f} degrees", *_DEGREES, said="of {} degrees"),
    "radius": Quantity(
        "radius {} m", "has a radius of {:.1f} m", *_METRES, unit=" m", said="with a radius of {} metres"
    ),
    "length": Quantity("{} m long", "is {:.0f} m long", *_METRES, unit=" m", said="of {} metres"),
    "grade": Quantity("slope {} %", "has a grade of {:.1f} %", *_PERCENT, True, " %", said="{} percent"),
    "climb": Quantity(
        "climb {} m", "rises by {:.1f} m", *_share(PART_CLIMB_SLACK, 1.0), True, " m", said="by {} metres"
    ),
}
"""The quantities of one turn or straight, by their names in a Feature and in a MeasuredFeature."""

COUNTS = {"turns": "turn", "left": "left turn", "right": "right turn"}
"""The nouns for the fields of the Brief and the Outline that count turns, by the name of the field."""

WHOLE_SLOPES = {"up": "climbs", "down": "falls", "flat": "is level"}
"""The verb for each slope of the whole road, for texts such as 'the whole road climbs'."""


SURE = 0.8
"""Readings with a confidence (0 to 1) below this are wrong so often that the user is asked or warned."""


def unaccented(words: str) -> str:
    """Returns the words in lower case and without accents; "ß" stays."""
    return "".join(c for c in unicodedata.normalize("NFD", words.lower()) if not unicodedata.combining(c))
