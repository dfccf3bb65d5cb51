"""Lists ways to make a change: target values, and ranges for the values measured on the changed road.

A request without a number ('sharper') allows wide ranges. If the request gives a value, such as the angle of
a turn, only other values, such as the radius, may vary. A further candidate aims at a smaller change, has
wider ranges, or lets more elements change.
"""

from collections.abc import Iterable, Sequence
from math import inf
from typing import NamedTuple

from roadgpt.brief.change.request import REORDERS, Change
from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import KINDS
from roadgpt.check.measures import Measures, way
from roadgpt.design.edit.agreement import agreed
from roadgpt.design.edit.insertion import insertion_candidates, removal_candidates
from roadgpt.design.edit.lengths import length_steps, road_length_candidates
from roadgpt.design.edit.placing import PlacedChange, is_beyond
from roadgpt.design.edit.reordering import Reverse, move_of, reordering_sentence, swap_of
from roadgpt.design.edit.slopes import (
    climb_step,
    hill_candidates,
    hill_sentence,
    slope_candidates,
    slope_steps,
    stretch_candidates,
)
from roadgpt.design.edit.steps import (
    WIDEST,
    Adjust,
    Become,
    EditCandidate,
    EditStep,
    Mirror,
    Wanted,
)
from roadgpt.design.elements import straight
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.errors import EditError
from roadgpt.road import World

SHARPER, GENTLER = (1.25, 0.75), (0.75, 1.33)  # shares of angle and radius to aim at
TIGHTER, WIDER = 0.7, 1.4  # shares of the radius
FLIPPED = Range(0.65, 1.25)  # shares of angle and radius that a turn may have when it goes the other way
LEAST_STEP = 10.0  # degrees that 'sharper' adds at least
SEEN_STEP = 9.0  # degrees: a smaller change of angle is hardly seen
LEAST_ANGLE = 13.0  # degrees: a turn of a smaller angle would not be seen
MOST_ANGLE = 210.0


class ChangeCandidates(NamedTuple):
    """The ways in which one change of a request can be made."""

    placed: PlacedChange
    """The change, and the elements that it refers to."""
    ways: tuple[EditCandidate, ...]
    """All candidates, the preferred one first; none if the road already is as requested."""

    @property
    def change(self) -> Change:
        """The change."""
        return self.placed.change


def candidates_of(
    changes: Sequence[PlacedChange], elements: RoadElements, found: Measures, world: World, first: int = 1
) -> tuple[ChangeCandidates, ...]:
    """Returns the ways to make each change of a stage on a road with these elements and measurements.

    ``first`` is the number of the first change in the request; names of new elements contain these numbers.
    If the road already is as one change asks, other changes of the same property leave the elements of that
    change alone: "everything uphill, the first straight level" keeps a first straight that is level.

    Raises:
        EditError: no road can have the requested values, or a change of a stretch of the road would alter a
            part of this stretch that already is as another change asks.
    """
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
    change on the road to which it is made, with the elements ``now``.
    """
    if asked.change.is_hill:
        return hill_sentence(placed, now)
    return reordering_sentence(asked, before) if asked.change.what in (*REORDERS, "reverse") else ""


def _ways(
    placed: PlacedChange,
    elements: RoadElements,
    found: Measures,
    world: World,
    number: int,
    sides: Sequence[Side | None],
) -> tuple[EditCandidate, ...]:
    """Returns the candidates of one change, the preferred one first; none if the road already is so."""
    match placed.change.what:
        case "mirror" if placed.change.target is None:
            if not any(element.is_turn for element in elements):
                raise EditError("the road has no turn, so its mirror image is the same")
            return ((Mirror(),),)
        case "reverse":
            return ((Reverse(),),)
        case "swap":
            return ((swap_of(placed.elements),),)
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
    change: Change, elements: Sequence[RoadElement], found: Measures, world: World
) -> tuple[EditCandidate, ...]:
    """Returns all candidates for a change of values; ``found`` are the measurements of the whole road.

    Raises:
        EditError: No road can have the requested values.
    """
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
    """Returns the turns that have to change their sides so that all alternate between left and right.

    Raises:
        EditError: There are no turns.
    """
    turns = [element for element in elements if element.is_turn]
    if not turns:
        raise EditError("there is no turn at that place; name another one")
    side, wrong = turns[0].side, list[RoadElement]()
    for turn in turns:
        wrong += [turn] if turn.side != side else []
        side = side and OTHER_SIDE[side]
    return wrong


def _sides_after(changes: Sequence[PlacedChange], elements: RoadElements) -> list[Side | None]:
    """Returns the sides of all elements once the turns alternate, if a change asks for that."""
    wrong = [
        turn.name
        for placed in changes
        if placed.change.what == "alternate"
        for turn in _out_of_turn(placed.elements)
    ]
    return [e.side and OTHER_SIDE[e.side] if e.name in wrong else e.side for e in elements]


def _together(ways: Iterable[Sequence[EditStep]]) -> tuple[EditCandidate, ...]:
    """Returns one candidate of the first steps of all elements, one of their second steps, and so on; the
    second alternative to a single Adjust is its milder version.
    """
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
    """Returns the step that gives a turn of ``d`` degrees and radius ``r`` the requested angle or radius."""
    if change.what == "angle":
        if not LEAST_ANGLE - 1.5 <= aim <= MOST_ANGLE:
            raise EditError(
                f"a turn of {aim:.0f} degrees cannot be made; "
                f"ask for {LEAST_ANGLE:g} to {MOST_ANGLE:g} degrees"
            )
        return Adjust(element, Wanted.near(aim, 1.0), Wanted(r, Range(0.5 * r, 2 * r)))
    if aim < world.limits.min_radius:
        raise EditError(
            f"a radius of {aim:.1f} m is tighter than the {world.limits.min_radius:.1f} m that the rules "
            f"allow; ask for {world.limits.design_radius:.0f} m or more"
        )
    if aim > WIDEST:
        raise EditError(
            f"a turn with a radius of {aim:.0f} m is hardly seen as one; ask for {WIDEST:g} or less"
        )
    aim = max(aim, world.limits.design_radius)
    return Adjust(element, Wanted.near(d, 4.0), Wanted.near(aim, 0.05 * aim))


def _shaped(change: Change, element: RoadElement, d: float, r: float, least: float) -> list[EditStep]:
    """Returns the step that makes a turn of ``d`` degrees and radius ``r`` a hairpin, sharp or gentle; none
    if it already is.
    """
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
    """Returns a candidate that mirrors each element, whose angle and radius may change where room is short;
    none if there are no elements.
    """
    if not elements:
        return ()
    steps: list[EditStep] = [Mirror(frozenset(element.name for element in elements))]
    for element in elements:
        d, r = (element.seen.degrees, element.seen.radius) if element.seen else (0.0, inf)
        degrees = Range(
            max(FLIPPED.lo * d, min(LEAST_ANGLE, d - 1)), min(FLIPPED.hi * d, max(MOST_ANGLE, d + 1))
        )
        radius = Range(max(FLIPPED.lo * r, min(world.limits.min_radius, 0.98 * r)), FLIPPED.hi * r)
        steps.append(Adjust(element, Wanted(d, degrees), Wanted(r, radius)))
    return (tuple(steps),)
