"""Checks which criteria of a description a road meets: the criteria of the thesis' survey, and ``extent``.

    turns     the number of all turns, of left turns and of right turns
    incline   the grade of the whole road, and of each turn and straight
    order     the directions (left or right) of the turns, the positions of the straights, the first and the
              last element
    extent    angles, radii and lengths
    general   all requirements of the description together

A criterion that the description does not mention is left out. A road with a wrong number of turns meets
neither the criterion ``order`` nor requirements on the incline or the extent of individual turns.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from roadgpt.brief.outline import Feature, Group, Outline
from roadgpt.brief.words import KINDS
from roadgpt.check.measures import Measures
from roadgpt.check.rules.promises import complaints
from roadgpt.study.truth import FREE, SHORTEST

Criterion = Literal["turns", "incline", "order", "extent", "general"]
CRITERIA: tuple[Criterion, ...] = ("turns", "incline", "order", "extent", "general")
ASKED = {
    "turns": "number of turns",
    "incline": "incline",
    "order": "order of turns and straights",
    "extent": "angles, radii, lengths",
    "general": "in general: all at once",
}
"""Names of the criteria in reports."""

FIELDS: Mapping[Criterion, tuple[str, ...]] = {
    "turns": ("turns", "left", "right"),
    "incline": ("grade", "grade_range", "steepest", "climb", "hills"),
    "order": ("alternating",),
    "extent": ("each_turn", "length", "radius", "turning"),
}
"""The fields of an Outline that set requirements for the whole road or for every turn, by criterion."""

FEATURE_FIELDS: Mapping[Criterion, tuple[str, ...]] = {
    "incline": ("grade",),
    "order": ("side",),
    "extent": ("degrees", "radius", "length"),
}
"""The fields of a Feature that set requirements for one turn or straight, by criterion."""


def criteria_of(found: Measures, asked: Outline) -> dict[Criterion, bool]:
    """Returns, for each criterion of an Outline, whether a measured road meets it.

    The Outline contains either the requirements that people wrote down in a Truth, or the requirements that a
    reader found in a description. A road shorter than 20 m meets no criterion.
    """
    out: dict[Criterion, bool] = {}
    for criterion, fields in FIELDS.items():
        own = {name: getattr(asked, name) for name in fields}
        if any(value != getattr(FREE, name) for name, value in own.items()):
            out[criterion] = not complaints(found, replace(FREE, **own))
    for criterion, good in _of_features(found, asked).items():
        out[criterion] = out.get(criterion, True) and good
    out["general"] = not complaints(found, asked)
    return {criterion: good and found.length >= SHORTEST for criterion, good in out.items()}


def _of_features(found: Measures, asked: Outline) -> dict[Criterion, bool]:
    """Returns the criteria of individual turns and straights, each checked without the other criteria."""
    out: dict[Criterion, bool] = {}
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
            good = not says or _has_sequence(found, tuple(wanted))
            at_ends = replace(FREE, starts=first, ends=last)
            out[criterion] = good and (not ends_say or not complaints(found, at_ends))
    return out


def _part(feature: Feature, fields: tuple[str, ...]) -> Feature:
    """Returns a feature with only the requirements ``fields``, less those that every straight has to meet."""
    own = {name: getattr(feature, name) for name in fields}
    if feature.kind == "straight":
        usual = KINDS["straight"]
        own = {name: asked for name, asked in own.items() if asked != getattr(usual, name, None)}
    return Feature(feature.kind, feature.name, **own)


def _says(feature: Feature) -> bool:
    """Returns whether a feature sets any requirement."""
    return feature != Feature(feature.kind, feature.name)


def _has_sequence(found: Measures, groups: tuple[Group, ...]) -> bool:
    """Returns whether a road has the turns of the groups in the given order, with the required straights
    between them.

    If every group names exactly one element, the road must not have more turns.
    """
    turns = sum(group.feature.kind == "turn" for group in groups)
    if len(found.turns) != turns and all(group.lo == group.hi == 1 for group in groups):
        return False
    return not complaints(found, replace(FREE, groups=groups))
