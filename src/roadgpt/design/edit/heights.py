"""Settles metres of height beside other changes of a request: they hold when all else is done.

A part of the road with a slope or a height of its own keeps that; the rest of the road makes up the height.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from roadgpt.brief.change.clashes import clash
from roadgpt.brief.change.request import OF_SLOPE
from roadgpt.design.edit.placing import PlacedChange
from roadgpt.design.road_elements import RoadElement
from roadgpt.errors import EditError


def is_final(placed: PlacedChange) -> bool:
    """Returns whether a change gives a height that must hold when all else is done."""
    return placed.change.what == "climb" and placed.stretch is None


def with_final_heights(changes: Sequence[PlacedChange]) -> list[PlacedChange]:
    """Returns the changes. A height that is given by a difference or a factor becomes the height that this
    makes of the one before the edit, and heights of several straights or turns become changes of their own.

    Raises:
        EditError: two heights, or a height and a slope, cannot both be meant or be made together.
    """
    for placed in changes:
        if placed.change.what == "climb":
            _refuse_conflicts(placed, [other for other in changes if other is not placed])
    return [each for placed in changes for each in (_settled(placed) if is_final(placed) else [placed])]


def _settled(placed: PlacedChange) -> Iterator[PlacedChange]:
    parts = [placed.elements] if placed.change.is_of_road else [(element,) for element in placed.elements]
    for elements in parts:
        change = placed.change
        aim = None if change.bound else change.aim(rise_of(elements))
        if aim is not None:
            change = replace(change, to=aim, by=None, times=None, more=0)
        yield placed._replace(change=change, elements=elements)


def _refuse_conflicts(placed: PlacedChange, others: Sequence[PlacedChange]) -> None:
    if placed.stretch is not None and others:
        raise clash(placed.change, others[0].change)
    own = {element.name for element in placed.elements}
    for other in others:
        change, theirs = other.change, {element.name for element in other.elements}
        is_new_slope = change.what == "add" and bool(change.way or change.grade is not None)
        if (change.is_hill and theirs <= own) or (is_new_slope and placed.change.is_of_road):
            raise clash(placed.change, change)
        is_same = replace(change, words="") == replace(placed.change, words="")
        if change.what not in OF_SLOPE or is_same or own.isdisjoint(theirs):
            continue
        if other.stretch is not None or not (own < theirs or theirs < own):
            _refuse_unless_same_way(placed, other)
        elif own < theirs and (change.bound or (change.what == "climb" and not change.is_of_road)):
            raise clash(placed.change, change)


def _refuse_unless_same_way(placed: PlacedChange, other: PlacedChange) -> None:
    """Refuses a height beside a slope of the same part, unless the slope only says "uphill" or "downhill"."""
    height, slope = placed.change, other.change
    is_open = (
        slope.what == "slope" and slope.way in ("up", "down") and not slope.steepness and not slope.bound
    )
    if (
        not is_open
        or slope.to is not None
        or slope.more
        or other.stretch
        or placed.elements != other.elements
    ):
        raise EditError(
            f"'{height.words}' and '{slope.words}' both give a part of the road its slopes; leave one "
            "of them out, or make one change first"
        )
    aim = height.aim(rise_of(placed.elements))
    if aim is None or aim * slope.sign <= 0:
        raise EditError(f"'{height.words}' and '{slope.words}' contradict each other; leave one of them out")


def rise_of(elements: Sequence[RoadElement]) -> float:
    """Returns the metres that elements climb in total."""
    return sum(element.incline * element.length / 100 for element in elements)


def without_told(placed: PlacedChange, told: set[str]) -> PlacedChange:
    """Returns a height of a part of the road without the elements named ``told``, which keep their slopes.

    Raises:
        EditError: no element is left to make up the height.
    """
    rest = tuple(element for element in placed.elements if element.name not in told)
    if len(rest) == len(placed.elements):
        return placed
    if not rest or placed.change.to is None:
        raise EditError(
            f"'{placed.change.words}' leaves nothing that could climb, since all its parts have slopes of "
            "their own; leave one of them out"
        )
    kept = rise_of([element for element in placed.elements if element.name in told])
    return placed._replace(change=replace(placed.change, to=placed.change.to - kept), elements=rest)
