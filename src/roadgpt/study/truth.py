"""Defines a truth: the requirements of a description, as people wrote them down before they saw a road.

The keys and their meaning are those of the project's referee, an independent judge of roads; tests compare
``holds`` with the referee, key by key. The guide docs/how-to/evaluate-roads.md describes the keys. To
check a road, a truth is converted to an Outline; requirements that a reader finds have the same form.
"""

from dataclasses import replace
from math import inf, nextafter
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field

from roadgpt.brief.model import Frozen
from roadgpt.brief.outline import Feature, Group, Outline
from roadgpt.brief.ranges import Range, overlap
from roadgpt.check.measures import Measures
from roadgpt.check.rules.promises import complaints

SLACK = 1e-9  # added to both ends of every range, as in the referee
SHORTEST = 20.0  # m; a shorter road meets no requirement
SLOPES = {
    "up": Range(1.0, inf),
    "down": Range(-inf, -1.0),
    "flat": Range(nextafter(-1.0, 0.0), nextafter(1.0, 0.0)),
}
FREE = Outline(groups=(), turns=Range())
"""An Outline without any requirement."""
CALLED = {"max_grade": "steepest", "hilly": "hills", "min_radius": "radius", "sequence": "groups"}
"""The fields of an Outline whose names differ from the keys of a Truth, by key."""


def _pair(value: Any) -> Any:
    """Returns a single number as both bounds."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return (value, value)
    return value


def _at_least(value: Any) -> Any:
    return (value, None) if isinstance(value, int) and not isinstance(value, bool) else value


def _ordered(value: "Span") -> "Span":
    low, high = value
    if low is None and high is None:
        raise ValueError("one of the two bounds must be a number")
    if low is not None and high is not None and low > high:
        raise ValueError(f"the bounds {low:g} and {high:g} are swapped")
    return value


Number = Annotated[float, Field(allow_inf_nan=False)]
Span = tuple[Number | None, Number | None]
Bounds = Annotated[Span, BeforeValidator(_pair), AfterValidator(_ordered)]
Slope = Literal["up", "down", "flat"]


class ExpectedElement(Frozen):
    """One turn or one straight that a description requires; a field that is None sets no requirement."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    kind: Literal["turn", "straight"]
    side: Annotated[Literal["left", "right"] | None, Field(alias="dir")] = None
    grade: Slope | None = None
    degrees: Annotated[Bounds | None, Field(alias="deg")] = None
    length: Annotated[Bounds | None, Field(alias="len")] = None
    radius: Bounds | None = None


class Truth(Frozen):
    """The requirements that a road must meet; each key that is not None is checked separately."""

    turns: Bounds | None = None
    left: Bounds | None = None
    right: Bounds | None = None
    grade: Slope | None = None
    sequence: tuple[ExpectedElement, ...] | None = None
    """All turns in order, and the straights that the description requires between them."""
    ends: ExpectedElement | None = None
    starts: ExpectedElement | None = None
    alternating: Literal[True] | None = None
    max_grade: Bounds | None = None
    """Grade of the steepest 10 m of the road, uphill or downhill, in percent."""
    climb: Bounds | None = None
    length: Bounds | None = None
    hilly: Annotated[Bounds | None, BeforeValidator(_at_least)] = None
    """Number of changes between uphill and downhill; a single number is a minimum."""
    min_radius: Bounds | None = None
    """Smallest radius of the road, metres."""
    turning: Bounds | None = None
    """Sum of the absolute changes of heading, degrees."""

    def given(self) -> tuple[str, ...]:
        """Returns the names of the keys that are not None."""
        return tuple(name for name in type(self).model_fields if getattr(self, name) is not None)

    def outline(self, *keys: str) -> Outline:
        """Returns an Outline with the requirements of the given keys, by default of all keys that are not
        None.

        The key ``sequence`` lists all turns of the road, so it also sets their number. If the key ``turns``
        is 0, the road may still have slight bends: an Outline excludes slight bends only if its range is
        exactly 0 turns, but SLACK widens every range. Use the key ``turning`` to limit the bends.
        """
        asked = {CALLED.get(key, key): _asked(getattr(self, key)) for key in keys or self.given()}
        if "groups" in asked:
            turns = sum(group.feature.kind == "turn" for group in asked["groups"])
            asked["turns"] = overlap(_asked((turns, turns)), asked.get("turns"))
        return replace(FREE, **asked)


def _asked(value: Any) -> Any:
    """Converts the value of a key of a Truth to the value that an Outline uses for it."""
    if isinstance(value, ExpectedElement):
        return Feature(
            value.kind,
            value.kind,
            side=value.side,
            degrees=_asked(value.degrees),
            radius=_asked(value.radius),
            length=_asked(value.length),
            grade=SLOPES[value.grade] if value.grade else None,
        )
    if not isinstance(value, tuple):
        return value
    if all(isinstance(each, ExpectedElement) for each in value):
        return tuple(Group(_asked(each)) for each in value)
    low, high = value
    return Range(-inf if low is None else low - SLACK, inf if high is None else high + SLACK)


def holds(found: Measures, truth: Truth) -> dict[str, bool]:
    """Returns, for each key of a truth, whether a measured road meets it. A road shorter than 20 m meets
    no key."""
    return {
        key: found.length >= SHORTEST and not complaints(found, truth.outline(key)) for key in truth.given()
    }
