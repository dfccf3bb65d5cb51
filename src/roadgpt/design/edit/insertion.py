"""Makes candidates that add or remove turns and straights; the elements around them keep all their values."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import radians

from roadgpt.brief.change.request import Change
from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.brief.outline import Feature
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import KINDS, SHARPNESS, SLOPES
from roadgpt.design.edit.placing import PlacedChange
from roadgpt.design.edit.slopes import AIMS
from roadgpt.design.edit.steps import (
    HIDDEN,
    MILLIMETRE,
    SEPARATE,
    Adjust,
    Become,
    EditCandidate,
    EditStep,
    Wanted,
)
from roadgpt.design.elements import straight, turn_segments
from roadgpt.design.road_elements import FREE_STRAIGHT, RoadElement, RoadElements, gap
from roadgpt.errors import EditError
from roadgpt.road import World

JOINT = 8.0  # m between turns to opposite sides
LEAD = 17.0  # m before the first turn and behind the last
NEW_STRAIGHT = 40.0  # m, length of a new straight if the request gives none
SPARE = (0.0, 20.0)
"""Additional metres of straight road before and after a new turn; the second value is tried if the first does
not lead to a valid road, for example because the road would meet itself.
"""
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
MOST_NEW = 12
FILLERS = (0.0, SEPARATE)  # m of straight road in the place of a removed turn


@dataclass(frozen=True, slots=True)
class Insert:
    """Inserts new elements before the element named ``before``, or at the end if the name is empty."""

    before: str
    elements: RoadElements
    split: str = ""
    """Name of a gap to split in two, so that the new elements are inserted between its halves; empty to
    split none.
    """
    index: int = 0
    """Number of segments in the first half of the split gap; 0 to split its longest segment in half."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements in driving order, with the new ones inserted."""
        if self.split:
            return tuple(
                part for b in elements for part in (self._halves(b) if b.name == self.split else (b,))
            )
        names = [element.name for element in elements]
        at = names.index(self.before) if self.before else len(elements)
        return (*elements[:at], *self.elements, *elements[at:])

    def _halves(self, element: RoadElement) -> RoadElements:
        segments, at = list(element.segments), self.index
        if not at:
            longest = max(range(len(segments)), key=lambda i: segments[i].distance)
            half = round(segments[longest].distance / 2 * MILLIMETRE) / MILLIMETRE
            rest = round((segments[longest].distance - half) * MILLIMETRE) / MILLIMETRE
            one = segments[longest]
            segments[longest : longest + 1] = [
                one.model_copy(update={"distance": half}),
                one.model_copy(update={"distance": rest}),
            ]
            at = longest + 1
        first, second = (
            element.with_segments(segments[:at]),
            replace(element, name=f"{element.name} rest", seen=None),
        )
        return (first, *self.elements, second.with_segments(segments[at:]))


def insertion_candidates(
    placed: PlacedChange, elements: RoadElements, world: World, number: int
) -> tuple[EditCandidate, ...]:
    """Returns all candidates that add what the change asks for.

    Args:
        placed: what to add, and the elements that say where.
        elements: the elements of the road before the edit.
        world: the limits that the rules check, such as the steepest grade.
        number: number of this change within its request; it is used to name new elements.

    Raises:
        EditError: the place does not exist, turns of this kind or number cannot be added, or no turn or
            straight can have the requested values.
    """
    change = placed.change
    if change.count > MOST_NEW:
        raise EditError(f"{change.count} turns at once are too many to add; add {MOST_NEW} or fewer")
    if change.kind is not None and change.kind not in PREFERRED:
        raise EditError(f"'{change.kind}' cannot be added; add turns or straights in its place")
    before, splits = _place(placed, elements)
    if change.target is not None and change.target.noun == "straight":
        return _straight_ways(change, elements, before, splits, number)
    shape = _shape(change, world)
    return tuple(
        (_turns(change, elements, before, split, sides, shape, spare, number),)
        for spare in SPARE
        for sides in _sides(change, elements, before)
        for split in splits
    )


def _place(placed: PlacedChange, elements: RoadElements) -> tuple[str, list[tuple[str, int]]]:
    """Returns the name of the element before which to insert, and the ways to split a gap for this.

    The name is empty for the end of the road. Each way is the name of the gap to split, empty to split none,
    and the number of segments before the split, as in ``Insert.index``.
    """
    place, mark, stop = placed.change.place, placed.marks, placed.stop
    how = place.how if place else "end"
    if how == "end":
        return "", [("", 0)]
    if how == "start":
        return elements[0].name, [("", 0)]
    if how == "middle" or place is None or place.target is None:
        gap, index = _middle(elements)
        return gap.name, [(gap.name, index)]
    if how == "on":
        if mark[0].kind == "turn":
            raise EditError("a turn cannot be added within a turn; say: after the second turn")
        return mark[0].name, [(mark[0].name, 0)]
    if how == "before" and mark[0].name != "":
        return mark[0].name, [("", 0)]
    at = elements.index(mark[-1])
    after = elements[at + 1].name if at + 1 < len(elements) else ""
    if how == "between":
        splits: list[tuple[str, int]] = []
        if stop is not None:
            end = elements.index(stop)
            if end < at:
                raise EditError(
                    "the two places stand the other way round on the road; name the first one first"
                )
            if end == at:
                raise EditError("between a turn and itself is no place; name two turns")
            is_same = place.other is not None and place.other.words == place.target.words
            if is_same and any(b.kind == "turn" for b in elements[at + 1 : end]):
                raise EditError(f"between '{place.target.words}' are several places; name two turns")
        gap = elements[at + 1] if at + 1 < len(elements) else elements[at]
        for index in range(1, len(gap.segments)):
            left = sum(s.distance for s in gap.segments[:index])
            if min(left, gap.length - left) >= SEPARATE:
                splits.append((gap.name, index))
        return after, [*splits[:1], ("", 0)]
    return after, [("", 0)]


def _middle(elements: RoadElements) -> tuple[RoadElement, int]:
    """Returns the gap nearest to the road's middle, and where to split it, as in ``Insert.index``."""
    whole, at = sum(element.length for element in elements), 0.0
    best, found = float("inf"), (elements[0], 0)
    for element in elements:
        if element.kind == "gap" and element.segments:
            joint = at
            for index, segment in enumerate(element.segments):
                if index and abs(joint - whole / 2) < best:
                    best, found = abs(joint - whole / 2), (element, index)
                joint += segment.distance
            centre = at + element.length / 2
            if abs(centre - whole / 2) < best:
                best, found = abs(centre - whole / 2), (element, 0)
        at += element.length
    return found


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
    if change.kind and change.kind in PREFERRED:
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


def _sides(change: Change, elements: RoadElements, before: str) -> list[list[Side]]:
    """Returns the sequences of sides to try for the new turns.

    If no side is requested, the first sequence begins opposite to the turn before, the second on its side.
    """
    count = change.count * (2 if change.kind in ("s_bend", "chicane") else 1)
    alternates = change.kind in ("s_bend", "chicane") or (count > 1 and change.side is None)
    firsts: list[Side] = [change.side] if change.side else _away(elements, before)
    out = []
    for side in firsts:
        row: list[Side] = [side]
        while len(row) < count:
            row.append(OTHER_SIDE[row[-1]] if alternates else side)
        out.append(row)
    return out


def _away(elements: RoadElements, before: str) -> list[Side]:
    names = [element.name for element in elements]
    at = names.index(before) if before else len(elements)
    last = next((b.side for b in reversed(elements[:at]) if b.kind == "turn"), None) or "right"
    return [OTHER_SIDE[last], "left" if last == "left" else "right"]


def _turns(
    change: Change,
    elements: RoadElements,
    before: str,
    split: tuple[str, int],
    sides: Sequence[Side],
    shape: tuple[Wanted, Wanted],
    spare: float,
    number: int,
) -> EditStep:
    names = [element.name for element in elements]
    at = names.index(before) if before else len(elements)
    gap_before, turn_before = _behind(elements[:at])
    gap_after, turn_after = _behind(tuple(reversed(elements[at:])))
    if split[0]:
        own = elements[at].segments
        index = split[1]
        first = sum(s.distance for s in own[:index]) if index else elements[at].length / 2
        gap_before, gap_after = gap_before + first, gap_after - first
    incline = _incline(elements, at)
    lead = _lead(turn_before, sides[0], gap_before) + spare
    tail = _lead(turn_after, sides[-1], gap_after) + spare
    (degrees, angles), (radius, radii) = shape
    asked = Feature("turn", "turn", None, angles, radii, None, _grade(change))
    slope = _incline_asked(change, incline)
    transition = min(max(TRANSITION_SHARE * radius * radians(degrees), 3.0), 12.0)
    new = [gap(f"new {number} lead", lead, incline)] if lead else []
    for i, side in enumerate(sides):
        if i:
            new.append(gap(f"new {number} gap {i}", SEPARATE if side == sides[i - 1] else JOINT, incline))
        name = f"new {number} turn {i + 1}"
        segments = turn_segments(degrees, 1 if side == "left" else -1, radius, transition, slope)
        new.append(RoadElement(name, "turn", segments, side, asked=asked))
    if tail:
        new.append(gap(f"new {number} tail", tail, incline))
    return Insert(before, tuple(new), *split)


def _grade(change: Change) -> Range | None:
    """Returns the requested range of grades in percent; None if the request gives none."""
    if change.grade is not None:
        return Range(change.grade - 0.6, change.grade + 0.6)
    return SLOPES[change.slope].grade if change.slope else None


def _incline_asked(change: Change, incline: float) -> float:
    """Returns the incline of a new element in percent: as requested, or else ``incline``."""
    if change.grade is not None:
        return change.grade
    return change.sign * AIMS[change.steepness].grade if change.way else incline


def _behind(elements: RoadElements) -> tuple[float, RoadElement | None]:
    """Returns the metres after the last turn, and that turn; None if there is no turn."""
    metres = 0.0
    for element in reversed(elements):
        if element.kind == "turn":
            return metres, element
        metres += element.length
    return metres, None


def _lead(turn: RoadElement | None, side: Side, gap: float) -> float:
    """Returns the metres missing between a turn, or an end of the road (None), and a new turn to ``side``."""
    needed = LEAD if turn is None else SEPARATE if turn.side == side else JOINT
    return round(needed - gap, 1) if gap < needed - 0.5 else 0.0


def _incline(elements: RoadElements, at: int) -> float:
    """Returns the incline in percent of the segment before a place, or after it at the start of the road."""
    before = [s for element in elements[:at] for s in element.segments]
    after = [s for element in elements[at:] for s in element.segments]
    return before[-1].incline if before else after[0].incline


def _straight_ways(
    change: Change, elements: RoadElements, before: str, splits: Sequence[tuple[str, int]], number: int
) -> tuple[EditCandidate, ...]:
    names = [element.name for element in elements]
    at = names.index(before) if before else len(elements)
    lengths = [change.length] if change.length is not None else [NEW_STRAIGHT, 30.0, 60.0, 22.0]
    if lengths[0] < 10:
        raise EditError(f"a straight of {lengths[0]:g} m is not seen as one; ask for 10 m or more")
    incline = _incline_asked(change, _incline(elements, at))
    beside = elements[at] if before and elements[at].kind == "gap" else elements[at - 1]
    if change.is_whole and change.length is not None and beside.kind == "gap" and beside.seen is not None:
        return ((Adjust(beside, length=Wanted.near(change.length, 1.0)),),)
    stands_alone = beside.kind == "gap" and beside.seen is None
    out = []
    for split in splits:
        for length in lengths:
            new = gap(f"new {number} straight", length + 2.0, incline)
            if stands_alone:
                room = Range(length - 2.0, length + 2.0)
                new = replace(new, asked=replace(FREE_STRAIGHT, length=room))
            out.append((Insert(before, (new,), *split),))
    return tuple(out)


def removal_candidates(gone: Sequence[RoadElement], elements: RoadElements) -> tuple[EditCandidate, ...]:
    """Returns all candidates that remove the elements ``gone``; one of them leaves short straights in the
    places of removed turns.

    Raises:
        EditError: No element would be left.
    """
    if len(gone) == len([b for b in elements if b.segments]):
        raise EditError("then no road would be left; remove fewer")
    return tuple(tuple(_without(element, elements, filler) for element in gone) for filler in FILLERS)


def _without(element: RoadElement, elements: RoadElements, filler: float) -> EditStep:
    at = elements.index(element)
    if element.kind == "gap":
        bends = tuple(s for s in element.segments if s.turn_degrees)
        sides = [
            b.side for b in (*elements[max(at - 1, 0) : at], *elements[at + 1 : at + 2]) if b.kind == "turn"
        ]
        if len(sides) == 2 and sides[0] == sides[1]:
            return Adjust(element, length=Wanted.near(HIDDEN, 0.6))
        return Become(element, bends)
    return Become(element, (straight(filler, element.incline),) if filler else ())
