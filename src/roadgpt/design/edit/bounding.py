"""Bounds: 'no steeper than 6 %' changes only what is steeper."""

from collections.abc import Sequence

from roadgpt.check.measures import Measures
from roadgpt.design.edit.request import Change
from roadgpt.design.edit.sloping import SlopeOfAll
from roadgpt.design.edit.steps import EditStep
from roadgpt.design.road_elements import RoadElement


def is_beyond(change: Change, element: RoadElement, found: Measures) -> bool:
    """Returns whether an element is beyond the bound of a change."""
    assert change.to is not None
    seen = element.seen
    if change.what == "slope":
        slopes = [abs(segment.incline) for segment in element.segments]
        return any((now - change.to) * change.bound < 0 for now in slopes)
    if seen is None:
        return False
    if change.target is not None and change.target.noun == "road" and change.what == "length":
        now = found.length
    else:
        now = {"angle": seen.degrees, "radius": seen.radius, "length": seen.length}[change.what]
    return (now - change.to) * change.bound < 0


def within(change: Change, elements: Sequence[RoadElement]) -> tuple[tuple[EditStep, ...], ...]:
    """Returns the candidates that bring slopes within the bound of a change."""
    assert change.to is not None
    names = frozenset(element.name for element in elements)
    if change.bound < 0:
        return ((SlopeOfAll(names, low=-change.to, high=change.to),),)
    up = sum(element.incline * element.length for element in elements) >= 0
    return ((SlopeOfAll(names, way=1 if up else -1, low=change.to),),)
