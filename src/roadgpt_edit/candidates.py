"""Lists ways to make a change, and makes all changes of a stage at once. Main function: ``made``.

A candidate has target values, and ranges for the values measured on the changed road. A request without a
number ('sharper') allows wide ranges. If the request gives a value, such as the angle of a turn, only other
values, such as the radius, may vary. A further candidate aims at a smaller change, has wider ranges, or lets
more elements change. Changes of one element must agree: each sets only what its own change is about. Alone,
"tighter" keeps the angle of a turn, and "sharper" its radius. In one request they must not.

Combinations of one candidate per change are tried; combinations of preferred candidates come first. The steps
of the candidates are applied to the elements of the road. Then ``fit`` changes the elements that the
request names until the road is valid and its measurements are as requested; all other elements are frozen. If
that fails and the geometry is ``arcs``, the other elements may change as well. The start moves if the road is
reversed or mirrored, or if elements are added in front of it. If the road would leave the map, the road is
shifted or rotated. If that is not enough, a map of the usual size grows; on any other map, elements that the
request does not name change."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise, product, takewhile
from math import atan2, cos, degrees, hypot, inf, pi, radians, sin
from typing import Any, NamedTuple

from roadgpt.brief.change.request import NUMBERING, Change, What, clash
from roadgpt.brief.map_fit import ROUND_MAP
from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.brief.outline import Feature
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import KINDS, LEAST_STRAIGHT
from roadgpt.check.measures import RoadMeasures, way
from roadgpt.design.elements import straight
from roadgpt.errors import EditError, IdleEditError, UsageError
from roadgpt.road import Design, Geometry, World, build
from roadgpt.road.design import MAX_SEGMENTS
from roadgpt_edit.fit import FittedRoad, Requirements, fit, graded
from roadgpt_edit.onto_map import moved_onto_map
from roadgpt_edit.places import PlacedChange, is_beyond, straights, turns
from roadgpt_edit.road_elements import RoadElement, RoadElements, elements_on_road, gap, joined, numbered
from roadgpt_edit.ways import (
    SEPARATE,
    WIDEST,
    Adjust,
    Become,
    EditCandidate,
    EditStep,
    Mirror,
    RoadLength,
    SlopeOfAll,
    Wanted,
    climb_step,
    hill_candidates,
    hill_sentence,
    insertion_candidates,
    refuse_too_tight,
    removal_candidates,
    slope_candidates,
    slope_steps,
    stretch_candidates,
    without_spare_tail,
)

YIELDS: Mapping[What, Mapping[str, frozenset[What]]] = {
    "angle": {"radius": frozenset({"radius", "shape"})},
    "radius": {"degrees": frozenset({"angle", "shape"})},
    "shape": {"radius": frozenset({"radius"})},
    "side": {"degrees": frozenset({"angle", "shape"}), "radius": frozenset({"radius", "shape"})},
    "mirror": {"degrees": frozenset({"angle", "shape"}), "radius": frozenset({"radius", "shape"})},
}
"""For each change, the values that its steps set beside its own, and the changes that have these values as
their own; where an element has such a change, the step leaves the value to it."""
LEAST_SEEN = 0.03  # of a value: a smaller change is hardly seen
NEAR = 0.02  # of a limit: what a value at the limit may miss
VALUES: Mapping[What, str] = {"angle": "degrees", "radius": "radius", "length": "length"}
LONGER, SHORTER = 1.4, 0.65  # shares of a length
ROAD_LONGER, ROAD_SHORTER = 1.3, 0.75  # shares of the length of a road
SEEN = 10.6  # m: the shortest straight that is seen
KEPT = 17.5  # m that remain of each straight when the road is shortened
ROAD_SLACK = 0.02  # of the length of a road
REVERSED = "the road leads from its former end to its former start; its parts are named as before"
RENAMED = "what follows names the parts as they come in the new direction"
SHARPER, GENTLER = (1.25, 0.75), (0.75, 1.33)  # shares of angle and radius to aim at
TIGHTER, WIDER = 0.7, 1.4  # shares of the radius
FLIPPED = Range(0.65, 1.25)  # shares of angle and radius that a turn may have when it goes the other way
LEAST_STEP = 10.0  # degrees that 'sharper' adds at least
SEEN_STEP = 9.0  # degrees: a smaller change of angle is hardly seen
LEAST_ANGLE = 13.0  # degrees: a turn of a smaller angle would not be seen
MOST_ANGLE = 210.0


def agreed(
    changes: Sequence[PlacedChange], ways: Sequence[tuple[EditCandidate, ...]]
) -> list[tuple[EditCandidate, ...]]:
    """Returns the candidates of all changes, with steps that leave other values to the other changes of the
    same element, and stay within its limits ("tighter, but at least 25 m")."""
    asked = defaultdict[str, list[Change]](list)
    for placed in changes:
        for element in placed.elements:
            asked[element.name].append(placed.change)

    def own(step: EditStep, placed: PlacedChange) -> EditStep:
        if not isinstance(step, Adjust):
            return step
        change, is_one_of_several = placed.change, len(placed.elements) > 1
        others = [other for other in asked[step.element.name] if other is not change]
        step = _yielding(step, change, others)
        return _within_limits(step, change, others, is_one_of_several) if _is_open(change) else step

    return [
        tuple(tuple(own(step, placed) for step in way) for way in its)
        for placed, its in zip(changes, ways, strict=True)
    ]


def _is_open(change: Change) -> bool:
    return change.more != 0 and change.by is None


def _yielding(step: Adjust, change: Change, others: Sequence[Change]) -> Adjust:
    whats = {other.what for other in others}
    owned = YIELDS.get(change.what, {})
    left: dict[str, Any] = {name: None for name in owned if not whats.isdisjoint(owned[name])}
    # of a hairpin the angle is its own; of a gentle or sharp turn another change may set it
    if change.what == "shape" and change.kind is None and "angle" in whats:
        left["degrees"] = None
    degrees, seen = step.degrees, step.element.seen
    if change.what == "angle" and _is_open(change) and "radius" in left and degrees and seen:
        # alone, a small change of angle may become one of the radius
        left["degrees"] = Wanted.towards(seen.degrees, degrees.aim)
    return replace(step, **left)


def _within_limits(step: Adjust, change: Change, others: Sequence[Change], is_one_of_several: bool) -> Adjust:
    """Returns the step of a change without a number ("tighter") with its value inside the limits that other
    changes set, or at the limit if that is a smaller change than usual. A value that is at the limit already
    stays, if other elements change as well; otherwise the step is unchanged, and breaks the limit."""
    name = VALUES.get(change.what, "")
    wanted: Wanted | None = getattr(step, name, None)
    bounds = {
        side: [other.to for other in others if (other.what, other.bound) == (change.what, side) and other.to]
        for side in (1, -1)
    }
    if wanted is None or not (bounds[1] or bounds[-1]):
        return step
    low, high = max([wanted.room.lo, *bounds[1]]), min([wanted.room.hi, *bounds[-1]])
    if low <= high:
        aim = min(max(wanted.aim, low), high)
        return _with(step, name, Wanted(aim, Range(low, high)))
    now = getattr(step.element.seen, name)
    limit = low if change.more < 0 else high
    change_left = (limit / now - 1) * change.more
    if change_left > LEAST_SEEN:
        return _with(step, name, Wanted.near(limit, NEAR * limit))
    is_there = is_one_of_several and change_left >= -NEAR
    return _with(step, name, Wanted.near(now, NEAR * now)) if is_there else step


def _with(step: Adjust, name: str, wanted: Wanted) -> Adjust:
    values: dict[str, Any] = {name: wanted}
    return replace(step, **values)


def length_steps(change: Change, element: RoadElement, world: World) -> list[EditStep]:
    """Returns the step that gives one turn or straight another length."""
    seen = element.seen
    before = seen.length if seen else element.length
    aim = change.aim(before)
    share = 1 + ((LONGER if change.more > 0 else SHORTER) - 1) * change.dose
    wished = before * share if aim is None else aim
    if element.is_turn:
        assert seen is not None
        tight = world.limits.design_radius
        if seen.radius * wished / before >= tight:
            wanted = Wanted.near(wished, 0.06 * wished) if aim is not None else Wanted.towards(before, wished)
            return [Adjust(element, Wanted.near(seen.degrees, 2.0), None, wanted)]
        share = max(wished / before / (tight / seen.radius), 0.3)  # then it also turns less far
        return [Adjust(element, Wanted.near(seen.degrees * share, 4.0), Wanted.near(tight, 0.12 * tight))]
    if aim is None:
        wished = max(wished, before + 15 if change.more > 0 else 0.0, min(SEEN + 1, before))
        room = Wanted.towards(before, wished).room
        room = Range(max(min(room.lo, wished - 0.5), LEAST_STRAIGHT), max(room.hi, wished + 0.5))
        return [Adjust(element, length=Wanted(wished, room))]
    if wished < SEEN - 0.6:
        raise EditError(
            f"a straight of {max(wished, 0):.0f} m is not seen as one; ask for 10 m or more, or remove it"
        )
    return [Adjust(element, length=Wanted.near(max(wished, SEEN), max(1.0, 0.02 * wished)))]


def road_length_candidates(
    change: Change, elements: Sequence[RoadElement], world: World
) -> tuple[EditCandidate, ...]:
    """Returns candidates that change the road's length by its straights alone, or by its turns as well."""
    own = sum(element.length for element in elements)
    aim = change.aim(own)
    if aim is None:
        aim = own * (1 + ((ROAD_LONGER if change.more > 0 else ROAD_SHORTER) - 1) * change.dose)
    if aim < world.limits.min_length:
        raise EditError(f"a road of {aim:.0f} m is too short; ask for {world.limits.min_length:g} m or more")
    slack = max(2.0, ROAD_SLACK * aim)
    whole = RoadLength(Range(aim - slack, aim + slack))
    lengths = [(e, e.seen.length) for e in elements if not e.is_turn and e.seen is not None]
    spare = [length if aim > own else max(length - KEPT, 0.0) for _, length in lengths]
    share = (aim - own) / max(sum(spare), 1e-9)
    wanted = [length + share * part for (_, length), part in zip(lengths, spare, strict=True)]
    straights: list[EditStep] = [
        Adjust(element, length=Wanted(aim, Range(SEEN)))
        for (element, _), aim in zip(lengths, wanted, strict=True)
    ]
    everything: list[EditStep] = [Adjust(each, length=Wanted(now, Range(SEEN))) for each, now in lengths]
    for seen, element in ((e.seen, e) for e in elements if e.is_turn):
        assert seen is not None
        radius = Range(min(world.limits.design_radius, seen.radius), max(WIDEST, seen.radius))
        everything.append(Adjust(element, Wanted.near(seen.degrees, 2.0), Wanted(seen.radius, radius)))
    can = sum(spare) and share > -1
    return ((*straights, whole), (*everything, whole)) if can else ((*everything, whole),)


@dataclass(frozen=True, slots=True)
class Reverse:
    """Reverses the whole road: climbs become falls, and left turns become right turns."""

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements from the last to the first, each reversed."""
        return tuple(
            element.with_segments(
                segment.model_copy(update={"incline": 0.0 - segment.incline})
                for segment in reversed(element.segments)
            )
            for element in map(RoadElement.mirrored, reversed(elements))
        )


@dataclass(frozen=True, slots=True)
class Swap:
    """Lets two elements change places; each keeps its length, angle, radius, side and grade."""

    one: str
    other: str

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements in their new order."""
        by_name = {element.name: element for element in elements}
        places = {self.one: by_name[self.other], self.other: by_name[self.one]}
        return tuple(places.get(element.name, element) for element in elements)


@dataclass(frozen=True, slots=True)
class Move:
    """Moves turns to another place among the turns; each keeps its angle, radius, side and grade. The
    straights between them stay where they are."""

    names: tuple[str, ...]
    after: str  # the name of the turn behind which the moved turns come; empty for the beginning of the road

    def apply(self, elements: RoadElements, world: World) -> RoadElements:
        """Returns the elements in their new order."""
        turns = [element for element in elements if element.is_turn]
        moved = [turn for turn in turns if turn.name in self.names]
        others = [turn for turn in turns if turn.name not in self.names]
        names = [turn.name for turn in others]
        index = names.index(self.after) + 1 if self.after else 0
        order = iter((*others[:index], *moved, *others[index:]))
        return tuple(next(order) if element.is_turn else element for element in elements)


def move_of(placed: PlacedChange, elements: RoadElements) -> tuple[EditCandidate, ...]:
    """Returns the candidate that moves turns to another place among the turns; none if already there."""
    moved = [element.name for element in placed.elements]
    place = placed.change.place
    if place is None or not all(element.is_turn for element in placed.elements):
        raise EditError(f"'{placed.change.words}' moves a straight; only turns can be moved")
    before = _turn_names(elements)
    others = [name for name in before if name not in moved]
    at = {element.name: index for index, element in enumerate(elements)}
    match place.how:
        case "start":
            index = 0
        case "end":
            index = len(others)
        case "middle":
            index = len(others) // 2
        case how:
            marks = (*placed.marks, *([placed.stop] if placed.stop else []))
            if any(mark.name in moved for mark in marks):
                raise EditError(f"'{placed.change.words}' moves a turn next to itself; name another place")
            mark = at[placed.marks[0 if how == "before" else -1].name]
            if placed.stop and at[placed.stop.name] <= mark:
                raise EditError(f"'{placed.change.words}' names its places the other way round")
            index = sum(at[name] < mark + (how != "before") for name in others)
    if (*others[:index], *moved, *others[index:]) == before:
        return ()
    return ((Move(tuple(moved), others[index - 1] if index else ""),),)


def _turn_names(elements: Sequence[RoadElement]) -> tuple[str, ...]:
    return tuple(element.name for element in turns(elements))


class ChangeCandidates(NamedTuple):
    """The ways in which one change of a request can be made."""

    placed: PlacedChange  # the change, and the elements that it refers to
    ways: tuple[EditCandidate, ...]
    """All candidates, the preferred one first; none if the road already is as requested."""

    @property
    def change(self) -> Change:
        """The change."""
        return self.placed.change


def candidates_of(
    changes: Sequence[PlacedChange], elements: RoadElements, found: RoadMeasures, world: World, first: int = 1
) -> tuple[ChangeCandidates, ...]:
    """Returns the ways to make each change of a stage on a road with these elements and measurements.

    ``first`` is the number of the first change in the request; names of new elements contain these numbers.
    If the road already is as one change asks, other changes of the same property leave the elements of that
    change alone: "everything uphill, the first straight level" keeps a first straight that is level."""
    sides = _sides_after(changes, elements)
    ways = [
        _ways(placed, elements, found, world, number, sides) for number, placed in enumerate(changes, first)
    ]
    idle = [placed for placed, its in zip(changes, ways, strict=True) if not its and placed.change.is_state]
    for index, placed in enumerate(changes):
        own = placed.without(idle)
        if own.elements is not placed.elements:
            ways[index] = _ways(own, elements, found, world, first + index, sides)
    return tuple(map(ChangeCandidates, changes, agreed(changes, ways)))


def sentence_of(asked: PlacedChange, before: RoadElements, placed: PlacedChange, now: RoadElements) -> str:
    """Returns what a change does to the road, if measurements alone would not tell; else an empty string.
    ``asked`` is the change on the road before the edit, with the elements ``before``; ``placed`` is the same
    change on the road to which it is made, with the elements ``now``."""
    match asked.change.what:
        case "add" if asked.change.is_hill:
            return hill_sentence(placed, now)
        case "reverse":
            return REVERSED
        case "move":
            names = _turn_names(before)
            numbers = [str(names.index(element.name) + 1) for element in asked.elements]
            moved = f"turn {numbers[0]} has" if len(numbers) == 1 else f"turns {' and '.join(numbers)} have"
            return f"{moved} moved; the turns are named as before"
        case "swap":
            noun, alike = ("turn", turns) if asked.elements[0].is_turn else ("straight", straights)
            one, other = (alike(before).index(element) + 1 for element in asked.elements)
            return f"{noun} {one} and {noun} {other} have changed places; they are named as before"
    return ""


def _ways(
    placed: PlacedChange,
    elements: RoadElements,
    found: RoadMeasures,
    world: World,
    number: int,
    sides: Sequence[Side | None],
) -> tuple[EditCandidate, ...]:
    match placed.change.what:
        case "mirror" if placed.change.target is None:
            if not any(element.is_turn for element in elements):
                raise EditError("the road has no turn, so its mirror image is the same")
            return ((Mirror(),),)
        case "reverse":
            return ((Reverse(),),)
        case "swap":
            if len({element.is_turn for element in placed.elements}) != 1 or len(placed.elements) != 2:
                raise EditError(
                    "two turns, or two straights, can change places; name two, for example: swap turns 1 "
                    "and 3"
                )
            return ((Swap(*(element.name for element in placed.elements)),),)
        case "move":
            return move_of(placed, elements)
        case "count":
            return ()  # there are as many as asked for
        case "add" if placed.change.is_hill:
            return hill_candidates(placed, elements)
        case "add":
            return insertion_candidates(placed, elements, world, number, sides)
        case "remove":
            return removal_candidates(placed.elements, elements)
        case "alternate":
            return _flipped(_out_of_turn(placed.elements), world)
        case _ if placed.stretch is not None:
            return stretch_candidates(placed.change, elements, placed.stretch, world)
        case _:
            return _change_candidates(placed.change, placed.elements, found, world)


def _change_candidates(
    change: Change, elements: Sequence[RoadElement], found: RoadMeasures, world: World
) -> tuple[EditCandidate, ...]:
    is_road = change.is_of_road
    if change.bound and change.what == "length" and is_road:
        elements = elements if change.is_outside(found.length) else []
    elif change.bound:
        elements = [element for element in elements if is_beyond(change, element)]
    ways = {way(segment.incline) for element in elements for segment in element.segments}
    is_of_parts = change.target is not None and change.target.way in ways and len(ways) > 1
    match change.what:
        case "angle" | "radius" | "shape":
            return _together(_bends(change, element, world) for element in elements)
        case "length" if is_road:
            return road_length_candidates(change, elements, world) if elements else ()
        case "length":
            return _together(length_steps(change, element, world) for element in elements)
        case "slope" if is_road or is_of_parts or (change.bound and elements):
            return slope_candidates(change, elements, is_of_parts, world)
        case "slope":
            return _together(slope_steps(change, element, found, world) for element in elements)
        case "climb" if is_road:
            return ((climb_step(change, elements, world),),)
        case "climb":  # "every straight": each of them
            return (tuple(climb_step(change, [element], world) for element in elements),)
        case "side" | "mirror":
            if any(not element.is_turn for element in elements):
                raise EditError(f"'{change.words}' is said of a straight, which has no side; name a turn")
            wrong = [b for b in elements if change.side is None or b.side != change.side]
            return _flipped(wrong, world)
        case _:  # a turn becomes a straight, as long as the turn if there is room for it
            bends = [element for element in elements if element.is_turn and element.seen]
            return _together([Become(bend, (straight(bend.length, bend.incline),))] for bend in bends)


def _out_of_turn(elements: Sequence[RoadElement]) -> list[RoadElement]:
    turns = [element for element in elements if element.is_turn]
    if not turns:
        raise EditError("there is no turn at that place; name another one")
    side, wrong = turns[0].side, list[RoadElement]()
    for turn in turns:
        wrong += [turn] if turn.side != side else []
        side = side and OTHER_SIDE[side]
    return wrong


def _sides_after(changes: Sequence[PlacedChange], elements: RoadElements) -> list[Side | None]:
    alternating = [placed for placed in changes if placed.change.what == "alternate"]
    wrong = {turn.name for placed in alternating for turn in _out_of_turn(placed.elements)}
    return [e.side and OTHER_SIDE[e.side] if e.name in wrong else e.side for e in elements]


def _together(ways: Iterable[Sequence[EditStep]]) -> tuple[EditCandidate, ...]:
    """Returns one candidate of the first steps of all elements, one of their second steps, and so on; the
    second alternative to a single Adjust is its milder version."""
    rows = [list(steps) for steps in ways if steps]
    for row in rows:
        if len(row) == 1 and isinstance(row[0], Adjust):
            row.append(row[0].milder())
    most = max(map(len, rows), default=0)
    return tuple(tuple(row[min(i, len(row) - 1)] for row in rows) for i in range(most))


def _bends(change: Change, element: RoadElement, world: World) -> list[EditStep]:
    seen = element.seen
    if not element.is_turn or seen is None:
        raise EditError(f"'{change.words}' is said of a straight, which does not bend; name a turn")
    d, r, least = seen.degrees, seen.radius, world.limits.design_radius
    if change.what == "shape":
        return _shaped(change, element, d, r, least)
    aim = change.aim(d if change.what == "angle" else r)
    if aim is not None:
        return [_bent_to(change, element, d, r, aim, world)]
    if change.what == "radius" and change.more < 0 and 0.93 * r < least:  # then it turns further
        return [Adjust(element, Wanted.towards(d, 1.25 * d), Wanted.near(r, 0.12 * r))]
    if change.what == "radius":
        aim = r * (1 + ((TIGHTER if change.more < 0 else WIDER) - 1) * min(change.dose, 1.4))
        aim = min(max(aim, min(least, r)), max(WIDEST, r))
        if abs(aim / r - 1) > 0.045:
            return [Adjust(element, Wanted.near(d, 3.0), Wanted.towards(r, aim))]
        raise _cannot(d, r)
    further, wider = SHARPER if change.more > 0 else GENTLER
    degrees = d * (1 + (further - 1) * change.dose)
    if change.more > 0:
        degrees = min(max(degrees, d + LEAST_STEP * change.dose), max(180.0, d + 5))
    else:
        degrees = max(degrees, min(LEAST_ANGLE, d))
    aim = r * max(1 + (wider - 1) * change.dose, 0.4)
    aim = min(max(aim, min(least, r)), max(WIDEST, r))
    if degrees > MOST_ANGLE or (abs(degrees - d) <= 2.5 and abs(aim / r - 1) <= 0.045):
        raise _cannot(d, r)
    if abs(degrees - d) >= SEEN_STEP:
        return [Adjust(element, Wanted.towards(d, degrees), Wanted.not_away(r, aim))]
    return [Adjust(element, Wanted.not_away(d, degrees), Wanted.towards(r, aim))]


def _cannot(degrees: float, radius: float) -> EditError:
    where = f"the turn of {degrees:.0f} degrees with a radius of {radius:.0f} m"
    return EditError(f"{where} cannot be made so; a turn has {LEAST_ANGLE:g} to {MOST_ANGLE:g} degrees")


def _bent_to(change: Change, element: RoadElement, d: float, r: float, aim: float, world: World) -> EditStep:
    if change.what == "angle":
        if not LEAST_ANGLE - 1.5 <= aim <= MOST_ANGLE:
            room = f"{LEAST_ANGLE:g} to {MOST_ANGLE:g} degrees"
            raise EditError(f"a turn of {aim:.0f} degrees cannot be made; ask for {room}")
        return Adjust(element, Wanted.near(aim, 1.0), Wanted(r, Range(0.5 * r, 2 * r)))
    refuse_too_tight(aim, f"{aim:.1f}", world)
    if aim > WIDEST:
        turn = f"a turn with a radius of {aim:.0f} m"
        raise EditError(f"{turn} is hardly seen as one; ask for {WIDEST:g} or less")
    aim = max(aim, world.limits.design_radius)
    return Adjust(element, Wanted.near(d, 4.0), Wanted.near(aim, 0.05 * aim))


def _shaped(change: Change, element: RoadElement, d: float, r: float, least: float) -> list[EditStep]:
    if change.kind in ("hairpin", "u_turn", "switchback"):
        angles = KINDS[change.kind].degrees or Range()
        if d in angles and r <= 34 and not (change.sharpness == "sharp" and r > 20):
            return []
        degrees = Wanted(d if d in angles else 170.0, angles)
        tight = min(max(min(r, 22.0), least), 30.0)
        return [Adjust(element, degrees, Wanted(tight, Range(0.98 * least, 34.0)))]
    if change.kind is not None:
        raise EditError(
            "one turn cannot be made several; say: remove the turn, and add the others in its place"
        )
    if change.sharpness == "sharp":
        if r <= 29 and d >= 32:
            return []
        degrees = Wanted(max(d, 45.0), Range(max(d, 35.0) - 2, max(d, 60.0) + 10))
        tight = max(min(0.75 * r, 22.0), least)
        return [Adjust(element, degrees, Wanted(tight, Range(0.98 * least, 29.0)))]
    bound = 60.0 if change.sharpness == "sweeping" else 40.0
    if r >= bound * 1.02 and 15 <= d <= 120:
        return []
    aim = min(max(d, 18.0), 115.0)
    radius = Wanted(max(bound * 1.12, r), Range(bound * 1.03, WIDEST))
    return [Adjust(element, Wanted(aim, Range(16.0, aim + 3)), radius)]


def _flipped(elements: Sequence[RoadElement], world: World) -> tuple[EditCandidate, ...]:
    if not elements:
        return ()
    steps: list[EditStep] = [Mirror(frozenset(element.name for element in elements))]
    for element in elements:
        d, r = (element.seen.degrees, element.seen.radius) if element.seen else (0.0, inf)
        least, most = min(LEAST_ANGLE, d - 1), max(MOST_ANGLE, d + 1)
        degrees = Range(max(FLIPPED.lo * d, least), min(FLIPPED.hi * d, most))
        radius = Range(max(FLIPPED.lo * r, min(world.limits.min_radius, 0.98 * r)), FLIPPED.hi * r)
        steps.append(Adjust(element, Wanted(d, degrees), Wanted(r, radius)))
    return (tuple(steps),)


MOST_TRIALS = 40
FITTED_WHOLE = 2  # trials that are fitted again with all elements free, if none is valid otherwise
INSIDE_MAP = "inside_map"
MOST_GROWTH = 20  # steps by which a map may grow for a changed road
LARGEST = 12  # candidates of one change that are combined with others
SLACK = 0.03  # share by which a measured value may miss a limit
SEEN_STRAIGHT = Feature("straight", "straight", length=Range(LEAST_STRAIGHT + 0.3))
HUNDREDTH = 100.0  # per degree
DECIMALS = 6  # of the start of a reversed road and its direction


def made(
    design: Design,
    elements: RoadElements,
    changes: Sequence[ChangeCandidates],
    world: World,
    geometry: Geometry,
    may_grow: bool,
) -> tuple[FittedRoad, Design]:
    """Returns the road with all changes, and a design in which only the elements named in them changed. A
    change without candidates is not needed; ``elements`` are those of the road before the stage, and
    ``may_grow`` says whether the map may become larger. If it has no room for the road and may not grow,
    other elements change. Raises EditError if the road already is as requested, or no valid road has the
    requested changes."""
    needed = [each for each in changes if each.ways]
    idle = [each for each in changes if not each.ways]
    if not needed:
        raise IdleEditError(f"nothing is to be changed: '{idle[0].change.words}' is so already")
    drafts, objection = _drafts(elements, needed, Requirements(world, before=design, geometry=geometry))
    if may_grow and drafts and drafts[-1].objection:
        drafts += _on_larger_map(drafts, world)
    found = [(drafts[-1], drafts[-1])] if drafts and not drafts[-1].objection else []
    for draft in drafts[:FITTED_WHOLE] if geometry == "arcs" and not found else ():
        whole = fit(draft.design, _staying(draft.elements), draft.requirements._replace(before=None))
        if not whole.objection:
            found = [(whole, draft)]
            break
    if not found:
        said = " and ".join(dict.fromkeys(f"'{each.change.words}'" for each in needed))
        raise EditError(f"{said} cannot be done on this road: {objection}; ask for less, or elsewhere")
    road, draft = found[0]
    if idle and not any(each.change.what in NUMBERING for each in needed):
        _refuse_broken_limits(idle, needed, road, geometry)
    is_of_road = any(each.change.what in ("mirror", "reverse") for each in needed)
    if road.design.segments == design.segments and not is_of_road:
        raise IdleEditError(f"nothing is to be changed: '{needed[0].change.words}' is so already")
    return road, draft.design


def _refuse_broken_limits(
    idle: Sequence[ChangeCandidates], needed: Sequence[ChangeCandidates], road: FittedRoad, geometry: Geometry
) -> None:
    for limit in idle:
        own = {element.name for element in limit.placed.elements}
        for other in needed:
            is_same = limit.change.bound and other.change.what == limit.change.what
            if not is_same or own.isdisjoint(element.name for element in other.placed.elements):
                continue
            after, _ = elements_on_road(road.design, geometry)
            slack = replace(limit.change, to=(limit.change.to or 0) * (1 - SLACK * limit.change.bound))
            if any(is_beyond(slack, element) for element in after if element.name in own):
                raise clash(other.change, limit.change)


def _drafts(
    elements: RoadElements, changes: Sequence[ChangeCandidates], plain: Requirements
) -> tuple[list[FittedRoad], str]:
    """Returns the roads of combinations of candidates, up to the first one that is valid and as requested,
    and what was wrong with the first one tried; elements that the request does not name are frozen."""
    objection, drafts, world, design = "", list[FittedRoad](), plain.world, plain.before
    assert design is not None
    for steps in islice(_combined(changes), MOST_TRIALS):
        try:
            length = next((step.room for step in reversed(steps) if isinstance(step, RoadLength)), None)
            needs = plain._replace(length=length)
            after = _applied(elements, steps, world)
            begun = _started(design, after, elements, world, steps)
            begun = graded(begun, after, world, design)
            drafts.append(fit(begun, after, needs, _frozen(after)))
        except UsageError as error:
            objection = objection or str(error)
            continue
        objection = objection or drafts[-1].objection
        if not drafts[-1].objection:
            break
    return drafts, objection


def _frozen(elements: RoadElements) -> set[str]:
    return {element.name for element in elements if not element.may_bend}


def _on_larger_map(drafts: Sequence[FittedRoad], world: World) -> list[FittedRoad]:
    for draft in drafts:
        if not any(finding.rule == INSIDE_MAP for finding in draft.findings):
            continue
        for steps in range(1, MOST_GROWTH + 1):
            larger = world.changed(map_size=world.site.map_size + steps * ROUND_MAP)
            if moved_onto_map(draft.design, larger) is not None:
                needs = draft.requirements._replace(world=larger)
                found = fit(draft.design, draft.elements, needs, _frozen(draft.elements))
                if not found.objection:
                    return [found]
                break
    return []


def _staying(elements: RoadElements) -> RoadElements:
    out, own = list(elements), [n for n, element in enumerate(elements) if element.segments]
    turns = [True, *(elements[n].is_turn for n in own), True]
    for n, before, after in zip(own, turns[:-2], turns[2:], strict=True):
        if out[n].seen and before and after and not out[n].is_turn:
            out[n] = replace(out[n], asked=out[n].asked or SEEN_STRAIGHT)
    return tuple(out)


def _combined(changes: Sequence[ChangeCandidates]) -> Iterator[tuple[EditStep, ...]]:
    some = [each.ways[: LARGEST if len(changes) > 1 else None] for each in changes]
    rows = product(*(range(len(ways)) for ways in some))
    for row in sorted(rows, key=lambda r: (sum(r), max(r, default=0), r)):
        yield tuple(step for ways, index in zip(some, row, strict=True) for step in ways[index])


def _applied(elements: RoadElements, steps: Sequence[EditStep], world: World) -> RoadElements:
    after = elements
    for step in sorted(steps, key=_rank):
        after = step.apply(after, world)
    after = without_spare_tail(after)
    after = _with_room(after, Reverse().apply(elements, world) if Reverse() in steps else elements)
    after = numbered(after)
    count = len(joined(after))
    if not 1 <= count <= MAX_SEGMENTS:
        raise UsageError(f"the road would have {count} segments")
    return after


def _rank(step: EditStep) -> tuple[int, float]:
    """Returns the order of a step: what changes more of the road comes first, so that a part keeps its own.
    Stations are those of the road before the edit, so steps that have any come before changes of length."""
    if not isinstance(step, SlopeOfAll):
        return 2, 0.0
    if step.stretch is None:
        return 0, -len(step.names)
    return 1, step.stretch.start - step.stretch.end


def _with_room(elements: RoadElements, before: RoadElements) -> RoadElements:
    """Returns the elements, with straights inserted between turns to the same side that are too close, unless
    the two already followed each other, to the same sides, before the edit."""
    known = {_pair(one, other) for one, other in pairwise(b for b in before if b.is_turn)}
    out: list[RoadElement] = []
    last: RoadElement | None = None
    metres = 0.0
    for element in elements:
        if element.is_turn:
            is_new = last is not None and last.side == element.side and _pair(last, element) not in known
            if is_new and metres < SEPARATE - 2:
                out.append(gap(f"room before {element.name}", round(SEPARATE - metres, 1), element.incline))
            last, metres = element, 0.0
        else:
            metres += element.length
        out.append(element)
    return tuple(out)


def _pair(one: RoadElement, other: RoadElement) -> tuple[str, Side | None, str, Side | None]:
    return one.name, one.side, other.name, other.side


def _started(
    design: Design, after: RoadElements, before: RoadElements, world: World, steps: Sequence[EditStep]
) -> Design:
    """Returns the design with the segments of the elements after the steps. A reversed road starts where the
    road ended, and heads the opposite way. If elements were added at the start, the start moves so that the
    rest of the road stays where it was."""
    segments = joined(after)
    if Reverse() in steps:
        road = build(design)
        x, y, z = (round(float(value), DECIMALS) for value in road.at(road.length))
        theta = degrees(float(road.heading(road.length)) + pi) % 360
        return Design(starting_point=(x, y, z), theta=round(theta, DECIMALS) % 360, segments=segments)
    x, y, z = design.starting_point
    if Mirror() in steps:
        start = world.site.map_size - x, y, z
        theta = (180 - design.theta) % 360
        return Design(starting_point=start, theta=round(theta, DECIMALS), segments=segments)
    old = {element.name for element in before}
    front = joined([*takewhile(lambda element: element.name not in old, after)])
    if not front:
        return design.model_copy(update={"segments": segments})
    lead = build(Design(starting_point=(0.0, 0.0, 0.0), theta=0.0, segments=front))
    end, turned = lead.at(lead.length), float(lead.heading(lead.length))
    heading = radians(design.theta) - turned
    far, way = hypot(end[0], end[1]), atan2(end[1], end[0]) + heading
    start = x - far * cos(way), y - far * sin(way), z - float(end[2])
    return Design(
        starting_point=(round(start[0], 2), round(start[1], 2), round(start[2], 2)),
        theta=round(degrees(heading) * HUNDREDTH) / HUNDREDTH % 360,
        segments=segments,
    )
