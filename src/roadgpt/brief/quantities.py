"""The table of the numbers that can be required of a whole road, and of one turn or straight.

A quantity has the same name in the Brief, in the Outline and in ``check.measures``. The Outline uses the
tolerances of this table. The sentence of a Brief, the prompts for language models, the complaints of the rule
``promises`` and the advice of the planner use its wording.
"""

from collections.abc import Callable
from typing import NamedTuple

from roadgpt.brief.words import (
    LENGTH_SLACK,
    PERCENT_SLACK,
    ROAD_LENGTH_SLACK,
    TURNING_SLACK,
    degrees_slack,
)


class Quantity(NamedTuple):
    """One measurable number, its tolerance, and the wording for it."""

    name: str
    """The name of the field in the Outline or Feature, and in Measures or MeasuredFeature."""
    asked: str
    """The required range in words; ``{}`` stands for the range."""
    measured: str
    """The measured number in words."""
    said: str
    """The required range as the sentence of a Brief states it; empty if no Brief requires this quantity."""
    slack: Callable[[float], float]
    """Returns the tolerance around an exact number, in the unit of the number."""
    on_heights: bool = False
    """Whether the quantity depends only on the heights of the road."""
    unit: str = ""
    """The unit after a range, with a space before it."""


def _percent(_: float) -> float:
    return PERCENT_SLACK


def _metres(number: float) -> float:
    return LENGTH_SLACK * number


ROAD = {
    row.name: row
    for row in (
        Quantity(
            "turning",
            "{} degrees of turning in all",
            "{:.0f}",
            "{} degrees of turning in all",
            lambda degrees: TURNING_SLACK * degrees,
        ),
        Quantity("steepest", "a steepest place of {} %", "{:.1f} %", "steepest {} percent", _percent, True),
        Quantity(
            "climb",
            "a climb of {} m",
            "{:.1f} m",
            "a net climb of {} metres",
            lambda m: max(LENGTH_SLACK * abs(m), 1.0),
            True,
        ),
        Quantity(
            "hills", "{} changes between climbing and falling", "{}", "{} changes of slope", lambda _: 0, True
        ),
        Quantity(
            "length", "a length of {} m", "{:.0f} m", "{} metres long in all", lambda m: ROAD_LENGTH_SLACK * m
        ),
        Quantity("radius", "a tightest place of {} m radius", "{:.1f} m", "", _metres),
    )
}
"""The quantities of a whole road, by name."""

FEATURE = {
    row.name: row
    for row in (
        Quantity("degrees", "{} degrees", "turns {:.0f} degrees", "of {} degrees", degrees_slack),
        Quantity(
            "radius",
            "radius {} m",
            "has a radius of {:.1f} m",
            "with a radius of {} metres",
            _metres,
            unit=" m",
        ),
        Quantity("length", "{} m long", "is {:.0f} m long", "of {} metres", _metres, unit=" m"),
        Quantity("grade", "slope {} %", "has a grade of {:.1f} %", "{} percent", _percent, True, " %"),
    )
}
"""The quantities of one turn or straight, by name."""

WHOLE_SLOPES = {"up": "climbs", "down": "falls", "flat": "is level"}
"""What the whole road does; it stands after 'the whole road' and 'a road that'."""
