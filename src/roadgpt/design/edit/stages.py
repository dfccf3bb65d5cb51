"""Orders the changes of a request that cannot all be made at once, and settles those of the same property.

``directions`` splits a request where it reverses the road; places behind that are named on the reversed road.
``stages`` orders the changes between: what is named by distances comes before what makes distances others,
then moves, swaps, additions and removals in the order of the request, then what ends the road, slopes that
new parts have as well, crests and dips, and heights. Between two stages, ``renamed`` measures the road and
gives its elements the names that they had, and ``carried_over`` finds the elements of a change among them.

Of two changes of the same property, a part of the road keeps its own wish, and opposites are refused. Metres
of height hold when all else is done: a part with a slope or a height of its own keeps that, and the rest of
the road makes up the height."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, groupby
from typing import NamedTuple

from roadgpt.brief.change.clashes import clash
from roadgpt.brief.change.request import NUMBERING, OF_SLOPE, REORDERS, Change, Target, What
from roadgpt.check.measures import Measures
from roadgpt.design.edit.insertion import NEW, STRAIGHT
from roadgpt.design.edit.places import PlacedChange
from roadgpt.design.fit import Look
from roadgpt.design.road_elements import RoadElement, RoadElements, elements_on_road
from roadgpt.errors import EditError
from roadgpt.road import Geometry

VALUED: frozenset[What] = frozenset({"angle", "radius", "length"})
TOGGLES: frozenset[What] = frozenset({"mirror", "swap", "alternate"})
"""Changes of which the second one would undo the first, or do nothing."""
KINDS = ("value", "order", "whole", "slope", "hill", "height")


def settled(changes: Sequence[PlacedChange]) -> tuple[PlacedChange, ...]:
    """Returns the changes, each without the elements that another change of the same property names alone,
    and what would undo itself, such as "mirror", only once.

    "All turns by 10 degrees, turn 2 by 20" turns turn 2 by 20 degrees only. Limits hold for all their
    elements but those that get a value inside them. ``search`` lays slopes of parts over those of more of the
    road. Raises EditError if two changes ask for opposite things of the same elements."""
    once = [*changes]
    for one, other in combinations(changes, 2):
        if _place(one) != _place(other) or not are_opposites(one.change, other.change):
            continue
        if replace(one.change, words="") != replace(other.change, words=""):
            said = f"'{one.change.words}' and '{other.change.words}'"
            raise EditError(f"{said} contradict each other; leave one of them out")
        once = [placed for placed in once if placed is not other]
    return tuple(_without_parts(placed, changes) for placed in once)


def are_opposites(one: Change, other: Change) -> bool:
    """Returns whether two changes of the same elements cannot both be meant."""
    if one.what != other.what:
        return False
    if one.what in TOGGLES or (one.what == "side" and (one.side is None or one.side != other.side)):
        return True
    if one.what == "shape":
        return _differ(one.kind, other.kind) or _differ(one.sharpness, other.sharpness)
    if one.is_state and other.is_state:
        return _differ(one.way, other.way) or _differ(one.to, other.to)
    if one.bound or other.bound:
        return _are_apart(one, other)
    return _direction(one) * _direction(other) < 0


def _differ(one: object, other: object) -> bool:
    return one is not None and other is not None and one != other


def _are_apart(one: Change, other: Change) -> bool:
    """Returns whether a limit excludes a value, or two limits leave no value between them."""
    if one.to is None or other.to is None or one.bound == other.bound:
        return False
    return (other.bound != 0 or other.is_state) and (
        one.is_outside(other.to) if one.bound else other.is_outside(one.to)
    )


def _direction(change: Change) -> float:
    """Returns a number above 0 if a change makes a value larger, below 0 if smaller, and 0 if neither."""
    factor = change.times - 1 if change.times is not None and change.times > 0 else 0.0
    return change.more or factor


def _place(placed: PlacedChange) -> Hashable:
    """Returns what is equal for two changes of the same place: the whole road, or the same parts of the same
    elements, such as their first half or what climbs of them."""
    target = placed.change.target
    if target is None:
        return None
    return frozenset(each.name for each in placed.elements), placed.stretch, target.way


def _without_parts(placed: PlacedChange, changes: Sequence[PlacedChange]) -> PlacedChange:
    own = placed.change
    if own.what not in VALUED or own.is_of_road:
        return placed
    others = [other for other in changes if other.change.what == own.what and not other.change.bound]
    if not own.bound:
        return placed.without(others)
    values = [other for other in others if other.change.is_state and other.change.to is not None]
    within = [other for other in values if not own.is_outside(other.change.to or 0.0)]
    valued = {each.name for other in within for each in other.elements}
    return placed._replace(elements=tuple(each for each in placed.elements if each.name not in valued))


def is_final(placed: PlacedChange) -> bool:
    """Returns whether a change gives a height that must hold when all else is done."""
    return placed.change.what == "climb" and placed.stretch is None


def with_final_heights(changes: Sequence[PlacedChange]) -> list[PlacedChange]:
    """Returns the changes. A height that is given by a difference or a factor becomes the height that this
    makes of the one before the edit, and heights of several straights or turns become changes of their own.
    Raises EditError if two heights, or a height and a slope, cannot both be meant or be made together."""
    for placed in changes:
        if placed.change.what == "climb":
            _refuse_clashing_heights(placed, [other for other in changes if other is not placed])
    return [each for placed in changes for each in (_settled(placed) if is_final(placed) else [placed])]


def _settled(placed: PlacedChange) -> Iterator[PlacedChange]:
    parts = [placed.elements] if placed.change.is_of_road else [(element,) for element in placed.elements]
    for elements in parts:
        change = placed.change
        aim = None if change.bound else change.aim(rise_of(elements))
        if aim is not None:
            change = replace(change, to=aim, by=None, times=None, more=0)
        yield placed._replace(change=change, elements=elements)


def _refuse_clashing_heights(placed: PlacedChange, others: Sequence[PlacedChange]) -> None:
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
    """Returns a height of a part of the road without the elements named ``told``, which keep their slopes."""
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


class Named(NamedTuple):
    """The elements of a road, and where to find those of the road before the edit."""

    elements: RoadElements
    found: Measures
    by_name: Mapping[str, RoadElement]
    """By the name of each element before the edit, the element of which it is a part now; a turn that was
    removed is missing."""


def directions(changes: Sequence[Change]) -> list[tuple[Change, ...]]:
    """Returns the changes of a request in groups; a change that reverses the road is a group of its own."""
    groups = [tuple(group) for _, group in groupby(changes, lambda change: change.what == "reverse")]
    if any(group[0].what == "reverse" and len(group) > 1 for group in groups):
        raise EditError(
            "the road is reversed twice, which leaves it as it is; leave one of the reversals out"
        )
    return groups


def stages(changes: Sequence[PlacedChange]) -> list[list[PlacedChange]]:
    """Returns changes of one direction in stages; the changes of a stage can be made at once. Raises
    EditError if a change removes what another one moves, or gives the straight of a crest another slope."""
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
    """Returns a change with the elements that it refers to on the road after an earlier stage. Parts of a
    road that has to reach a height keep the slopes that ``others`` give them. Raises EditError if an earlier
    stage removed or split one of the elements, or nothing is left that could climb."""

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
    of the road that it reaches."""
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
    Straights that a removal joined have the name of the longest of those that were there before the edit."""
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
