"""Edits a Design as a change request asks, and leaves the rest unchanged. Main function: ``edit``.

    words --checked_request--> EditRequest --placed, settled--> PlacedChanges
          --candidates_of--> ChangeCandidates --made--> FittedRoad --sentences--> Edited

A FittedRoad is a Design with the road built from it, the findings of the rules, and measurements. Turns
and straights are those that ``check.measures`` finds on the finished road. They are numbered as on the road
before the edit. Elements that the request does not name keep all their values, but the road as a whole may be
shifted or rotated, so that it stays inside the map.

``directions`` splits a request where it reverses the road; places behind that are named on the reversed road.
``stages`` orders the changes between that cannot all be made at once: what is named by distances comes before
what makes distances others, then moves, swaps, additions and removals in the order of the request, then what
ends the road, slopes that new parts have as well, crests and dips, and heights. Between two stages,
``renamed`` measures the road and gives its elements the names that they had, and ``carried_over`` finds the
elements of a change among them.

Of two changes of the same property, a part of the road keeps its own wish, and opposites are refused. Metres
of height hold when all else is done: a part with a slope or a height of its own keeps that, and the rest of
the road makes up the height."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import combinations, groupby, product
from typing import NamedTuple

import numpy as np

from roadgpt.brief.beside import friction_of
from roadgpt.brief.change import EditRequest, checked_request, other_readings, read_request
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.change.request import (
    NUMBERING,
    OF_SLOPE,
    REORDERS,
    Change,
    SceneChange,
    Target,
    What,
    clash,
)
from roadgpt.brief.change.staging import changed_scene
from roadgpt.brief.readers.model.trained import DOUBT
from roadgpt.brief.scene import land_remark, parts_said, scene_text
from roadgpt.chat import ChatSettings
from roadgpt.check.measures import MeasuredFeature, RoadMeasures, ups_and_downs, way
from roadgpt.errors import EditError, IdleEditError, UnclearPlaceError
from roadgpt.language.table import SURFACES
from roadgpt.road import Design, Geometry, Segment, Site, World, build
from roadgpt_edit.candidates import RENAMED, candidates_of, made, sentence_of
from roadgpt_edit.fit import FittedRoad
from roadgpt_edit.places import PlacedChange, placed
from roadgpt_edit.road_elements import RoadElement, RoadElements, elements_on_road, features_of
from roadgpt_edit.ways import NEW, STRAIGHT

ALL_LISTED = 60  # changed segments; of more, only the number is given
MOVED = 0.005  # m
PLACES = 200  # heights that the ups and downs of a stretch are seen in
KMH = 3.6
FADING = 12.0  # m that a straight gains at most from turns that fade into it


def sentences(
    before: Design,
    elements: RoadElements,
    found: RoadMeasures,
    after: FittedRoad,
    fitted: Sequence[tuple[Design, Design]] = (),
) -> tuple[str, ...]:
    """Returns a sentence for each turn and straight that has changed, and for the road as a whole.

    ``elements`` and ``found`` are those of the road before the edit. If the FittedRoad after the edit
    has no elements, the sentences give the number of turns before and after the edit, and describe each turn
    after it. ``fitted`` holds each edited design before further segments were changed to keep the road valid,
    and after that."""
    new = after.found
    things = _things(elements, after.elements, new) if after.elements else _counted(found, new)
    lengths = f"{found.length:.0f} -> {new.length:.0f}"
    climbs = " -> ".join(ups_and_downs(each.line.z) for each in (found, new))
    whole = f"the road: {lengths} m long, climbs {climbs} m"
    besides = ["; ".join(_changed_segments(*pair)) for pair in fitted]
    valid = [f"to keep it valid: {said}" for said in besides if said]
    return (*things, whole, *_placing(before, after.design), *valid)


def grades_changed(
    before: Design, after: Design, stretches: Sequence[tuple[float, float]], geometry: Geometry
) -> Iterator[str]:
    """Yields a sentence on the mean grade, ups and downs of each stretch of a road before and after an edit.
    Each stretch is a pair of stations in metres, valid for both roads. One named twice counts once."""
    for start, end in dict.fromkeys(stretches):
        grades, climbs = [], []
        for design in (before, after):
            road = build(design, geometry)
            z = road.elevation.height(np.linspace(start, min(end, road.length), PLACES))
            grades.append(100 * float(z[-1] - z[0]) / (end - start))
            climbs.append(ups_and_downs(z))
        grade, climb = f"grade {grades[0]:+.1f} -> {grades[1]:+.1f} %", f"climbs {climbs[0]} -> {climbs[1]} m"
        yield f"from {start:.0f} to {end:.0f} m: {grade}, {climb}"


def _counted(before: RoadMeasures, after: RoadMeasures) -> Iterator[str]:
    yield f"{len(before.turns)} -> {len(after.turns)} turns"
    for number, turn in enumerate(after.turns, 1):
        yield f"turn {number} is now {_turn(turn)}"


def _things(before: RoadElements, new: RoadElements, found: RoadMeasures) -> Iterator[str]:
    after = {element.name: element for element in new}
    seen_as = {one.name: seen for one, seen in zip(new, features_of(new, found), strict=True)}
    names = _names(before)
    for element in before:
        now, name, was = after.get(element.name), names[element.name], element.seen
        if now is None or now.is_turn != element.is_turn:
            had = f" ({was.degrees:.0f} degrees to the {was.side})" if element.is_turn and was else ""
            instead = f", in its place {now.length:g} m straight" if had and now and now.segments else ""
            yield f"{name} is gone{had}{instead}"
        elif now.segments != element.segments:
            yield from _other(element, now, name, seen_as[now.name])
    numbers = _names(new)
    for element in new:
        if element.name in names or element.name.endswith(" rest"):
            continue
        seen = seen_as[element.name]
        if element.is_turn and seen:
            yield f"{numbers[element.name]} is new: {_turn(seen)}"
        elif not element.is_turn:
            is_alone = seen is not None and abs(seen.length - element.length) < FADING
            length = seen.length if seen and is_alone else element.length
            yield f"a straight of {length:.0f} m is new, {element.incline:+.1f} %"


def _names(elements: Sequence[RoadElement]) -> dict[str, str]:
    out, turns, straights = dict[str, str](), 0, 0
    for element in elements:
        if element.is_turn:
            turns += 1
            out[element.name] = f"turn {turns}"
        else:
            straights += element.seen is not None
            behind = f"the road behind turn {turns}" if turns else "the road"
            out[element.name] = f"straight {straights}" if element.seen is not None else behind
    return out


def _turn(seen: MeasuredFeature) -> str:
    return f"{seen.degrees:.0f} degrees to the {seen.side}, radius {seen.radius:.0f} m, {seen.grade:+.1f} %"


def _other(element: RoadElement, now: RoadElement, name: str, seen: MeasuredFeature | None) -> Iterator[str]:
    was = element.seen
    if not now.segments:
        yield f"{name} is gone"
        return
    if was is not None and seen is None and now.length < was.length:
        yield f"{name}: {now.length:g} m as written, too short to be seen"
        return
    said = []
    if was and seen:
        if was.side != seen.side:
            said.append(f"to the {seen.side} and not to the {was.side}")
        if was.kind == "turn":
            if abs(was.degrees - seen.degrees) >= 0.5:
                said.append(f"{was.degrees:.0f} -> {seen.degrees:.0f} degrees")
            if abs(was.radius / seen.radius - 1) >= 0.02 and abs(was.radius - seen.radius) >= 1:
                said.append(f"radius {was.radius:.0f} -> {seen.radius:.0f} m")
        if abs(was.length - seen.length) >= 1 and (was.kind == "straight" or not said):
            said.append(f"length {was.length:.0f} -> {seen.length:.0f} m")
    if abs(element.incline - now.incline) >= 0.05:
        said.append(_other_grades(element, now, was, seen))
    if was and seen and was.slopes and not seen.slopes:
        said.append(f"the {'crest' if was.slopes[0].grade > 0 else 'dip'} in it is gone")
    if not (was and seen) and abs(element.length - now.length) >= 0.05:
        said.append(f"length {element.length:.0f} -> {now.length:.0f} m")
    if said:
        yield f"{name}: {', '.join(said)}"


def _other_grades(
    element: RoadElement, now: RoadElement, was: MeasuredFeature | None, seen: MeasuredFeature | None
) -> str:
    parts = [[key for key, _ in groupby(segment.incline for segment in e.segments)] for e in (element, now)]
    if not element.is_turn and any(len({*map(way, inclines)}) > 1 for inclines in parts):
        one, other = (", ".join(f"{incline:+.1f}" for incline in inclines) for inclines in parts)
        return f"grades {one} -> {other} %"
    low, high = (was.grade, seen.grade) if was and seen else (element.incline, now.incline)
    return f"grade {low:+.1f} -> {high:+.1f} %"


def _placing(before: Design, after: Design) -> Iterator[str]:
    (x, y, z), (x1, y1, z1) = before.starting_point, after.starting_point
    if abs(x - x1) > MOVED or abs(y - y1) > MOVED:
        yield f"start moved from ({x:g}, {y:g}) to ({x1:g}, {y1:g})"
    if abs(z - z1) > MOVED:
        yield f"start {'raised' if z1 > z else 'lowered'} from {z:g} to {z1:g} m"
    turned = (after.theta - before.theta + 180) % 360 - 180
    if abs(turned) > 1e-6:
        yield f"turned by {turned:+.4g} degrees, theta {before.theta:g} -> {after.theta:g}"


def _changed_segments(before: Design, after: Design) -> list[str]:
    pairs = zip(before.segments, after.segments, strict=True)
    told = [said for number, (one, other) in enumerate(pairs, 1) if (said := _segment(number, one, other))]
    return told if len(told) <= ALL_LISTED else [f"{len(told)} segments changed"]


def _segment(number: int, before: Segment, after: Segment) -> str:
    said = []
    if after.distance != before.distance:
        said.append(f"distance {before.distance:g} -> {after.distance:g} m")
    if after.turn_degrees != before.turn_degrees:
        said.append(f"turn {before.turn_degrees:g} -> {after.turn_degrees:g} degrees")
    if after.incline != before.incline:
        said.append(f"grade {before.incline:g} -> {after.incline:g} %")
    for name in ("radius", "transition", "vertical_radius"):
        one, other = getattr(before, name), getattr(after, name)
        if one != other:
            values = ("open" if value is None else f"{value:g} m" for value in (one, other))
            said.append(f"{name.replace('_', ' ')} {' -> '.join(values)}")
    return f"segment {number}: {', '.join(said)}" if said else ""


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
    for one in changes:
        if one.change.what == "climb":
            _refuse_clashing_heights(one, [other for other in changes if other is not one])
    return [each for one in changes for each in (_settled(one) if is_final(one) else [one])]


def _settled(placed: PlacedChange) -> Iterator[PlacedChange]:
    change = placed.change
    for elements in [placed.elements] if change.is_of_road else [(each,) for each in placed.elements]:
        aim = None if change.bound else change.aim(rise_of(elements))
        final = change if aim is None else replace(change, to=aim, by=None, times=None, more=0)
        yield placed._replace(change=final, elements=elements)


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
    height, slope = placed.change, other.change
    has_way = slope.what == "slope" and slope.way in ("up", "down")
    has_size = slope.steepness or slope.bound or slope.to is not None or slope.more
    if not has_way or has_size or other.stretch or placed.elements != other.elements:
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
    kept = [element for element in placed.elements if element.name in told]
    if not kept:
        return placed
    if not rest or placed.change.to is None:
        raise EditError(
            f"'{placed.change.words}' leaves nothing that could climb, since all its parts have slopes of "
            "their own; leave one of them out"
        )
    return placed._replace(change=replace(placed.change, to=placed.change.to - rise_of(kept)), elements=rest)


class Named(NamedTuple):
    """The elements of a road, and where to find those of the road before the edit."""

    elements: RoadElements
    found: RoadMeasures
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
    moved = groupby(by_kind["order"], lambda each: id(each) if each.change.what in REORDERS else -1)
    groups = [list(group) for _, group in moved]
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
    sloped = [each for each in changes if each.change.what == "slope"]
    is_of_all = any(_is_whole_road(each.change.target) for each in sloped)
    is_new = any(_is_new_part(each.change) for each in changes)
    return is_of_all and is_new and all(each.stretch is None for each in sloped)


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


def _refuse_conflicts(changes: Sequence[PlacedChange]) -> None:
    for one, other in product(changes, repeat=2):
        own, theirs = ({element.name for element in each.elements} for each in (one, other))
        is_gone = other.change.what in ("remove", "straighten")
        if one.change.what in REORDERS and is_gone and not own.isdisjoint(theirs):
            raise _removed(one.change)
        if one.change.is_hill and other.change.what == "slope" and theirs <= own:
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


def renamed(road: FittedRoad, now: Named, geometry: Geometry, stage: int) -> Named:
    """Measures a road after a stage; its elements have the names that they had in ``now``, before it.
    Straights that a removal joined have the name of the longest of those that were there before the edit."""
    elements, found = elements_on_road(road.design, geometry)
    turns = iter([element for element in road.elements if element.is_turn])
    known = {element.name for element in now.by_name.values()}
    names, after = list[str](), dict[str, str]()
    for element in elements:
        gaps = [old for old in road.elements if not old.is_turn and old.segments]
        parts = [next(turns)] if element.is_turn else [old for old in gaps if old.first in element.members]
        longest = max(parts, key=lambda part: (part.name in known, part.length), default=None)
        names.append(longest.name if longest else f"{element.name} of stage {stage}")
        after |= {part.name: names[-1] for part in parts}
    out = [replace(element, name=name) for element, name in zip(elements, names, strict=True)]
    index = {element.name: element for element in out}
    before = {old: element.name for old, element in now.by_name.items()}
    return Named(
        tuple(out), found, {old: index[after[name]] for old, name in before.items() if name in after}
    )


MOST_CHANGES = 12


class Edited(NamedTuple):
    """A changed Design, and sentences that describe how it differs from the old one."""

    design: Design
    changes: tuple[str, ...]
    unused: tuple[str, ...] = ()  # words of the request that were not understood
    confidence: float = 1.0  # estimated probability that the request was read correctly
    other: str = ""  # the plan of another reading that is likely; empty if there is none
    world: World = World()  # the World before the edit, or one with a larger map if the changed road needs it


def edit(
    design: Design,
    words: str | EditRequest,
    world: World,
    geometry: Geometry = "arcs",
    chat: ChatSettings | None = None,
) -> Edited:
    """Returns the Design, changed as the words ask: the text of a change request, or the EditRequest read
    from it.

    A map of the usual size grows if the changed road needs it. ``chat`` are the settings of the language
    model that reads the words; None for RoadGPT's own networks. Raises EditError if the words cannot be read,
    name something that is not on the road, or ask for something that no valid road can have, and ChatError if
    the language model could not be asked."""
    request = read_request(words, chat) if isinstance(words, str) else words
    try:
        return _edited(design, checked_request(request), world, geometry)
    except EditError as error:
        for other in other_readings(request) if _may_be_other(request, error) else ():
            with suppress(EditError):
                made = _edited(design, other, world, geometry)
                asked = "; ".join(change.words for change in request.changes)
                told = f"'{asked}', the likeliest reading, cannot be done: {error}"
                return made._replace(changes=(*made.changes, told), unused=request.unused)
        raise


def _may_be_other(request: EditRequest, error: EditError) -> bool:
    """Returns whether a request that this road cannot have may be meant as its next likely readings. That is
    so if the first reading is doubtful. If the road is as asked already, or has several such places, it is so
    if the next reading asks for the same kinds of changes: "the descent" of a road that falls all the way is
    the whole road."""
    if request.confidence < DOUBT:
        return True
    if not request.others or not isinstance(error, IdleEditError | UnclearPlaceError):
        return False
    other = read_change_plan(request.other)
    is_alike = {each.what for each in other.changes} == {each.what for each in request.changes}
    return is_alike and (isinstance(error, IdleEditError) or all(each.is_of_road for each in other.changes))


def _edited(design: Design, request: EditRequest, world: World, geometry: Geometry) -> Edited:
    if (count := len(request.changes) + len(request.scene)) > MOST_CHANGES:
        raise EditError(f"{count} changes at once are too many; ask for {MOST_CHANGES} or fewer")
    groups, told, idle = directions(request.changes), list[str](), 0
    now, place, may_grow = design, world, world.site.map_size == Site().map_size
    for changes in groups:
        made_of, place, said = _in_one_direction(now, changes, place, geometry, may_grow)
        idle += made_of is None
        now = made_of or now
        told += said
        if changes[0].what == "reverse" and changes is not groups[-1]:
            told.append(RENAMED)
    is_idle = idle == len(groups)
    if request.scene:
        place, said = _restaged(place, request.scene)
        if not said and is_idle:
            raise IdleEditError("nothing is to be changed: the scene is so already")
        told += said or ["the scene was so already"]
        is_idle = False
    surface = SURFACES.get(request.surface)
    if surface and surface.friction != place.site.friction:
        told.append(f"friction {place.site.friction:g} -> {surface.friction:g}, as {surface.said}")
        place = place.changed(friction=surface.friction)
    elif surface and is_idle:
        raise IdleEditError(f"nothing is to be changed: friction is {surface.friction:g} already")
    elif is_idle:
        raise IdleEditError(f"nothing is to be changed: '{request.changes[0].words}' is so already")
    if place.site.map_size != world.site.map_size:
        sizes = place.site.map_size, world.site.map_size
        told.append(
            "the map is {:g} m wide, since the changed road does not fit on one of {:g} m".format(*sizes)
        )
    return Edited(now, tuple(told), request.unused, request.confidence, request.other, place)


def _restaged(world: World, changes: Sequence[SceneChange]) -> tuple[World, list[str]]:
    """Returns the World with a changed scene, and sentences on it; none if it stays as it is."""
    before, friction = world.scene, world.site.friction
    kind, seed = world.site.made_ground or (None, 0)
    if kind:
        before = before.model_copy(update={"land": kind})
    scene = changed_scene(before, changes, KMH * world.limits.speed_limit)
    if scene == before:
        return world, []
    was, now = ([*parts_said(each)] for each in (before, scene))
    gone, new = [each for each in was if each not in now], [each for each in now if each not in was]
    arrow = " -> " if gone and new else "" if gone else "new in the scene: "
    told = [f"{'; '.join(gone)}{arrow}{'; '.join(new)}{'' if new else ' is gone'}"]
    told += [f"the scene is now: {scene_text(scene) or 'nobody else, by day, in clear weather'}"]
    told += filter(None, [land_remark(scene)])
    own, wanted = (friction_of(each.surfaces) or Site().friction for each in (before, scene))
    if own != wanted and (friction == own or scene.surface != before.surface):
        world = world.changed(friction=wanted)
        told += [f"friction {friction:g} -> {wanted:g}"] if friction != wanted else []
    elif own != wanted:
        told.append(f"friction stays {friction:g}, which was not set by the scene")
    if kind:
        world = world.changed(ground=f"{scene.land}:{seed}" if scene.land else "")
        scene = scene.model_copy(update={"land": None})
    return world.changed(scene=scene), told


def _in_one_direction(
    design: Design, changes: Sequence[Change], world: World, geometry: Geometry, may_grow: bool
) -> tuple[Design | None, World, list[str]]:
    elements, found = elements_on_road(design, geometry)
    asked = placed(changes, elements)
    once = settled(asked)
    wanted = with_final_heights(once)
    now, road = Named(elements, found, {element.name: element for element in elements}), None
    told, idle, fitted = list[str](), list[str](), list[tuple[Design, Design]]()
    number = 1
    for stage in stages(wanted):
        if road is not None:
            now = renamed(road, now, geometry, number)
        own = [carried_over(each, now, wanted) for each in stage]
        ways = candidates_of(own, now.elements, now.found, world, first=number)
        number += len(ways)
        pairs = zip(stage, own, strict=True)
        said = [sentence_of(each, elements, there, now.elements) for each, there in pairs]
        try:
            before = design if road is None else road.design
            road, draft = made(before, now.elements, ways, world, geometry, may_grow)
            fitted.append((draft, road.design))
            world = road.requirements.world
        except IdleEditError:
            ways = tuple(each._replace(ways=()) for each in ways)
        told += [sentence for sentence, each in zip(said, ways, strict=True) if each.ways and sentence]
        idle += [f"'{each.change.words}' was so already" for each in ways if not each.ways]
    if road is None:
        return None, world, idle
    is_of_slope = all(change.change.what in OF_SLOPE for change in wanted)
    stretches = [change.stretch for change in wanted if change.stretch and is_of_slope]
    told += [
        *grades_changed(design, road.design, stretches, geometry),
        *sentences(design, elements, found, road, fitted),
        *idle,
        *(
            f"'{each.change.words}' is asked for twice and done once"
            for each in asked
            if all(each.change is not other.change for other in once)
        ),
    ]
    return road.design, world, told


__all__ = ["EditRequest", "Edited", "edit", "read_request"]
