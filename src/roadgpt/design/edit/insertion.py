"""Makes candidates that add or remove turns and straights; the elements around them keep all their values."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, product
from math import radians

from roadgpt.brief.change.request import Change
from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.brief.outline import Feature
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import KINDS, SHARPNESS, SLOPES
from roadgpt.design.edit.places import PlacedChange
from roadgpt.design.edit.slopes import AIMS
from roadgpt.design.edit.steps import (
    HIDDEN,
    SEPARATE,
    Adjust,
    Become,
    EditCandidate,
    EditStep,
    Wanted,
)
from roadgpt.design.elements import straight, turn_segments
from roadgpt.design.road_elements import (
    FREE_STRAIGHT,
    MILLIMETRE,
    RoadElement,
    RoadElements,
    gap,
    joined,
    with_stations,
)
from roadgpt.errors import EditError
from roadgpt.road import World

JOINT = 8.0  # m between turns to opposite sides
LEAD = 17.0  # m before the first turn and behind the last
NEW_STRAIGHT = 40.0  # m, length of a new straight if the request gives none
SPARE = (0.0, 20.0)
"""Additional metres of straight road before and after a new turn; the second value is tried if the first does
not lead to a valid road, for example because the road would meet itself."""
TRANSITION_SHARE = 0.22  # of the arc
PREFERRED = {
    "": (60.0, 25.0),
    "hairpin": (168.0, 18.0),
    "u_turn": (178.0, 18.0),
    "s_bend": (50.0, 25.0),
    "chicane": (45.0, 20.0),
    "sharp": (80.0, 20.0),
    "gentle": (40.0, 55.0),
    "sweeping": (40.0, 75.0),
}
"""Angle in degrees and radius in metres of a new turn if the request does not give them."""
NEW = "new "
"""Prefix of the names of new elements."""
TAIL, STRAIGHT = "tail", "straight"
"""Last words of the names of new elements: a straight behind a new turn, and one that the request adds."""
FADE = 2.0  # m by which a straight between two turns is measured shorter than it is written
MOST_NEW = 12
HALVED = 0  # in place of a number of segments: the longest segment is split in half
FILLERS = (0.0, SEPARATE)  # m of straight road in the place of a removed turn


@dataclass(frozen=True, slots=True)
class Insert:
    """Inserts new elements before the element named ``before``, or at the end if the name is empty."""

    before: str
    elements: RoadElements
    split: int | None = None
    """Number of segments of the element ``before`` that stay in front of the new elements. ``HALVED`` splits
    the longest segment in half; None does not split the element."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements in driving order, with the new ones inserted."""
        names = [element.name for element in elements]
        at = names.index(self.before) if self.before else len(elements)
        if self.split is None:
            return (*elements[:at], *self.elements, *elements[at:])
        own, count = list(elements[at].segments), self.split
        if count == HALVED:
            longest = max(range(len(own)), key=lambda i: own[i].distance)
            half = round(own[longest].distance / 2 * MILLIMETRE) / MILLIMETRE
            rest = round((own[longest].distance - half) * MILLIMETRE) / MILLIMETRE
            own[longest : longest + 1] = [
                own[longest].model_copy(update={"distance": distance}) for distance in (half, rest)
            ]
            count = longest + 1
        first = elements[at].with_segments(own[:count])
        second = replace(first, name=f"{first.name} rest", seen=None, segments=tuple(own[count:]))
        return (*elements[:at], first, *self.elements, second, *elements[at + 1 :])


def insertion_candidates(
    placed: PlacedChange, elements: RoadElements, world: World, number: int, sides: Sequence[Side | None]
) -> tuple[EditCandidate, ...]:
    """Returns all candidates that add what a change asks for. ``number`` is that of the change in the
    request; the names of new elements contain it. ``sides`` are the sides of the elements once other changes
    of the request have turned some of them."""
    change = placed.change
    if change.count > MOST_NEW:
        raise EditError(f"{change.count} turns at once are too many to add; add {MOST_NEW} or fewer")
    if change.kind is not None and change.kind not in PREFERRED:
        raise EditError(f"'{change.kind}' cannot be added; add turns or straights in its place")
    at, splits = _place(placed, elements)
    if change.target is not None and change.target.noun == "straight":
        return _straight_ways(change, elements, at, splits, number)
    elements = tuple(map(_with_side, elements, sides))
    shape, incline, name = _shape(change, world), _incline(elements, at), _name(elements, at)
    out = []
    for spare, sides, split in product(SPARE, _sides(change, elements[:at]), splits):
        lead, tail = (metres + spare for metres in _missing(elements, at, split, sides))
        new = _new_turns(change, shape, sides, lead, tail, incline, number)
        out.append((Insert(name, new, split),))
    return tuple(out)


def _with_side(element: RoadElement, side: Side | None) -> RoadElement:
    return element if element.side == side else element.mirrored()


def _place(placed: PlacedChange, elements: RoadElements) -> tuple[int, list[int | None]]:
    """Returns the index of the element before which to insert, and the ways to split it, as in
    ``Insert.split``; at the end of the road, the index is the number of elements."""
    place, mark, stop = placed.change.place, placed.marks, placed.stop
    how = place.how if place else "end"
    if how == "end":
        return len(elements), [None]
    if how == "start":
        return 0, [None]
    if how == "middle" or place is None or place.target is None:
        at, count = _middle(elements)
        return at, [count]
    if how == "on" and mark[0].is_turn:
        raise EditError("a turn cannot be added within a turn; say: after the second turn")
    if how in ("on", "before"):
        return elements.index(mark[0]), [0 if how == "on" else None]
    at = elements.index(mark[-1])
    if how != "between":
        return at + 1, [None]
    if stop is not None:
        end = elements.index(stop)
        if end < at:
            raise EditError("the two places stand the other way round on the road; name the first one first")
        if end == at:
            raise EditError("between a turn and itself is no place; name two turns")
        is_same = place.other is not None and place.other.words == place.target.words
        if is_same and any(element.is_turn for element in elements[at + 1 : end]):
            raise EditError(f"between '{place.target.words}' are several places; name two turns")
    splits: list[int | None] = []
    for between in elements[at + 1 : at + 2]:
        for count in range(1, len(between.segments)):
            left = sum(segment.distance for segment in between.segments[:count])
            if min(left, between.length - left) >= SEPARATE:
                splits.append(count)
    return at + 1, [*splits[:1], None]


def _middle(elements: RoadElements) -> tuple[int, int]:
    """Returns the index of the gap nearest to the road's middle, and where to split it, as in
    ``Insert.split``."""
    whole, places = sum(element.length for element in elements), list[tuple[float, int, int]]()
    for number, (element, at) in enumerate(with_stations(elements)):
        if not element.is_turn and element.segments:
            joints = accumulate((segment.distance for segment in element.segments[:-1]), initial=at)
            places += [(joint, number, count) for count, joint in enumerate(joints) if count]
            places.append((at + element.length / 2, number, 0))
    _, number, count = min(places, key=lambda place: abs(place[0] - whole / 2), default=(0.0, 0, 0))
    return number, count


def _shape(change: Change, world: World) -> tuple[Wanted, Wanted]:
    """Returns the angle in degrees and the radius in metres of the new turns."""
    least = world.limits.design_radius
    if change.radius is not None and change.radius < world.limits.min_radius:
        raise EditError(
            f"a radius of {change.radius:g} m is tighter than the {world.limits.min_radius:.1f} m that the "
            f"rules allow; ask for {least:.0f} m or more"
        )
    if change.degrees is not None and not 11 <= change.degrees <= 240:
        raise EditError(f"a turn of {change.degrees:g} degrees cannot be added; ask for 15 to 210 degrees")
    word: str = change.sharpness or ""
    meant = SHARPNESS[change.sharpness] if change.sharpness else KINDS["turn"]
    if change.kind:
        word, meant = change.kind, KINDS[change.kind]
    aim, radius = PREFERRED[word]
    angles, radii = meant.degrees or Range(), meant.radius or Range(0, 35.0 if word else 45.0)
    degrees = Wanted(aim, Range(angles.lo + 2, angles.hi - 5))
    if change.degrees is not None:
        degrees = Wanted.near(change.degrees, 1.5)
    radius = max(radius, least)
    wanted = Wanted(radius, Range(max(1.03 * radii.lo, 0.98 * least), max(0.97 * radii.hi, radius)))
    if change.radius is not None:
        wanted = Wanted.near(max(change.radius, least), 0.05 * change.radius)
    return degrees, wanted


def _sides(change: Change, before: RoadElements) -> list[list[Side]]:
    """Returns the sequences of sides to try for the new turns behind the elements ``before``. If no side is
    requested, the first sequence begins opposite to the turn before, the second on its side."""
    count = change.count * (2 if change.kind in ("s_bend", "chicane") else 1)
    alternates = change.kind in ("s_bend", "chicane") or (count > 1 and change.side is None)
    last: Side = next((element.side for element in reversed(before) if element.side), "right")
    firsts: list[Side] = [change.side] if change.side else [OTHER_SIDE[last], last]
    return [[OTHER_SIDE[side] if alternates and i % 2 else side for i in range(count)] for side in firsts]


def _missing(
    elements: RoadElements, at: int, split: int | None, sides: Sequence[Side]
) -> tuple[float, float]:
    """Returns the metres of straight road that new turns to these sides need before and behind them."""
    before, turn_before = _behind(elements[:at])
    after, turn_after = _behind(elements[at:][::-1])
    if split is not None:
        own = elements[at]
        first = sum(segment.distance for segment in own.segments[:split]) if split else own.length / 2
        before, after = before + first, after - first
    return _lead(turn_before, sides[0], before), _lead(turn_after, sides[-1], after)


def _new_turns(
    change: Change,
    shape: tuple[Wanted, Wanted],
    sides: Sequence[Side],
    lead: float,
    tail: float,
    incline: float,
    number: int,
) -> RoadElements:
    """Returns turns to these sides, with straights between, before and behind them."""
    (degrees, angles), (radius, radii) = shape
    grade = SLOPES[change.slope].grade if change.slope else None
    if change.grade is not None:
        grade = Range(change.grade - 0.6, change.grade + 0.6)
    asked = Feature("turn", "turn", None, angles, radii, None, grade)
    transition = min(max(TRANSITION_SHARE * radius * radians(degrees), 3.0), 12.0)
    slope = _incline_asked(change, incline)
    new = [gap(f"{NEW}{number} lead", lead, incline)] if lead else []
    for i, side in enumerate(sides):
        if i:
            new.append(gap(f"{NEW}{number} gap {i}", SEPARATE if side == sides[i - 1] else JOINT, incline))
        segments = turn_segments(degrees, 1 if side == "left" else -1, radius, transition, slope)
        new.append(RoadElement(f"{NEW}{number} turn {i + 1}", segments, side, asked=asked))
    if tail:
        new.append(gap(f"{NEW}{number} {TAIL}", tail, incline))
    return tuple(new)


def without_spare_tail(elements: RoadElements) -> RoadElements:
    """Returns the elements without the straight behind a new turn at the end of the road, if the same request
    adds a straight there; that one is then measured by itself, between the turn and the end."""
    if len(elements) < 2:
        return elements
    *front, tail, last = elements
    if not (tail.name.endswith(f" {TAIL}") and last.name.endswith(f" {STRAIGHT}")):
        return elements
    room = Range(last.length - 2.0, last.length + 2.0)
    alone = replace(last.lengthened(FADE), asked=replace(FREE_STRAIGHT, length=room))
    return (*front, alone)


def _name(elements: RoadElements, at: int) -> str:
    return elements[at].name if at < len(elements) else ""


def _incline_asked(change: Change, incline: float) -> float:
    """Returns the incline of a new element in percent: as requested, or else ``incline``."""
    if change.grade is not None:
        return change.grade
    return change.sign * AIMS[change.steepness].grade if change.way else incline


def _behind(elements: RoadElements) -> tuple[float, RoadElement | None]:
    """Returns the metres after the last turn, and that turn; None if there is no turn."""
    metres = 0.0
    for element in reversed(elements):
        if element.is_turn:
            return metres, element
        metres += element.length
    return metres, None


def _lead(turn: RoadElement | None, side: Side, gap: float) -> float:
    """Returns the metres missing between a turn, or an end of the road (None), and a new turn to ``side``."""
    needed = LEAD if turn is None else SEPARATE if turn.side == side else JOINT
    return round(needed - gap, 1) if gap < needed - 0.5 else 0.0


def _incline(elements: RoadElements, at: int) -> float:
    """Returns the incline in percent of the segment before a place, or after it at the start of the road."""
    before = joined(elements[:at])
    return before[-1].incline if before else joined(elements)[0].incline


def _straight_ways(
    change: Change, elements: RoadElements, at: int, splits: Sequence[int | None], number: int
) -> tuple[EditCandidate, ...]:
    lengths = [change.length] if change.length is not None else [NEW_STRAIGHT, 30.0, 60.0, 22.0]
    if lengths[0] < 10:
        raise EditError(f"a straight of {lengths[0]:g} m is not seen as one; ask for 10 m or more")
    incline = _incline_asked(change, _incline(elements, at))
    beside = elements[at] if at < len(elements) and not elements[at].is_turn else elements[at - 1]
    if change.is_whole and change.length is not None and not beside.is_turn and beside.seen is not None:
        return ((Adjust(beside, length=Wanted.near(change.length, 1.0)),),)
    if not beside.is_turn and beside.seen is None:  # then the new straight is seen by itself
        new = [
            replace(
                gap(f"{NEW}{number} {STRAIGHT}", length + FADE, incline),
                asked=replace(FREE_STRAIGHT, length=Range(length - 2.0, length + 2.0)),
            )
            for length in lengths
        ]
    else:
        new = [gap(f"{NEW}{number} {STRAIGHT}", length, incline) for length in lengths]
        if change.length is not None:  # then it stays as long as the words say
            new = [replace(each, asked=None) for each in new]
    return tuple((Insert(_name(elements, at), (each,), split),) for split in splits for each in new)


def removal_candidates(gone: Sequence[RoadElement], elements: RoadElements) -> tuple[EditCandidate, ...]:
    """Returns all candidates that remove the elements ``gone``; one of them leaves short straights in the
    places of removed turns."""
    if len(gone) == len([b for b in elements if b.segments]):
        raise EditError("then no road would be left; remove fewer")
    return tuple(tuple(_without(element, elements, filler) for element in gone) for filler in FILLERS)


def _without(element: RoadElement, elements: RoadElements, filler: float) -> EditStep:
    at = elements.index(element)
    if not element.is_turn:
        sides = [beside.side for beside in elements[max(at - 1, 0) : at + 2] if beside.is_turn]
        if len(sides) == 2 and sides[0] == sides[1]:
            return Adjust(element, length=Wanted.near(HIDDEN, 0.6))
        return Become(element, tuple(segment for segment in element.segments if segment.turn_degrees))
    return Become(element, (straight(filler, element.incline),) if filler else ())
