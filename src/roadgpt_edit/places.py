"""Finds the elements of the road that each change of a request concerns. Main function: ``placed``.

A target names elements ('the second left turn', 'the straight after it') or a stretch of the road by
distance: "the last 80 m", "from station 50 to 100", "the first half"."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import compress
from math import ceil, degrees, floor, radians
from typing import NamedTuple

from roadgpt.brief.change.request import OF_SLOPE, Change, Place, Target, Way, What, clash
from roadgpt.brief.words import KINDS
from roadgpt.check.measures import way
from roadgpt.errors import EditError, IdleEditError, UnclearPlaceError
from roadgpt.road import Segment
from roadgpt_edit.road_elements import RoadElement, RoadElements, with_stations

LEAST_LENGTH = 5.0  # m of a stretch
LEAST_PIECE = 1.0  # m of a straight segment: a shorter piece is not cut off
LEAST_ARC = 4.0  # m of the arc of a turn on either side of a cut
TENTH = 10.0  # per degree
MOST_MOVED = 0.3  # share of a stretch by which its end may be moved to the end of a turn
MILLIMETRE = 1000.0
LONG, SHORT = 60.0, 30.0  # m: brief.words
LEAST_PART = 10.0  # m of a straight that climb, fall or are level, to be called a part of it
SINGLE = ("hairpin", "u_turn", "switchback")
OF_TURNS: frozenset[What] = frozenset({"angle", "radius", "side", "shape", "straighten"})
KIND_NAMES = {"hairpin": "hairpin", "u_turn": "U-turn", "s_bend": "S-bend", "chicane": "chicane"}
NAMES = ["first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth"]
CLEARLY = 0.04  # share by which a value gets beyond that of another place
LEAST_FOR_HILL = 40.0  # m: the shortest straight for a crest or a dip
RELATED: Mapping[What, frozenset[What]] = {
    "angle": frozenset({"shape", "length", "straighten"}),
    "radius": frozenset({"shape", "length", "straighten"}),
    "length": frozenset({"angle", "radius", "shape", "straighten"}),
    "slope": frozenset({"climb"}),
}
"""For each property, the changes of other properties that also change this property."""


class RoadStretch(NamedTuple):
    """A part of a road, between two stations in metres from its start."""

    start: float
    end: float


def stretch_of(target: Target, elements: RoadElements) -> RoadStretch | None:
    """Returns the stretch that a target names by distances or as a half; None for any other target. A stretch
    may begin or end in the arc of a turn. If it would begin or end anywhere else within a bend, it begins or
    ends at the nearer end of that bend."""
    whole = sum(element.length for element in elements)
    ends = _named_ends(target, whole)
    if ends is None:
        return None
    length = ends.end - ends.start
    furthest = max(ends.end, whole - ends.start)
    if furthest > whole + LEAST_PIECE:
        raise EditError(f"the road is only {whole:.0f} m long, not {furthest:g} m; name a shorter part of it")
    if length < LEAST_LENGTH:
        raise EditError(f"'{target.words}' is too short for a slope; name {LEAST_LENGTH:g} m or more")
    return RoadStretch(*(_outside_bends(max(station, 0.0), length, elements) for station in ends))


def _named_ends(target: Target, whole: float) -> RoadStretch | None:
    if target.is_distance:
        station = _station(target, whole)
        return RoadStretch(station, whole) if target.noun == "end" else RoadStretch(0.0, station)
    if target.noun != "road" or target.but or target.way:
        return None
    place = target.place
    if place is None and target.half:
        return RoadStretch(whole / 2, whole) if target.half == 2 else RoadStretch(0.0, whole / 2)
    if place is None or place.target is None or not place.is_of_distances:
        return None
    station = _station(place.target, whole)
    if place.other is not None:
        return RoadStretch(*sorted((station, _station(place.other, whole))))
    is_first = place.how in ("before", "up_to")
    return RoadStretch(0.0, station) if is_first else RoadStretch(station, max(station, whole))


def _station(target: Target, whole: float) -> float:
    assert target.length is not None
    return whole - target.length if target.noun == "end" else target.length


def _outside_bends(station: float, length: float, elements: RoadElements) -> float:
    """Returns the station, or the nearer end of the turn in which it lies; in an arc, the station itself."""
    for element, begin in with_stations(elements):
        for i, (_, start) in enumerate(_segment_stations(element.segments, begin)):
            if not element.is_of_arcs:
                break
            if i and _is_in_turn(element.segments, i) and abs(start - station) < LEAST_ARC:
                return start
            if _arc_cut(element.segments, i, start, station):
                return station
    for at, end in _bends(elements):
        if at < station < end:
            nearer = min(at, end, key=lambda each: abs(each - station))
            if abs(nearer - station) > MOST_MOVED * length:
                raise EditError(
                    f"station {station:.0f} m of this road lies in a turn and cannot be an end there; name "
                    "turns and straights, for example: from turn 2 on"
                )
            return nearer
    return station


def _bends(elements: RoadElements) -> Iterator[tuple[float, float]]:
    for element, at in with_stations(elements):
        if element.is_turn:
            yield at, at + element.length
        else:
            for segment, start in _segment_stations(element.segments, at):
                if segment.turn_degrees:
                    yield start, start + segment.distance


def within(elements: RoadElements, stretch: RoadStretch) -> RoadElements:
    """Returns the elements, each with only those of its segments that lie in the stretch, if there are
    any."""
    parts = (
        element.with_segments(compress(*pieces(element, at, stretch)))
        for element, at in with_stations(elements)
    )
    return tuple(part for part in parts if part.segments)


def pieces(
    element: RoadElement, at: float, stretch: RoadStretch
) -> tuple[tuple[Segment, ...], tuple[bool, ...]]:
    """Returns the segments of an element that begins at station ``at``, and which of them lie in a stretch. A
    straight segment or an arc in which the stretch begins or ends is cut in two there."""
    cut = list(element.segments)
    for station in stretch:
        starts = list(_segment_stations(cut, at))
        cut = [part for i, (_, start) in enumerate(starts) for part in _cut(cut, i, start, station)]
    middles = (start + part.distance / 2 for part, start in _segment_stations(cut, at))
    return tuple(cut), tuple(stretch.start < middle < stretch.end for middle in middles)


def _segment_stations(segments: Sequence[Segment], at: float) -> Iterator[tuple[Segment, float]]:
    for segment in segments:
        yield segment, at
        at += segment.distance


def _is_in_turn(segments: Sequence[Segment], index: int) -> bool:
    return segments[index - 1].turn_degrees * segments[index].turn_degrees > 0


def _cut(segments: Sequence[Segment], index: int, at: float, station: float) -> Sequence[Segment]:
    segment = segments[index]
    if segment.turn_degrees:
        return _arc_cut(segments, index, at, station) or [segment]
    first = round((station - at) * MILLIMETRE) / MILLIMETRE
    rest = round((segment.distance - first) * MILLIMETRE) / MILLIMETRE
    if min(first, rest) < LEAST_PIECE:
        return [segment]
    return [segment.model_copy(update={"distance": each}) for each in (first, rest)]


def _arc_cut(segments: Sequence[Segment], index: int, at: float, station: float) -> list[Segment]:
    """Returns a segment of a turn in two parts with the same curvature, cut at the tenth of a degree that is
    nearest to ``station``; an empty list if there is no arc there, or the segment does not give its arc."""
    segment, away = segments[index], station - at
    if not segment.turn_degrees or not 0 < away < segment.distance:
        return []
    is_end = [not (0 < i < len(segments) and _is_in_turn(segments, i)) for i in (index, index + 1)]
    if any(is_end) and not (segment.radius and segment.transition):
        return []
    ramps = [(segment.transition or 0.0) if end else 0.0 for end in is_end]
    turned = radians(abs(segment.turn_degrees))
    radius = segment.radius if segment.radius and any(is_end) else segment.distance / turned
    if away - ramps[0] < LEAST_ARC or segment.distance - away - ramps[1] < LEAST_ARC:
        return []
    angle = round(degrees((away - ramps[0] / 2) / radius) * TENTH) / TENTH
    if not 0 < angle < abs(segment.turn_degrees):
        return []
    angles = angle, round((abs(segment.turn_degrees) - angle) * TENTH) / TENTH
    return [_arc(segment, *part, radius) for part in zip(angles, ramps, strict=True)]


def _arc(segment: Segment, angle: float, ramp: float, radius: float) -> Segment:
    """Returns a part of a segment of a turn, of so many degrees, with a ramp of so many metres or none. As in
    ``design.elements.cut``, parts with ramps are a hair long, and others a hair short, so that all of them
    keep the radius."""
    exact = (radius * radians(angle) + ramp / 2) * MILLIMETRE
    return segment.model_copy(
        update={
            "distance": (ceil(exact) if ramp else floor(exact)) / MILLIMETRE,
            "turn_degrees": angle if segment.turn_degrees > 0 else -angle,
            "radius": segment.radius if ramp else None,
            "transition": segment.transition if ramp else None,
        }
    )


def pointed(target: Target, elements: RoadElements, what: What) -> list[RoadElement]:
    """Returns the elements that a target refers to, in driving order. The property to be changed (``what``)
    decides what 'the end' and a target without a noun ('the second') refer to. Raises EditError if no element
    matches, or several match although the request means one."""
    match target.noun:
        case "end" | "start" if target.length is not None:
            return _of_stretch(target, elements, what)
        case "end" | "start":
            return [_end(elements, what, last=target.noun == "end")]
        case "road":
            return _road(target, elements, what)
        case "straight":
            found, noun = straights(elements), "straight"
        case _:
            found, noun = turns(elements), "turn"
            if target.noun is None and what == "length" and not target.side:
                found = found or straights(elements)
    chosen = _chosen(target, among(target, found, elements), noun)
    return _spared(target, chosen, elements) if target.numbers else chosen  # 'turns 1 to 4 except turn 2'


def turns(elements: Sequence[RoadElement]) -> list[RoadElement]:
    """Returns all turns."""
    return [element for element in elements if element.is_turn]


def straights(elements: Sequence[RoadElement]) -> list[RoadElement]:
    """Returns all straights that are long enough to be measured as straights."""
    return [element for element in elements if not element.is_turn and element.seen is not None]


def _road(target: Target, elements: RoadElements, what: What) -> list[RoadElement]:
    found, place = list(elements), target.place
    is_by_distance = place is not None and place.is_of_distances
    if (is_by_distance or (target.half is not None and what in OF_SLOPE)) and stretch_of(target, elements):
        found = _of_stretch(target, elements, what)
    elif target.half:
        found = _half(elements, target.half)
    is_within = place is not None and (place.how not in ("on", "between") or place.other is not None)
    if place and place.target and is_within and not is_by_distance:
        marks = [elements.index(b) for b in pointed(_single(place.target), elements, what)]
        other = pointed(_single(place.other), elements, what) if place.other else None
        there = _reach(place.how, marks, elements.index(other[0]) if other else len(elements), len(elements))
        found = [element for element in found if element in elements[there.start : there.stop]]
    gone = pointed(named(target.but), elements, what) if target.but else []
    return [
        element
        for element in found
        if element.segments and element not in gone and (element.is_turn or what not in OF_TURNS)
    ]


def _reach(how: str, marks: Sequence[int], stop: int, count: int) -> range:
    """Returns the indices of what lies after, before, from or up to the elements with the indices ``marks``,
    or between the last of them and ``stop``, on a road of ``count`` elements."""
    match how:
        case "before":
            return range(marks[0])
        case "from":
            return range(marks[0], count)
        case "up_to":
            return range(marks[-1] + 1)
        case "between":
            return range(marks[-1] + 1, stop)
        case _:
            return range(marks[-1] + 1, count)


def _half(elements: RoadElements, half: int) -> list[RoadElement]:
    middle = sum(element.length for element in elements) / 2
    return [
        element
        for element, at in with_stations(elements)
        if (at + element.length / 2 < middle) == (half == 1)
    ]


def around_middle(gaps: Sequence[RoadElement], elements: RoadElements) -> RoadElement:
    """Returns the gap that holds the middle of the road, or else the gap nearest to the middle."""
    middle = sum(element.length for element in elements) / 2
    away = {one.name: max(at - middle, middle - at - one.length, 0.0) for one, at in with_stations(elements)}
    return min(gaps, key=lambda gap: away[gap.name])


def _of_stretch(target: Target, elements: RoadElements, what: What) -> list[RoadElement]:
    if what not in OF_SLOPE:
        told = f"'{target.words}' is a distance, and only its slope or its climb can be changed"
        raise EditError(f"{told}; name turns or straights")
    stretch = stretch_of(target, elements)
    assert stretch is not None
    names = {element.name for element in within(elements, stretch)}
    return [element for element in elements if element.name in names]


def _end(elements: RoadElements, what: What, last: bool) -> RoadElement:
    if what in OF_TURNS:
        found = turns(elements)
        if not found:
            raise EditError("there is no turn on this road; add one: add a left turn at the end")
        return found[-1 if last else 0]
    seen = [element for element in elements if element.seen is not None]
    if not seen:
        return max(elements, key=lambda element: element.length)
    return seen[-1 if last else 0]


def _single(target: Target) -> Target:
    return replace(target, place=None) if target.noun == "road" else target


def among(target: Target, found: Sequence[RoadElement], elements: RoadElements) -> list[RoadElement]:
    """Returns the elements with the properties and the place that the target names."""
    half = _half(elements, target.half) if target.half else elements
    out = [element for element in found if _fits(target, element) and element in half]
    place = target.place
    if place and place.target:
        out = _placed(place, out, elements, many=target.every or bool(target.numbers))
    return out if target.numbers else _spared(target, out, elements)


def _spared(target: Target, found: list[RoadElement], elements: RoadElements) -> list[RoadElement]:
    if target.but is None:
        return found
    gone = pointed(replace(target.but, noun=target.but.noun or target.noun), elements, "length")
    return [element for element in found if element not in gone]


def _ways(element: RoadElement, grade: float) -> set[Way]:
    parts = defaultdict[Way, float](float)
    for segment in element.segments:
        parts[way(segment.incline)] += segment.distance
    long = {each for each, length in parts.items() if length >= LEAST_PART}
    return {way(grade)} if element.is_turn or len(long) < 2 else long


def _fits(target: Target, element: RoadElement) -> bool:
    seen = element.seen
    if seen is None:
        return False
    if target.side and element.side != target.side:
        return False
    if target.way and target.way not in _ways(element, seen.grade):
        return False
    if target.size and not (seen.length >= LONG if target.size == "long" else seen.length <= SHORT):
        return False
    if target.degrees is not None and abs(seen.degrees - target.degrees) > 10:
        return False
    if target.length is not None and abs(seen.length - target.length) > max(5.0, 0.1 * target.length):
        return False
    if target.sharpness == "sharp" and seen.radius > 30:
        return False
    if target.sharpness in ("gentle", "sweeping") and seen.radius < 40:
        return False
    if target.kind is not None:
        if target.kind not in SINGLE:
            raise EditError(f"'{target.kind}' cannot be told apart on a road; name its turns by number")
        meaning = KINDS[target.kind]
        return meaning.degrees is not None and seen.degrees in meaning.degrees
    return True


def _placed(
    place: Place, found: Sequence[RoadElement], elements: RoadElements, many: bool
) -> list[RoadElement]:
    assert place.target is not None
    own = pointed(named(place.target), elements, "length")
    if place.how == "on" or (place.how == "between" and not place.other):
        return [element for element in found if element in own]
    marks, stop = [elements.index(element) for element in own], len(elements)
    if place.other:
        last, stop = sorted((marks[-1], elements.index(pointed(named(place.other), elements, "length")[0])))
        marks = [*marks[:-1], last]
    there = _reach(place.how, marks, stop, len(elements))
    out = [element for element in found if elements.index(element) in there]
    one = {"after": slice(1), "before": slice(-1, None)}.get(place.how)
    return out if many or one is None else out[one]


def named(target: Target) -> Target:
    """Returns the target; if it has no noun, as in "after the second", its noun becomes "turn"."""
    return replace(target, noun="turn") if target.noun is None else target


def _chosen(target: Target, found: Sequence[RoadElement], noun: str) -> list[RoadElement]:
    told = _told(target, noun)
    if not found:
        raise EditError(f"there is no {told} on this road")
    if target.most:
        measure, sign = target.most
        ranked = sorted(found, key=lambda element: -sign * _measure(element, measure))[: target.count or 1]
        return [element for element in found if element in ranked]
    if target.middle:
        if (n := len(found)) % 2 == 0:
            say = f"say its number: the {_ordinal(n // 2)} {noun}"
            raise EditError(f"of {n} {noun}s none is in the middle; {say}")
        return [found[len(found) // 2]]
    if target.numbers:
        out = []
        for number in target.numbers:
            index = number - 1 if number > 0 else len(found) + number
            if not 0 <= index < len(found):
                raise EditError(_missing(number, len(found), told))
            out.append(found[index])
        return [element for element in found if element in out]
    if len(found) > 1 and not target.every:
        names = " and ".join(("the " + _ordinal(n)) for n in range(1, min(len(found), 2) + 1))
        raise UnclearPlaceError(
            f"'{target.words}' could be any of {len(found)}; say which ({names}, ...), or: every {told}"
        )
    return list(found)


def _missing(number: int, count: int, told: str) -> str:
    what = f"{_ordinal(number)} {told}" if number > 0 else f"{_ordinal(-number)} {told} from the end"
    many = f"{count} {told}s" if told in ("turn", "straight") else f"{count} such"
    return f"there is no {what}; the road has {many if count != 1 else 'one'}"


def _measure(element: RoadElement, measure: str) -> float:
    seen = element.seen
    assert seen is not None
    if measure == "sharp":
        return -seen.radius + seen.degrees / 1000 if element.is_turn else 0.0
    return seen.length if measure == "long" else abs(seen.grade)


def _told(target: Target, noun: str) -> str:
    place = target.place
    words = [
        target.side,
        {"up": "uphill", "down": "downhill", "flat": "level"}.get(target.way or ""),
        target.sharpness or target.size,
        None if target.degrees is None else f"{target.degrees:g} degree",
        None if target.length is None else f"{target.length:g} m",
        KIND_NAMES.get(target.kind or "", noun),
        f"{place.how} {place.target.words}" if place and place.target else None,
    ]
    return " ".join(word for word in words if word)


def _ordinal(number: int) -> str:
    return NAMES[number - 1] if 1 <= number <= len(NAMES) else f"{number}th"


class PlacedChange(NamedTuple):
    """A requested change, and the elements of the road that it refers to."""

    change: Change
    elements: RoadElements
    """The elements to change, in driving order; none for an addition, except the straight that gets a crest
    or a dip."""
    marks: RoadElements = ()  # the elements after, before or on which something is added
    stop: RoadElement | None = None  # the second element if something is added between two; else None
    stretch: RoadStretch | None = None
    """The stretch of the road whose slope changes, if named by a distance or as a half; else None."""

    def without(self, others: Sequence["PlacedChange"]) -> "PlacedChange":
        """Returns the change without the elements that ``others`` keep as they are. Another change counts if
        it is of the same property and concerns only some of the elements of this change."""
        own = self.elements
        for other in others if self.change.what != "length" or not self.change.is_of_road else ():
            if other.change.what == self.change.what and {*other.elements} < {*own}:
                if self.stretch is not None:
                    raise clash(self.change, other.change)
                own = tuple(element for element in own if element not in other.elements)
        return self._replace(elements=own)


def placed(changes: Sequence[Change], elements: RoadElements) -> tuple[PlacedChange, ...]:
    """Returns the changes with the elements that they refer to on the road before the edit. Raises EditError
    if no element matches, several match although the request means one, or there is no straight for a crest
    or a dip."""
    out = []
    for change in changes:
        if change.like is not None and change.what == "swap":
            out.append(_swapped(change, change.like, elements))
        elif change.like is not None:
            out.append(_like_its_model(change, changes, elements))
        elif change.what in ("mirror", "reverse") and change.target is None:  # the whole road
            out.append(PlacedChange(change, elements))
        elif change.what == "count":
            out.append(_counted(change, elements))
        elif change.what in ("move", "add"):
            target = change.target if change.what == "move" else None
            moved = pointed(target, elements, "side") if target else ()
            out.append(PlacedChange(change, tuple(moved), *_marks(change.place, elements)))
        else:
            assert change.target is not None
            own = tuple(pointed(change.target, elements, change.what))
            is_sloped = change.what in OF_SLOPE
            if is_sloped and not own:
                raise EditError(f"there is no road at '{change.target.words}', so it has no slope")
            stretch = stretch_of(change.target, elements) if is_sloped else None
            out.append(PlacedChange(change, own, stretch=stretch))
    return tuple(_on_straight(placed, elements) if placed.change.is_hill else placed for placed in out)


def _swapped(change: Change, like: Target, elements: RoadElements) -> PlacedChange:
    assert change.target is not None
    own = pointed(change.target, elements, "length"), pointed(named(like), elements, "length")
    if any(len(each) != 1 for each in own) or own[0] == own[1]:
        raise EditError(f"'{change.words}' has to name two different things; name one on each side")
    both = {element.name for each in own for element in each}
    return PlacedChange(change, tuple(element for element in elements if element.name in both))


def too_short_for_hill(change: Change, found: str = "") -> str:
    """Returns a sentence on a crest or dip for which there is no straight; ``found`` says what there is."""
    return f"a {change.kind} needs a straight of {LEAST_FOR_HILL:.0f} m or more{found}; lengthen it first"


def _on_straight(placed: PlacedChange, elements: RoadElements) -> PlacedChange:
    place = placed.change.place
    how = place.how if place else "end"
    if how == "on":
        if len(placed.marks) != 1 or placed.marks[0].is_turn:
            raise EditError(f"'{placed.change.words}' names no single straight; name one")
        return placed._replace(elements=placed.marks)
    found = [element for element in elements if not element.is_turn and element.segments]
    if how == "middle":
        found = [around_middle(found, elements)] if found else []
    elif how not in ("start", "end"):
        marks = [elements.index(mark) for mark in placed.marks]
        stop = elements.index(placed.stop) if placed.stop else len(elements)
        there = _reach(how if how in ("before", "between") else "after", marks, stop, len(elements))
        found = [gap for gap in found if elements.index(gap) in there]
        if placed.stop and len(found) != 1:
            raise EditError(f"'{placed.change.words}' names {len(found) or 'no'} straights; name one of them")
    if not found:
        raise EditError(too_short_for_hill(placed.change))
    return placed._replace(elements=(found[-1 if how in ("before", "end") else 0],))


def _like_its_model(asked: Change, changes: Sequence[Change], elements: RoadElements) -> PlacedChange:
    """Returns a change that takes its value from another place ("as long as the first straight"), with this
    value. Two places may exchange their values; the value of a model that itself takes one from a third place
    is not known."""
    assert asked.like is not None
    assert asked.target is not None
    models = pointed(asked.like, elements, asked.what)
    if len(models) != 1 or models[0].seen is None:
        raise EditError(f"'{asked.words}' has to compare with one turn or one straight; name it")
    own = tuple(each for each in pointed(asked.target, elements, asked.what) if each is not models[0])
    if not own:
        raise IdleEditError(f"'{asked.words}' compares a place with itself; name another one")
    others = []
    for other in changes:
        if other is asked or other.target is None or other.what in ("add", "count", "move", "swap"):
            continue
        changed = pointed(named(other.target), elements, other.what)
        if models[0] not in changed:
            continue
        if other.like is None:
            others.append(other)
        elif other.what == asked.what and not {*pointed(other.like, elements, other.what)} <= {*own}:
            raise clash(asked, other)
    stretch = stretch_of(asked.target, elements) if asked.what == "slope" else None
    change = _with_value_of(asked, models[0], others)
    if change.bound and change.what != "slope":
        beyond = tuple(each for each in own if is_beyond(change, each))
        if beyond:  # "longer than the first" is clearly longer, and "at least as long" allows it
            return PlacedChange(replace(change, to=(change.to or 0.0) * (1 + CLEARLY * change.bound)), beyond)
    return PlacedChange(change, own, stretch=stretch)


def _with_value_of(change: Change, model: RoadElement, others: Sequence[Change]) -> Change:
    """Returns the change with the value of the element that it names as its model: the value before the edit,
    or the new one if another change of the request gives the model one."""
    if change.what in ("angle", "radius") and not model.is_turn:
        raise EditError(f"'{change.words}' compares with a straight, which does not bend; name a turn")
    seen = model.seen
    assert seen is not None
    measures = {"angle": seen.degrees, "radius": seen.radius, "length": seen.length, "slope": seen.grade}
    is_exact = change.bound or change.is_compared
    value = measures[change.what] if is_exact else round(measures[change.what], 1)
    direction = way(value) if change.what == "slope" else None
    for other in others:
        if other.what in RELATED[change.what]:
            raise clash(change, other)
        if other.what == change.what:
            value, direction = _new_value(change, other, value, direction)
    if change.is_compared:
        value, direction = change.aim(abs(value)) or 0.0, None if direction == "flat" else direction
        if value < 0:
            raise EditError(f"'{change.words}' would be less than nothing on this road; ask for less")
        change = replace(change, more=0, by=None, times=None)
    if change.what != "slope":
        return replace(change, like=None, to=value)
    if change.bound:
        return replace(change, like=None, to=abs(value))
    direction = change.way or direction
    return replace(change, like=None, way=direction, to=None if direction == "flat" else abs(value))


def _new_value(
    change: Change, other: Change, value: float, direction: Way | None
) -> tuple[float, Way | None]:
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


def is_beyond(change: Change, element: RoadElement) -> bool:
    """Returns whether an element violates the limit that a change sets."""
    if change.what == "slope":
        return any(change.is_outside(abs(segment.incline)) for segment in element.segments)
    seen = element.seen
    return seen is not None and change.is_outside(
        getattr(seen, "degrees" if change.what == "angle" else change.what)
    )


def _marks(place: Place | None, elements: RoadElements) -> tuple[RoadElements, RoadElement | None]:
    if place is None or place.target is None or place.how in ("start", "end", "middle"):
        return (), None
    marks = tuple(pointed(named(place.target), elements, "length"))
    other = place.other if place.how == "between" else None
    stop = pointed(named(other), elements, "length")[0] if other else None
    return marks, stop


def _counted(change: Change, elements: RoadElements) -> PlacedChange:
    """Returns the removal or the addition with which the road has as many turns as asked for. The last ones
    are removed; new ones come at the end."""
    target = change.target
    assert target is not None
    assert change.to is not None
    there, wanted = among(target, turns(elements), elements), int(change.to)
    if change.bound <= 0 and len(there) > wanted:
        return PlacedChange(replace(change, what="remove"), tuple(there[wanted:]))
    if change.bound >= 0 and len(there) < wanted:
        new = Target("turn", words=target.words)
        more = Change(
            "add",
            new,
            kind=target.kind,
            side=target.side,
            sharpness=target.sharpness,
            way=target.way,
            count=wanted - len(there),
            place=Place("end"),
            words=change.words,
        )
        return PlacedChange(more, ())
    return PlacedChange(change, ())
