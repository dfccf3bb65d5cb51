"""Ways to add turns and straights; what stands around them keeps every number."""

from collections.abc import Sequence
from dataclasses import replace
from math import radians

from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.design.edit.candidates import EditCandidate
from roadgpt.design.edit.pointing import pointed
from roadgpt.design.edit.request import Change
from roadgpt.design.edit.spacing import SEPARATE, gap
from roadgpt.design.edit.steps import Adjust, EditStep, Goal, Insert, turn_segments
from roadgpt.design.elements import least_radius
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.errors import EditError
from roadgpt.road import World

JOINT = 8.0  # m between turns of either hand
LEAD = 17.0  # m before the first turn and behind the last
NEW_STRAIGHT = 40.0  # m of one whose length was not said
SPARE = ((0.0, 0.0), (20.0, 0.0), (0.0, 20.0), (25.0, 25.0), (45.0, 0.0), (0.0, 45.0))
"""Metres of straight road before and behind a new turn, besides what it needs: where it would meet others."""
TRANSITION_SHARE = 0.22  # of the arc

# Degrees and radii, metres, that are tried.
ANY = ((60, 25), (50, 22), (45, 32), (75, 22), (90, 20), (40, 20), (35, 28), (110, 18), (30, 40))
KINDS = {
    "hairpin": ((168, 18), (160, 16.5), (176, 21), (152, 17), (146, 19)),
    "u_turn": ((178, 18), (170, 16.5), (184, 21), (160, 17)),
    "s_bend": ((50, 25), (40, 22), (60, 20), (35, 30)),
    "chicane": ((45, 20), (40, 18), (55, 18), (35, 22)),
}
SHARPNESS = {
    "sharp": ((80, 20), (60, 18), (95, 17.5), (50, 20), (42, 21)),
    "gentle": ((40, 55), (30, 52), (25, 50), (50, 48), (60, 46)),
    "sweeping": ((40, 75), (30, 72), (25, 70), (55, 68)),
}


def insertion_candidates(
    change: Change, elements: RoadElements, world: World, number: int
) -> tuple[EditCandidate, ...]:
    """Returns all candidates that add what a change asks for.

    Args:
        change: what, and where.
        elements: of the road before the edit.
        world: limits.
        number: of the change, for the names of new elements.

    Raises:
        EditError: the place does not exist, or no turn can be like that.
    """
    before, splits = _place(change, elements)
    if change.target is not None and change.target.noun == "straight":
        return _straight_ways(change, elements, before, splits, number)
    out: list[EditCandidate] = []
    # first all places with the first measures, then all with the second, ...
    for spare in SPARE:
        for measures in _measures(change, world):
            for sides in _sides(change, elements, before):
                for split in splits:
                    out.append((_turns(change, elements, before, split, sides, measures, spare, number),))
    return tuple(out)


def _place(change: Change, elements: RoadElements) -> tuple[str, list[tuple[str, int]]]:
    """The element to stand before (empty: none), and gaps that may be split instead, with their segment."""
    place = change.place
    how = place.how if place else "end"
    if how == "end":
        return "", [("", 0)]
    if how == "start":
        return elements[0].name, [("", 0)]
    if how == "middle" or place is None or place.target is None:
        gap, index = _middle(elements)
        return gap.name, [(gap.name, index)]
    noun = place.target.noun or "turn"
    mark = pointed(replace(place.target, noun=noun), elements, "length")
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
        if place.other is not None:
            stop = elements.index(
                pointed(replace(place.other, noun=place.other.noun or "turn"), elements, "length")[0]
            )
            if stop < at:
                raise EditError(
                    "the two places stand the other way round on the road; name the first one first"
                )
            if stop == at:
                raise EditError("between a turn and itself is no place; name two turns")
            if place.other.words == place.target.words and any(
                b.kind == "turn" for b in elements[at + 1 : stop]
            ):
                raise EditError(f"between '{place.other.words}' are several places; name two turns")
        gap = elements[at + 1] if at + 1 < len(elements) else elements[at]
        for index in range(1, len(gap.segments)):
            left = sum(s.distance for s in gap.segments[:index])
            if min(left, gap.length - left) >= SEPARATE:
                splits.append((gap.name, index))
        return after, [*splits[:1], ("", 0)]
    return after, [("", 0)]


def _middle(elements: RoadElements) -> tuple[RoadElement, int]:
    """The gap nearest to the road's middle, and its nearest joint; 0: halve its longest segment."""
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


def _measures(change: Change, world: World) -> list[tuple[float, float]]:
    pairs: Sequence[tuple[float, float]] = ANY
    if change.kind in KINDS:
        pairs = KINDS[change.kind]
    elif change.sharpness in SHARPNESS:
        pairs = SHARPNESS[change.sharpness]
    least = least_radius(world)
    if change.radius is not None and change.radius < world.min_radius:
        raise EditError(
            f"a radius of {change.radius:g} m is tighter than the {world.min_radius:.1f} m that the rules "
            f"allow; ask for {least:.0f} m or more"
        )
    if change.degrees is not None and not 11 <= change.degrees <= 240:
        raise EditError(f"a turn of {change.degrees:g} degrees cannot be added; ask for 15 to 210 degrees")
    out: list[tuple[float, float]] = []
    for degrees, radius in pairs:
        pair = (change.degrees or degrees, max(change.radius or radius, least))
        if pair not in out:
            out.append(pair)
    return out


def _sides(change: Change, elements: RoadElements, before: str) -> list[list[Side]]:
    """Sides of the new turns: as said, else away from the turn before."""
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
    measures: tuple[float, float],
    spare: tuple[float, float],
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
    new: list[RoadElement] = []
    goals: list[Goal] = []
    lead = _lead(turn_before, sides[0], gap_before) + spare[0]
    if lead:
        new.append(gap(f"new {number} lead", lead, incline))
    degrees, radius = measures
    transition = min(max(TRANSITION_SHARE * radius * radians(degrees), 3.0), 12.0)
    for i, side in enumerate(sides):
        if i:
            new.append(gap(f"new {number} gap {i}", SEPARATE if side == sides[i - 1] else JOINT, incline))
        name = f"new {number} turn {i + 1}"
        segments = turn_segments(degrees, 1 if side == "left" else -1, radius, transition, incline)
        new.append(RoadElement(name, "turn", segments, side))
        goals += _goals(change, name, degrees, radius)
    tail = _lead(turn_after, sides[-1], gap_after) + spare[1]
    if tail:
        new.append(gap(f"new {number} tail", tail, incline))
    return Insert(before, tuple(new), tuple(goals), *split)


def _goals(change: Change, name: str, degrees: float, radius: float) -> list[Goal]:
    slack = 1.5 if change.degrees is not None else 4.0
    out = [Goal(name, "degrees", degrees, degrees - slack, degrees + slack)]
    if change.radius is not None or change.sharpness or change.kind:
        high = radius * (1.05 if change.radius is not None else 1.3)
        low = radius * (0.95 if change.radius is not None else 0.88)
        if change.sharpness == "sharp":
            high = min(high, 29.0)
        out.append(Goal(name, "radius", radius, low, high))
    if change.grade is not None:
        out.append(Goal(name, "grade", change.grade, change.grade - 0.6, change.grade + 0.6))
    elif change.way:
        low, aim, high = {"up": (3.0, 5.0, 12.0), "down": (-12.0, -5.0, -3.0), "flat": (-0.8, 0.0, 0.8)}[
            change.way
        ]
        out.append(Goal(name, "grade", aim, low, high))
    return out


def _behind(elements: RoadElements) -> tuple[float, RoadElement | None]:
    """Metres since the last turn, and that turn."""
    metres = 0.0
    for element in reversed(elements):
        if element.kind == "turn":
            return metres, element
        metres += element.length
    return metres, None


def _lead(turn: RoadElement | None, side: Side, gap: float) -> float:
    """Metres that are missing between a turn (None: an end of the road) and the next of that side."""
    needed = LEAD if turn is None else SEPARATE if turn.side == side else JOINT
    return round(needed - gap, 1) if gap < needed - 0.5 else 0.0


def _incline(elements: RoadElements, at: int) -> float:
    """Percent, of what stands next to a place."""
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
    incline = _incline(elements, at)
    if change.grade is not None:
        incline = change.grade
    elif change.way:
        incline = {"up": 5.0, "down": -5.0, "flat": 0.0}[change.way]
    beside = elements[at] if before and elements[at].kind == "gap" else elements[at - 1]
    if change.is_whole and change.length is not None and beside.kind == "gap" and beside.seen is not None:
        return ((Adjust(beside, length=change.length),),)
    stands_alone = beside.kind == "gap" and beside.seen is None
    name = f"new {number} straight"
    out = []
    for split in splits:
        for length in lengths:
            new = (gap(name, length + 2.0, incline),)
            goal = Goal(name, "length", length, length - 2.0, length + 2.0)
            out.append((Insert(before, new, (goal,) if stands_alone else (), *split),))
    return tuple(out)
