"""Orders the changes of a request that cannot all be made at once.

``directions`` splits a request where it reverses the road; places behind that are named on the reversed road.
``stages`` orders the changes between: what is named by distances comes before what makes distances others,
then moves, swaps, additions and removals in the order of the request, then what ends the road, slopes that
new parts have as well, crests and dips, and heights. Between two stages, ``renamed`` measures the road and
gives its elements the names that they had, and ``carried_over`` finds the elements of a change among them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import NamedTuple

from roadgpt.brief.change.clashes import clash
from roadgpt.brief.change.request import NUMBERING, OF_SLOPE, REORDERS, Change, Target
from roadgpt.check.measures import Measures
from roadgpt.design.edit.heights import is_final, without_told
from roadgpt.design.edit.insertion import NEW, STRAIGHT
from roadgpt.design.edit.placing import PlacedChange
from roadgpt.design.fit import Look
from roadgpt.design.road_elements import RoadElement, RoadElements, elements_on_road
from roadgpt.errors import EditError
from roadgpt.road import Geometry

KINDS = ("value", "order", "whole", "slope", "hill", "height")


class Named(NamedTuple):
    """The elements of a road, and where to find those of the road before the edit."""

    elements: RoadElements
    found: Measures
    by_name: Mapping[str, RoadElement]
    """By the name of each element before the edit, the element of which it is a part now; a turn that was
    removed is missing."""


def directions(changes: Sequence[Change]) -> list[tuple[Change, ...]]:
    """Returns the changes of a request in groups; a change that reverses the road is a group of its own.

    Raises:
        EditError: the road is reversed twice in a row.
    """
    groups = [tuple(group) for _, group in groupby(changes, lambda change: change.what == "reverse")]
    if any(group[0].what == "reverse" and len(group) > 1 for group in groups):
        raise EditError(
            "the road is reversed twice, which leaves it as it is; leave one of the reversals out"
        )
    return groups


def stages(changes: Sequence[PlacedChange]) -> list[list[PlacedChange]]:
    """Returns changes of one direction in stages; the changes of a stage can be made at once.

    Raises:
        EditError: a change removes what another one moves, or gives the straight of a crest another slope.
    """
    _refuse_conflicts(changes)
    is_slope_last = _reaches_new_parts(changes)
    by_kind: dict[str, list[PlacedChange]] = {kind: [] for kind in KINDS}
    for each in changes:
        is_slope = is_slope_last and each.change.what == "slope"
        by_kind["slope" if is_slope else _kind(each)].append(each)
    # every move is judged on the road that the last one left
    groups = [
        list(group) for _, group in groupby(by_kind["order"], lambda each: _key_of_order(each, changes))
    ]
    groups += [by_kind["whole"]] if by_kind["whole"] else []
    if groups and not any(each.stretch is not None for each in by_kind["value"]):
        first = {id(each) for each in (*by_kind["value"], *groups[0])}
        groups[0] = [each for each in changes if id(each) in first]
    else:
        groups.insert(0, by_kind["value"])
    heights = sorted(by_kind["height"], key=lambda each: len(each.elements))
    last = by_kind["slope"], by_kind["hill"], *([each] for each in heights)
    return [group for group in (*groups, *last) if group]


def _reaches_new_parts(changes: Sequence[PlacedChange]) -> bool:
    """Returns whether a slope is that of the whole road, with what the same request adds to the road."""
    sloped = [each for each in changes if each.change.what == "slope"]
    is_of_all = any(_is_whole_road(each.change.target) for each in sloped)
    is_by_distance = any(each.stretch is not None for each in sloped)
    return is_of_all and not is_by_distance and any(_is_new_part(each.change) for each in changes)


def _is_whole_road(target: Target | None) -> bool:
    return target is None or target == Target("road", words=target.words)


def _is_new_part(change: Change) -> bool:
    return change.what == "add" and not change.is_hill


def _kind(placed: PlacedChange) -> str:
    if is_final(placed):
        return "height"
    if placed.change.is_hill:
        return "hill"
    if placed.change.is_whole:  # how much straight there is already is known once other changes are made
        return "whole"
    return "order" if placed.change.what in (*NUMBERING, *REORDERS) else "value"


def _key_of_order(placed: PlacedChange, changes: Sequence[PlacedChange]) -> int:
    """Returns a number that is equal for neighbouring changes which can be made at once."""
    is_alone = placed.change.what in REORDERS
    return next(i for i, each in enumerate(changes) if each is placed) if is_alone else -1


def _refuse_conflicts(changes: Sequence[PlacedChange]) -> None:
    gone = [each for each in changes if each.change.what in ("remove", "straighten")]
    for one in changes:
        own = {element.name for element in one.elements}
        if one.change.what in REORDERS:
            for other in gone:
                if not own.isdisjoint(element.name for element in other.elements):
                    raise _removed(one.change)
        if one.change.is_hill:
            for other in changes:
                if other.change.what == "slope" and {element.name for element in other.elements} <= own:
                    raise clash(one.change, other.change)


def carried_over(placed: PlacedChange, now: Named, others: Sequence[PlacedChange]) -> PlacedChange:
    """Returns a change with the elements that it refers to on the road after an earlier stage.

    Parts of a road that has to reach a height keep the slopes that ``others`` give them.

    Raises:
        EditError: an earlier stage removed or split one of the elements, or nothing is left that could climb.
    """

    def found(elements: Sequence[RoadElement]) -> RoadElements:
        return tuple(dict.fromkeys(_found(element, now, placed.change) for element in elements))

    if is_final(placed):
        return _height(placed, now, others)
    if placed.change.what == "slope" and _is_whole_road(placed.change.target) and placed.stretch is None:
        # what is new keeps a slope that is told of it
        told = any(_is_new_part(each.change) and each.change.way for each in others)
        own = tuple(each for each in now.elements if not (told and _is_new(each)))
        return placed._replace(elements=own)
    stop = found([placed.stop])[0] if placed.stop else None
    return placed._replace(elements=found(placed.elements), marks=found(placed.marks), stop=stop)


def _is_new(element: RoadElement) -> bool:
    """Returns whether an element is a new turn or straight, and not road that leads to one."""
    return element.name.startswith(NEW) and (element.is_turn or element.name.endswith(STRAIGHT))


def _found(element: RoadElement, now: Named, change: Change) -> RoadElement:
    there = now.by_name.get(element.name)
    if there is None or there.is_turn != element.is_turn:
        raise _removed(change)
    return there


def _removed(change: Change) -> EditError:
    return EditError(f"'{change.words}' speaks of something that the same request removes; leave one out")


def _height(placed: PlacedChange, now: Named, others: Sequence[PlacedChange]) -> PlacedChange:
    if not placed.change.is_of_road:
        own = tuple(_found(element, now, placed.change) for element in placed.elements)
        if any(element.name == f"{own[0].name} rest" for element in now.elements):
            raise EditError(f"'{placed.change.words}' speaks of a straight that the same request splits")
        return placed._replace(elements=own)
    own = _part(placed, now)
    named = {element.name for element in own}
    told = set[str]()
    for other in others:
        if other.change.what in OF_SLOPE and other.change is not placed.change:
            theirs = {now.by_name[e.name].name for e in other.elements if e.name in now.by_name}
            told |= theirs if theirs < named else set()
    return without_told(placed._replace(elements=own), told)


def _part(placed: PlacedChange, now: Named) -> RoadElements:
    """Returns the elements of a part of the road: with those that are new between its old ones, and at an end
    of the road that it reaches.
    """
    target, own = placed.change.target, now.elements
    if target is None or _is_whole_road(target):
        return own
    there = [now.by_name[element.name] for element in placed.elements if element.name in now.by_name]
    if not there:
        raise _removed(placed.change)
    if target.place is None or target.but or target.way:
        return tuple(dict.fromkeys(there))
    at, how = [own.index(element) for element in there], target.place.how
    first = 0 if how in ("before", "up_to") else min(at)
    return own[first : len(own) if how in ("after", "from") else max(at) + 1]


def renamed(road: Look, now: Named, geometry: Geometry, stage: int) -> Named:
    """Measures a road after a stage; its elements have the names that they had in ``now``, before it.

    Straights that a removal joined have the name of the longest of those that were there before the edit.
    """
    elements, found = elements_on_road(road.design, geometry)
    turns = iter([element for element in road.elements if element.is_turn])
    known = {element.name for element in now.by_name.values()}
    names, after = list[str](), dict[str, str]()
    for element in elements:
        if element.is_turn:
            parts = [next(turns)]
        else:
            gaps = [old for old in road.elements if not old.is_turn and old.segments]
            parts = [old for old in gaps if old.first in element.members]
        longest = max(parts, key=lambda part: (part.name in known, part.length), default=None)
        names.append(longest.name if longest else f"{element.name} of stage {stage}")
        after |= {part.name: names[-1] for part in parts}
    out = [replace(element, name=name) for element, name in zip(elements, names, strict=True)]
    index = {element.name: element for element in out}
    before = {old: element.name for old, element in now.by_name.items()}
    return Named(
        tuple(out), found, {old: index[after[name]] for old, name in before.items() if name in after}
    )


def unchanged(elements: RoadElements, found: Measures) -> Named:
    """Returns the elements of the road before the edit, by their own names."""
    return Named(elements, found, {element.name: element for element in elements})
