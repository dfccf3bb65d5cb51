"""Takes the value of a change from another place of the road: "as long as the first straight"."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from roadgpt.brief.change.clashes import clash
from roadgpt.brief.change.request import Change, Way, What
from roadgpt.check.measures import way
from roadgpt.design.road_elements import RoadElement
from roadgpt.errors import EditError

RELATED: Mapping[What, frozenset[What]] = {
    "angle": frozenset({"shape", "length", "straighten"}),
    "radius": frozenset({"shape", "length", "straighten"}),
    "length": frozenset({"angle", "radius", "shape", "straighten"}),
    "slope": frozenset({"climb"}),
}
"""The changes that also change another property."""


def with_value_of(change: Change, model: RoadElement, others: Sequence[Change] = ()) -> Change:
    """Returns the change with the value of the element that it names as its model.

    That is the value before the edit, or the new one if another change of the request gives the model one.

    Args:
        change: a change of an angle, a radius, a length or a slope.
        model: the element with which the request compares.
        others: the other changes of the model.

    Raises:
        EditError: the request compares with a straight where only turns have a value, or the value that
            another change gives the model is not known beforehand.
    """
    if change.what in ("angle", "radius") and not model.is_turn:
        raise EditError(f"'{change.words}' compares with a straight, which does not bend; name a turn")
    value, direction = _value(change, model)
    for other in others:
        if other.what in RELATED[change.what]:
            raise clash(change, other)
        if other.what == change.what:
            value, direction = _new_value(change, other, value, direction)
    if change.what != "slope":
        return replace(change, like=None, to=value)
    if change.bound:
        return replace(change, like=None, to=abs(value))
    direction = change.way or direction
    return replace(change, like=None, way=direction, to=None if direction == "flat" else abs(value))


def _value(change: Change, model: RoadElement) -> tuple[float, Way | None]:
    """Returns what a model measures, exactly for a limit and rounded otherwise, and the way of its slope."""
    seen = model.seen
    assert seen is not None
    measures = {"angle": seen.degrees, "radius": seen.radius, "length": seen.length, "slope": seen.grade}
    value = measures[change.what]
    return value if change.bound else round(value, 1), way(value) if change.what == "slope" else None


def _new_value(
    change: Change, other: Change, value: float, direction: Way | None
) -> tuple[float, Way | None]:
    """Returns the value and the way of a model that another change has given it."""
    if other.way == "flat":
        return 0.0, "flat"
    if other.to is not None:
        if other.bound and not other.is_outside(abs(value)):
            return value, direction
        level = None if direction == "flat" else direction
        return other.to, other.way or level
    if change.what != "slope" and other.by is not None:
        return value + other.more * other.by, None
    if change.what != "slope" and other.times is not None:
        return value * other.times, None
    raise clash(change, other)
