"""Defines a truth: the requirements of a description, as people wrote them down before they saw a road; and
the criteria of a description that a road meets.

The keys and their meaning are those of the project's referee, an independent judge of roads; tests compare
``holds`` with the referee, key by key. The guide docs/how-to/evaluate-roads.md describes the keys. To check a
road, a truth is converted to an Outline; requirements that a reader finds have the same form.

The criteria are those of the thesis' survey, and ``extent``:

    turns     the number of all turns, of left turns and of right turns
    incline   the grade of the whole road, and of each turn and straight
    order     the directions (left or right) of the turns, the positions of the straights, the first and the
              last element
    extent    angles, radii and lengths
    general   all requirements of the description together

A criterion that the description does not mention is left out. A road with a wrong number of turns meets
neither the criterion ``order`` nor requirements on the incline or the extent of individual turns."""

from collections.abc import Mapping
from dataclasses import replace
from math import inf, nextafter
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field

from roadgpt.brief.model import Frozen
from roadgpt.brief.outline import Feature, Group, Outline
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import KINDS
from roadgpt.check.matching import complaints
from roadgpt.check.measures import RoadMeasures

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
Number = Annotated[float, Field(allow_inf_nan=False)]
Span = tuple[Number | None, Number | None]
Slope = Literal["up", "down", "flat"]
KeptCriterion = Literal["turns", "incline", "order", "extent", "general"]
CRITERIA: tuple[KeptCriterion, ...] = ("turns", "incline", "order", "extent", "general")
ASKED = {
    "turns": "number of turns",
    "incline": "incline",
    "order": "order of turns and straights",
    "extent": "angles, radii, lengths",
    "general": "in general: all at once",
}
"""Names of the criteria in reports."""
FIELDS: Mapping[KeptCriterion, tuple[str, ...]] = {
    "turns": ("turns", "left", "right"),
    "incline": ("grade", "grade_range", "steepest", "climb", "hills"),
    "order": ("alternating",),
    "extent": ("each_turn", "length", "radius", "turning"),
}
"""The fields of an Outline that set requirements for the whole road or for every turn, by criterion."""
FEATURE_FIELDS: Mapping[KeptCriterion, tuple[str, ...]] = {
    "incline": ("grade", "bump"),
    "order": ("side",),
    "extent": ("degrees", "radius", "length"),
}
"""The fields of a Feature that set requirements for one turn or straight, by criterion."""


def _pair(value: Any) -> Any:
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


Bounds = Annotated[Span, BeforeValidator(_pair), AfterValidator(_ordered)]


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
    max_grade: Bounds | None = None  # grade of the steepest 10 m of the road, uphill or downhill, in percent
    climb: Bounds | None = None
    length: Bounds | None = None
    hilly: Annotated[Bounds | None, BeforeValidator(_at_least)] = None
    """Number of changes between uphill and downhill; a single number is a minimum."""
    min_radius: Bounds | None = None  # smallest radius of the road, metres
    turning: Bounds | None = None  # sum of the absolute changes of heading, degrees

    def given(self) -> tuple[str, ...]:
        """Returns the names of the keys that are not None."""
        return tuple(name for name in type(self).model_fields if getattr(self, name) is not None)

    def outline(self, *keys: str) -> Outline:
        """Returns an Outline with the requirements of the given keys, by default of all keys that are not
        None.

        The key ``sequence`` lists all turns of the road, so it also sets their number. If the key ``turns``
        is 0, the road may still have slight bends: an Outline excludes slight bends only if its range is
        exactly 0 turns, but SLACK widens every range. Use the key ``turning`` to limit the bends."""
        asked = {CALLED.get(key, key): _asked(getattr(self, key)) for key in keys or self.given()}
        if "groups" in asked:
            turns = sum(group.feature.kind == "turn" for group in asked["groups"])
            asked["turns"] = overlap(_asked((turns, turns)), asked.get("turns"))
        return replace(FREE, **asked)


def _asked(value: Any) -> Any:
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


def holds(found: RoadMeasures, truth: Truth) -> dict[str, bool]:
    """Returns, for each key of a truth, whether a measured road meets it; a road below 20 m meets none."""
    return {
        key: found.length >= SHORTEST and not complaints(found, truth.outline(key)) for key in truth.given()
    }


def criteria_of(found: RoadMeasures, asked: Outline) -> dict[KeptCriterion, bool]:
    """Returns, for each criterion of an Outline, whether a measured road meets it; a road below 20 m meets
    none. The Outline contains either the requirements that people wrote down in a Truth, or those that a
    reader found in a description."""
    out: dict[KeptCriterion, bool] = {}
    for criterion, fields in FIELDS.items():
        own = {name: getattr(asked, name) for name in fields}
        if any(value != getattr(FREE, name) for name, value in own.items()):
            out[criterion] = not complaints(found, replace(FREE, **own))
    for criterion, good in _of_features(found, asked).items():
        out[criterion] = out.get(criterion, True) and good
    out["general"] = not complaints(found, asked)
    return {criterion: good and found.length >= SHORTEST for criterion, good in out.items()}


def _of_features(found: RoadMeasures, asked: Outline) -> dict[KeptCriterion, bool]:
    """Returns the criteria of individual turns and straights, each checked without the other criteria."""
    out: dict[KeptCriterion, bool] = {}
    for criterion, fields in FEATURE_FIELDS.items():
        is_order = criterion == "order"
        wanted: list[Group] = []
        for group in asked.groups:
            part = _part(group.feature, fields)
            if part.kind == "straight" and wanted and wanted[-1].feature == part:
                continue  # neighbouring straights with the same requirements are one
            wanted.append(replace(group, feature=part, alternating=is_order and group.alternating))
        first, last = (each and _part(each, fields) for each in (asked.starts, asked.ends))
        # any straight, and whatever is at the ends, sets a requirement of the order
        says = any(
            (is_order and (group.alternating or group.feature.kind == "straight")) or _says(group.feature)
            for group in wanted
        )
        ends_say = any(each and (is_order or _says(each)) for each in (first, last))
        if says or ends_say:
            turns = sum(group.feature.kind == "turn" for group in wanted)
            is_exact = all(group.lo == group.hi == 1 for group in wanted)  # then the road has no more turns
            has_sequence = not (is_exact and len(found.turns) != turns) and not complaints(
                found, replace(FREE, groups=tuple(wanted))
            )
            good = not says or has_sequence
            at_ends = replace(FREE, starts=first, ends=last)
            out[criterion] = good and (not ends_say or not complaints(found, at_ends))
    return out


def _part(feature: Feature, fields: tuple[str, ...]) -> Feature:
    own = {name: getattr(feature, name) for name in fields}
    if feature.kind == "straight":
        usual = KINDS["straight"]
        own = {name: asked for name, asked in own.items() if asked != getattr(usual, name, None)}
    return Feature(feature.kind, feature.name, **own)


def _says(feature: Feature) -> bool:
    return feature != Feature(feature.kind, feature.name)
