"""Describes in sentences how two designs differ, turn by turn as measured before and after an edit."""

from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np

from roadgpt.check.measures import MeasuredFeature, Measures, ups_and_downs, way
from roadgpt.design.fit import Look
from roadgpt.design.road_elements import RoadElement, RoadElements, features_of
from roadgpt.road import Design, Geometry, Segment, build

ALL_LISTED = 60  # changed segments; of more, only the number is given
MOVED = 0.005  # m
PLACES = 200  # heights that the ups and downs of a stretch are seen in
FADING = 12.0  # m that a straight gains at most from turns that fade into it


def sentences(
    before: Design,
    elements: RoadElements,
    found: Measures,
    after: Look,
    fitted: Sequence[tuple[Design, Design]] = (),
) -> tuple[str, ...]:
    """Returns a sentence for each turn and straight that has changed, and for the road as a whole.

    ``elements`` and ``found`` are those of the road before the edit. If the Look at the road after the edit
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


def _counted(before: Measures, after: Measures) -> Iterator[str]:
    yield f"{len(before.turns)} -> {len(after.turns)} turns"
    for number, turn in enumerate(after.turns, 1):
        yield f"turn {number} is now {_turn(turn)}"


def _things(before: RoadElements, new: RoadElements, found: Measures) -> Iterator[str]:
    after = {element.name: element for element in new}
    seen_as = {one.name: seen for one, seen in zip(new, features_of(new, found), strict=True)}
    names = _names(before)
    for element in before:
        now = after.get(element.name)
        if now is None or now.is_turn != element.is_turn:
            yield _gone(element, names[element.name], now)
        elif now.segments != element.segments:
            yield from _other(element, now, names[element.name], seen_as[now.name])
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
    """Returns what a person would call each element, by the name of the element."""
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


def _gone(element: RoadElement, name: str, now: RoadElement | None) -> str:
    seen = element.seen
    if element.is_turn and seen:
        instead = f", in its place {now.length:g} m straight" if now and now.segments else ""
        return f"{name} is gone ({seen.degrees:.0f} degrees to the {seen.side}){instead}"
    return f"{name} is gone"


def _other(element: RoadElement, now: RoadElement, name: str, seen: MeasuredFeature | None) -> Iterator[str]:
    """Yields a sentence about the changes to an element that is on both roads; none if it is unchanged."""
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
    if not (was and seen) and abs(element.length - now.length) >= 0.05:
        said.append(f"length {element.length:.0f} -> {now.length:.0f} m")
    if said:
        yield f"{name}: {', '.join(said)}"


def _other_grades(
    element: RoadElement, now: RoadElement, was: MeasuredFeature | None, seen: MeasuredFeature | None
) -> str:
    """Returns the old and the new grade of an element; of a straight over a crest or a dip, those of all its
    parts, since their mean says little."""
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
