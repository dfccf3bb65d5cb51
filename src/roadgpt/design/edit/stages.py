"""Orders the changes of a request that cannot all be made at once.

``directions`` splits a request where it reverses the road; places behind that are named on the reversed road.
``stages`` orders the changes between: what is named by distances comes before what makes distances others,
then moves, swaps, additions and removals in the order of the request, then crests and dips, then heights.
Between two stages, ``renamed`` measures the road and gives its elements the names that they had, and
``carried_over`` finds the elements of a change among them.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import NamedTuple

from roadgpt.brief.change.request import NUMBERING, OF_SLOPE, REORDERS, Change
from roadgpt.check.measures import Measures
from roadgpt.design.edit.placing import PlacedChange
from roadgpt.design.fit import Look
from roadgpt.design.road_elements import RoadElement, RoadElements, elements_on_road
from roadgpt.errors import EditError
from roadgpt.road import Geometry


class Named(NamedTuple):
    """The elements of a road, and where to find those of the road before the edit."""

    elements: RoadElements
    found: Measures
    by_name: Mapping[str, RoadElement]
    """By the name of each element before the edit, the element of which it is a part now; removed turns are
    missing."""


def directions(changes: Sequence[Change]) -> Iterator[tuple[Change, ...]]:
    """Yields the changes of a request in groups; a change that reverses the road is a group of its own."""
    for _, group in groupby(changes, lambda change: change.what == "reverse"):
        yield tuple(group)


def stages(changes: Sequence[PlacedChange]) -> list[list[PlacedChange]]:
    """Returns changes of one direction in stages; the changes of a stage can be made at once."""
    order = [
        each for each in changes if each.change.what in (*NUMBERING, *REORDERS) and not each.change.is_hill
    ]
    hills = [each for each in changes if each.change.is_hill]
    climbs = sorted(filter(_is_last, changes), key=lambda each: len(each.elements))
    values = [each for each in changes if each not in (*order, *hills, *climbs)]
    groups = [list(group) for _, group in groupby(order, _kind_of_order)]
    is_by_distance = any(each.stretch is not None for each in values)
    if groups and not is_by_distance:
        groups[0] = [each for each in changes if each in values or each in groups[0]]
    else:
        groups.insert(0, values)
    return [group for group in (*groups, hills, *([each] for each in climbs)) if group]


def _is_last(placed: PlacedChange) -> bool:
    """Returns whether a change gives a height that must hold when all else is done."""
    return placed.change.what == "climb" and placed.stretch is None


def _kind_of_order(placed: PlacedChange) -> str:
    change = placed.change
    if change.is_whole:  # how much straight there is already is known once other changes are made
        return "whole"
    return "order" if change.what in REORDERS else "number"


def with_final_heights(changes: Sequence[PlacedChange]) -> list[PlacedChange]:
    """Returns the changes; a height that is given by a difference or a factor becomes the height that it
    makes of the one before the edit.

    Raises:
        EditError: a place has a height and a slope, or two heights.
    """
    out = []
    for placed in changes:
        change = placed.change
        if _is_last(placed):
            _refuse_given_twice(placed, changes)
            is_one = change.is_of_road or len(placed.elements) == 1
            aim = change.aim(_rise(placed.elements)) if is_one and not change.bound else None
            if aim is not None:
                change = replace(change, to=aim, by=None, times=None, more=0)
        out.append(placed._replace(change=change))
    return out


def _refuse_given_twice(placed: PlacedChange, changes: Sequence[PlacedChange]) -> None:
    own = {element.name for element in placed.elements}
    for other in changes:
        if other is placed or other.change.what not in OF_SLOPE or other.stretch is not None:
            continue
        theirs = {element.name for element in other.elements}
        is_open = other.change.what == "slope" and other.change.to is None and other.change.way != "flat"
        if own <= theirs and not (own < theirs or is_open):
            raise EditError(
                f"'{placed.change.words}' and '{other.change.words}' each give the same part of the road its "
                "slopes; leave one of them out"
            )


def _rise(elements: Sequence[RoadElement]) -> float:
    """Returns the metres that elements climb in total."""
    return sum(element.incline * element.length / 100 for element in elements)


def carried_over(
    placed: PlacedChange, now: Named, before: RoadElements, others: Sequence[PlacedChange]
) -> PlacedChange:
    """Returns a change with the elements that it refers to on the road after an earlier stage.

    Parts of a road that has to reach a height keep the slopes that ``others`` give them.

    Raises:
        EditError: an earlier stage removed one of the elements.
    """

    def found(elements: Sequence[RoadElement]) -> RoadElements:
        return tuple(dict.fromkeys(_found(element, now, placed.change) for element in elements))

    if _is_last(placed):
        own = found([e for e in placed.elements if e.name in now.by_name or not placed.change.is_of_road])
        if not placed.change.is_of_road:
            return placed._replace(elements=own)
        own = _all_between(own, now.elements, is_to_end=before[-1] in placed.elements)
        return _without_told_slopes(placed._replace(elements=own), now, others)
    stop = found([placed.stop])[0] if placed.stop else None
    return placed._replace(elements=found(placed.elements), marks=found(placed.marks), stop=stop)


def _found(element: RoadElement, now: Named, change: Change) -> RoadElement:
    there = now.by_name.get(element.name)
    if there is None or there.is_turn != element.is_turn:
        raise EditError(f"'{change.words}' speaks of something that the same request removes; leave one out")
    return there


def _all_between(own: RoadElements, elements: RoadElements, is_to_end: bool) -> RoadElements:
    """Returns all elements from the first of ``own`` to the last, or to the end of the road."""
    at = [elements.index(element) for element in own]
    return elements[min(at) : len(elements) if is_to_end else max(at) + 1]


def _without_told_slopes(placed: PlacedChange, now: Named, others: Sequence[PlacedChange]) -> PlacedChange:
    own = {element.name for element in placed.elements}
    kept: set[str] = set()
    for other in others:
        if other.change.what in OF_SLOPE and other.change is not placed.change and other.stretch is None:
            there = {now.by_name[e.name].name for e in other.elements if e.name in now.by_name}
            kept |= there if there < own else set()
    change, rest = placed.change, [e for e in placed.elements if e.name not in kept]
    if change.to is None or not rest:
        return placed
    rise = _rise([element for element in placed.elements if element.name in kept])
    return placed._replace(change=replace(change, to=change.to - rise), elements=tuple(rest))


def renamed(road: Look, geometry: Geometry, stage: int) -> Named:
    """Measures a road after a stage; its elements have the names of those of the Look."""
    elements, found = elements_on_road(road.design, geometry)
    turns = iter([element for element in road.elements if element.is_turn])
    names, by_name = list[str](), dict[str, str]()
    for element in elements:
        if element.is_turn:
            names.append(next(turns).name)
            by_name[names[-1]] = names[-1]
            continue
        parts = [
            old for old in road.elements if not old.is_turn and old.segments and old.first in element.members
        ]
        longest = max(parts, key=lambda part: part.length, default=None)
        names.append(longest.name if longest else f"{element.name} of stage {stage}")
        by_name |= {part.name: names[-1] for part in parts}
    out = tuple(replace(element, name=name) for element, name in zip(elements, names, strict=True))
    index = {element.name: element for element in out}
    return Named(out, found, {old: index[new] for old, new in by_name.items()})


def known(elements: RoadElements, found: Measures) -> Named:
    """Returns the elements of the road before the edit, by their own names."""
    return Named(elements, found, {element.name: element for element in elements})


__all__ = ["Named", "carried_over", "directions", "known", "renamed", "stages", "with_final_heights"]
