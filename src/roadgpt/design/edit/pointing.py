"""Finds the elements of a road that a target refers to: 'the second left turn', 'the straight after it'."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

from roadgpt.brief.change.request import OF_SLOPE, Place, Target, Way, What
from roadgpt.brief.words import KINDS
from roadgpt.check.measures import way
from roadgpt.design.edit.stretches import stretch_of, within
from roadgpt.design.road_elements import RoadElement, RoadElements, with_stations
from roadgpt.errors import EditError, UnclearPlaceError

LONG, SHORT = 60.0, 30.0  # m: brief.words
LEAST_PART = 10.0  # m of a straight that climb, fall or are level, to be called a part of it
SINGLE = ("hairpin", "u_turn", "switchback")
OF_TURNS: frozenset[What] = frozenset({"angle", "radius", "side", "shape", "straighten"})
KIND_NAMES = {"hairpin": "hairpin", "u_turn": "U-turn", "s_bend": "S-bend", "chicane": "chicane"}


def pointed(target: Target, elements: RoadElements, what: What) -> list[RoadElement]:
    """Returns the elements that a target refers to, in driving order.

    The property to be changed (``what``) decides what 'the end' and a target without a noun ('the second')
    refer to.

    Raises:
        EditError: no element matches, or several match although the request means one.
    """
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
    if place and place.target and place.how != "on" and not is_by_distance:
        marks = [elements.index(b) for b in pointed(_single(place.target), elements, what)]
        first, stop = 0, len(elements)
        if place.how == "after":
            first = marks[-1] + 1
        elif place.how == "before":
            stop = marks[0]
        elif place.how == "from":
            first = marks[0]
        elif place.how == "up_to":
            stop = marks[-1] + 1
        elif place.other:
            first, stop = marks[-1] + 1, elements.index(pointed(_single(place.other), elements, what)[0])
        there = {element.name for element in elements[first:stop]}
        found = [element for element in found if element.name in there]
    if target.but:
        gone = {element.name for element in pointed(named(target.but), elements, what)}
        found = [element for element in found if element.name not in gone]
    if what in OF_TURNS:
        found = [element for element in found if element.is_turn]
    return [element for element in found if element.segments]


def _half(elements: RoadElements, half: int) -> list[RoadElement]:
    """Returns the elements whose middle lies in the first or in the second half of the road."""
    middle = sum(element.length for element in elements) / 2
    return [
        element
        for element, at in with_stations(elements)
        if (at + element.length / 2 < middle) == (half == 1)
    ]


def around_middle(gaps: Sequence[RoadElement], elements: RoadElements) -> RoadElement:
    """Returns the gap that holds the middle of the road, or else the gap nearest to the middle."""
    whole = sum(element.length for element in elements)

    def away(gap: RoadElement) -> float:
        start = sum(element.length for element in elements[: elements.index(gap)])
        return max(start - whole / 2, whole / 2 - start - gap.length, 0.0)

    return min(gaps, key=away)


def _of_stretch(target: Target, elements: RoadElements, what: What) -> list[RoadElement]:
    """Returns the elements of "the last 80 m"; only their slope and their climb can be changed together."""
    if what not in OF_SLOPE:
        raise EditError(
            f"'{target.words}' is a distance, and only its slope or its climb can be changed; name turns or "
            "straights"
        )
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
    out = [element for element in found if _fits(target, element)]
    if target.half:
        there = {element.name for element in _half(elements, target.half)}
        out = [element for element in out if element.name in there]
    place = target.place
    if place and place.target:
        out = _placed(place, out, elements, many=target.every or bool(target.numbers))
    return out if target.numbers else _spared(target, out, elements)


def _spared(target: Target, found: list[RoadElement], elements: RoadElements) -> list[RoadElement]:
    """Returns the elements without the exceptions that the target names."""
    if target.but is None:
        return found
    but = replace(target.but, noun=target.but.noun or target.noun)
    gone = {element.name for element in pointed(but, elements, "length")}
    return [element for element in found if element.name not in gone]


def _ways(element: RoadElement, grade: float) -> set[Way]:
    """Returns whether an element climbs, falls or is level; a straight with several slopes does several."""
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
    at = {element.name: index for index, element in enumerate(elements)}
    marks = [at[element.name] for element in pointed(named(place.target), elements, "length")]
    if place.how == "after":
        out = [element for element in found if at[element.name] > marks[-1]]
        return out if many else out[:1]
    if place.how == "before":
        out = [element for element in found if at[element.name] < marks[0]]
        return out if many else out[-1:]
    if place.how == "from":
        return [element for element in found if at[element.name] >= marks[0]]
    if place.how == "up_to":
        return [element for element in found if at[element.name] <= marks[-1]]
    if place.how == "between" and place.other:
        stop = at[pointed(named(place.other), elements, "length")[0].name]
        low, high = min(marks[-1], stop), max(marks[-1], stop)
        return [element for element in found if low < at[element.name] < high]
    return [element for element in found if at[element.name] in marks]


def named(target: Target) -> Target:
    """Returns the target; if it has no noun, as in "after the second", its noun becomes "turn"."""
    return replace(target, noun="turn") if target.noun is None else target


def _chosen(target: Target, found: Sequence[RoadElement], noun: str) -> list[RoadElement]:
    """Chooses by superlative, middle or number, or takes all; refuses several if only one was meant."""
    told = _told(target, noun)
    if not found:
        raise EditError(f"there is no {told} on this road")
    if target.most:
        measure, sign = target.most
        ranked = sorted(found, key=lambda element: -sign * _measure(element, measure))[: target.count or 1]
        return [element for element in found if element in ranked]
    if target.middle:
        if len(found) % 2 == 0:
            n = len(found)
            raise EditError(
                f"of {n} {noun}s none is in the middle; say its number: the {_ordinal(n // 2)} {noun}"
            )
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


NAMES = ["first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth"]


def _ordinal(number: int) -> str:
    return NAMES[number - 1] if 1 <= number <= len(NAMES) else f"{number}th"
