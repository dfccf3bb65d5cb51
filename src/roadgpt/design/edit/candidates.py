"""Lists ways to make a change: target values, and ranges for the values measured on the changed road.

A request without a number ('sharper') allows wide ranges. If the request gives a value, such as the angle of
a turn, only other values, such as the radius, may vary. A further candidate aims at a smaller change, has
wider ranges, or lets more elements change.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import inf
from typing import NamedTuple

from roadgpt.brief.change.clashes import clash
from roadgpt.brief.change.request import REORDERS, Change, What
from roadgpt.brief.model import OTHER_SIDE
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import KINDS
from roadgpt.check.measures import Measures, way
from roadgpt.design.edit.hills import hill_candidates, hill_sentence
from roadgpt.design.edit.insertion import insertion_candidates, removal_candidates
from roadgpt.design.edit.lengths import length_steps, road_length_candidates
from roadgpt.design.edit.placing import PlacedChange
from roadgpt.design.edit.reordering import Reverse, move_of, reordering_sentence, swap_of
from roadgpt.design.edit.slopes import (
    bounded_slopes,
    climb_candidates,
    is_too_steep_or_flat,
    only_parts,
    part_slope_candidates,
    road_slope_candidates,
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
    sentence: str = ""
    """What the change does to the road, if measurements alone would not tell; else empty."""

    @property
    def change(self) -> Change:
        """The change."""
        return self.placed.change


def candidates_of(
    changes: Sequence[PlacedChange], elements: RoadElements, found: Measures, world: World
) -> tuple[ChangeCandidates, ...]:
    """Returns the ways to make each change of a request.

    What already has the value that one of the changes asks for is left out of the others: "everything uphill,
    the first straight level" leaves a level first straight alone. If one change gives the angle of a turn and
    another its radius, each sets only its own value.

    Args:
        changes: the changes, each with the elements that it refers to.
        elements: the elements of the road before the edit.
        found: the measurements of that road.
        world: the limits that the rules check, such as the steepest grade.

    Raises:
        EditError: no road can have the requested values, or a change names a stretch of the road, of which a
            part already is as another change asks.
    """
    ways = [_ways(placed, elements, found, world, number) for number, placed in enumerate(changes, 1)]
    told = [
        hill_sentence(placed, elements, len(changes) == 1)
        if placed.change.is_hill
        else reordering_sentence(placed, elements)
        if placed.change.what in (*REORDERS, "reverse")
        else ""
        for placed in changes
    ]
    own = _without_what_is_so(changes, ways)
    ways = [
        its if placed is before else _ways(placed, elements, found, world, number)
        for number, (placed, before, its) in enumerate(zip(own, changes, ways, strict=True), 1)
    ]
    return tuple(map(ChangeCandidates, changes, _agreed([placed.change for placed in changes], ways), told))


def _ways(
    placed: PlacedChange, elements: RoadElements, found: Measures, world: World, number: int
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
            return insertion_candidates(placed, elements, world, number)
        case "remove":
            return removal_candidates(placed.elements, elements)
        case "alternate":
            return _alternating_candidates(placed.elements, world)
        case _ if placed.stretch is not None:
            return stretch_candidates(placed.change, elements, placed.stretch, world)
        case _:
            return _change_candidates(placed.change, placed.elements, found, world)


def _without_what_is_so(
    changes: Sequence[PlacedChange], ways: Sequence[Sequence[EditCandidate]]
) -> list[PlacedChange]:
    """Returns the changes; what already has the value that one of them asks for is left out of the others.

    Raises:
        EditError: such a change names a stretch of the road by distances, or as a half.
    """
    idle = [placed for placed, its in zip(changes, ways, strict=True) if not its and placed.change.is_state]
    out = []
    for placed in changes:
        is_length_of_road = placed.change.what == "length" and placed.change.is_of_road
        for other in idle if not is_length_of_road else ():
            if other.change.what != placed.change.what or not {*other.elements} < {*placed.elements}:
                continue
            if placed.stretch is not None:
                raise clash(placed.change, other.change)
            own = tuple(each for each in placed.elements if each not in other.elements)
            placed = placed._replace(elements=own)
        out.append(placed)
    return out


def _agreed(
    changes: Sequence[Change], ways: Sequence[Sequence[EditCandidate]]
) -> list[tuple[EditCandidate, ...]]:
    """Returns the candidates of all changes.

    If one change gives the angle of a turn and another its radius, each sets only its own value.
    """
    said: dict[What, set[str]] = {"angle": set(), "radius": set()}
    for change, its in zip(changes, ways, strict=True):
        if change.what in said and its and (change.to or change.by or change.times):
            said[change.what] |= {step.element.name for step in its[0] if isinstance(step, Adjust)}
    both = said["angle"] & said["radius"]

    def own(step: EditStep, what: What) -> EditStep:
        if not isinstance(step, Adjust) or step.element.name not in both or what not in said:
            return step
        return replace(step, radius=None) if what == "angle" else replace(step, degrees=None)

    return [
        tuple(tuple(own(step, change.what) for step in way) for way in its)
        for change, its in zip(changes, ways, strict=True)
    ]


def _change_candidates(
    change: Change, elements: Sequence[RoadElement], found: Measures, world: World
) -> tuple[EditCandidate, ...]:
    """Returns all candidates for a change, the preferred one first; none if the road already is as requested.

    Args:
        change: Any change except an addition, a removal, a mirror image or alternating turns.
        elements: The elements to change.
        found: The measurements of the whole road.
        world: The limits that the rules check, such as the steepest grade.

    Raises:
        EditError: No road can have the requested values.
    """
    is_road = change.is_of_road
    if change.bound and change.what == "length" and is_road:
        elements = elements if change.is_outside(found.length) else []
    elif change.bound:
        elements = [element for element in elements if is_beyond(change, element)]
        if change.what == "slope" and elements:
            step = bounded_slopes(change, elements)
            return ((only_parts(change, step) if _is_of_parts(change, elements) else step,),)
    match change.what:
        case "angle" | "radius" | "shape":
            return _together(_bends(change, element, world) for element in elements)
        case "length" if is_road:
            return road_length_candidates(change, elements, world) if elements else ()
        case "length":
            return _together(length_steps(change, element, world) for element in elements)
        case "slope" if _is_of_parts(change, elements):
            return part_slope_candidates(change, elements, world)
        case "slope" if is_road:
            return road_slope_candidates(change, elements, world)
        case "slope":
            return _together(slope_steps(change, element, found, world) for element in elements)
        case "climb" if is_road:
            return climb_candidates(change, elements, world)
        case "climb":  # "every straight": each of them
            ways = [climb_candidates(change, [element], world) for element in elements]
            return (tuple(step for ((step,),) in ways),)
        case "side" | "mirror":
            if any(element.kind != "turn" for element in elements):
                raise EditError(f"'{change.words}' is said of a straight, which has no side; name a turn")
            wrong = [b for b in elements if change.side is None or b.side != change.side]
            return _flipped(wrong, world) if wrong else ()
        case _:
            return _together(_straightened(element) for element in elements)


def _is_of_parts(change: Change, elements: Sequence[RoadElement]) -> bool:
    """Returns whether a change concerns only those parts of elements that climb, fall or are level."""
    named = change.target.way if change.target else None
    ways = {way(segment.incline) for element in elements for segment in element.segments}
    return named is not None and named in ways and len(ways) > 1


def is_beyond(change: Change, element: RoadElement) -> bool:
    """Returns whether an element violates the limit that a change sets."""
    if change.what == "slope":
        return is_too_steep_or_flat(change, element)
    seen = element.seen
    return seen is not None and change.is_outside(
        getattr(seen, "degrees" if change.what == "angle" else change.what)
    )


def _alternating_candidates(elements: Sequence[RoadElement], world: World) -> tuple[EditCandidate, ...]:
    """Returns the candidates that make turns alternate between left and right; none if they already do.

    Raises:
        EditError: There are no turns.
    """
    if not elements:
        raise EditError("there is no turn at that place; name another one")
    side, wrong = elements[0].side, list[RoadElement]()
    for element in elements:
        wrong += [element] if element.side != side else []
        side = side and OTHER_SIDE[side]
    return _flipped(wrong, world) if wrong else ()


def _together(ways: Iterable[Sequence[EditStep]]) -> tuple[EditCandidate, ...]:
    """Returns one candidate of the first steps of all elements, one of their second steps, and so on."""
    rows = [row for row in map(_with_milder, ways) if row]
    if not rows:
        return ()
    return tuple(tuple(row[min(i, len(row) - 1)] for row in rows) for i in range(max(map(len, rows))))


def _with_milder(steps: Sequence[EditStep]) -> list[EditStep]:
    """Returns the alternative steps for one element.

    If the only step is an Adjust, its milder version is appended as a second alternative.
    """
    return [*steps, *(step.milder() for step in steps[:1] if isinstance(step, Adjust) and len(steps) == 1)]


def _bends(change: Change, element: RoadElement, world: World) -> list[EditStep]:
    seen = element.seen
    if element.kind != "turn" or seen is None:
        raise EditError(f"'{change.words}' is said of a straight, which does not bend; name a turn")
    d, r, least = seen.degrees, seen.radius, world.limits.design_radius
    if change.what == "shape":
        return _shaped(change, element, least)
    aim = change.aim(d if change.what == "angle" else r)
    if aim is not None:
        return [_bent_to(change, element, aim, world)]
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


def _bent_to(change: Change, element: RoadElement, aim: float, world: World) -> EditStep:
    """Returns the step that gives a turn the requested angle or radius."""
    seen = element.seen
    assert seen is not None
    if change.what == "angle":
        if not LEAST_ANGLE - 1.5 <= aim <= MOST_ANGLE:
            raise EditError(
                f"a turn of {aim:.0f} degrees cannot be made; "
                f"ask for {LEAST_ANGLE:g} to {MOST_ANGLE:g} degrees"
            )
        return Adjust(
            element, Wanted.near(aim, 1.0), Wanted(seen.radius, Range(0.5 * seen.radius, 2 * seen.radius))
        )
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
    return Adjust(element, Wanted.near(seen.degrees, 4.0), Wanted.near(aim, 0.05 * aim))


def _shaped(change: Change, element: RoadElement, least: float) -> list[EditStep]:
    """Returns the step that makes a turn a hairpin, sharp or gentle; none if it already is."""
    seen = element.seen
    assert seen is not None
    d, r = seen.degrees, seen.radius
    if change.kind in ("hairpin", "u_turn", "switchback"):
        angles = KINDS[change.kind].degrees or Range()
        if d in angles and r <= 34 and not (change.sharpness == "sharp" and r > 20):
            return []
        tight = min(max(min(r, 22.0), least), 30.0)
        return [
            Adjust(
                element, Wanted(d if d in angles else 170.0, angles), Wanted(tight, Range(0.98 * least, 34.0))
            )
        ]
    if change.kind is not None:
        raise EditError(
            "one turn cannot be made several; say: remove the turn, and add the others in its place"
        )
    if change.sharpness == "sharp":
        if r <= 29 and d >= 32:
            return []
        radius = Wanted(max(min(0.75 * r, 22.0), least), Range(0.98 * least, 29.0))
        return [Adjust(element, Wanted(max(d, 45.0), Range(max(d, 35.0) - 2, max(d, 60.0) + 10)), radius)]
    bound = 60.0 if change.sharpness == "sweeping" else 40.0
    if r >= bound * 1.02 and 15 <= d <= 120:
        return []
    aim = min(max(d, 18.0), 115.0)
    radius = Wanted(max(bound * 1.12, r), Range(bound * 1.03, WIDEST))
    return [Adjust(element, Wanted(aim, Range(16.0, aim + 3)), radius)]


def _flipped(elements: Sequence[RoadElement], world: World) -> tuple[EditCandidate, ...]:
    """Returns a candidate that mirrors each element; its angle and radius may change where room is short."""
    steps: list[EditStep] = [Mirror(frozenset(element.name for element in elements))]
    for element in elements:
        d, r = (element.seen.degrees, element.seen.radius) if element.seen else (0.0, inf)
        degrees = Range(
            max(FLIPPED.lo * d, min(LEAST_ANGLE, d - 1)), min(FLIPPED.hi * d, max(MOST_ANGLE, d + 1))
        )
        radius = Range(max(FLIPPED.lo * r, min(world.limits.min_radius, 0.98 * r)), FLIPPED.hi * r)
        steps.append(Adjust(element, Wanted(d, degrees), Wanted(r, radius)))
    return (tuple(steps),)


def _straightened(element: RoadElement) -> list[EditStep]:
    """Returns the step that replaces a turn by a straight, as long as the turn if there is room for it."""
    bends = element.kind == "turn" and element.seen is not None
    return [Become(element, (straight(element.length, element.incline),))] if bends else []
