"""Lists ways to make a change: target values, and ranges for the values measured on the changed road.

A request without a number ('sharper') allows wide ranges. If the request gives a value, such as the angle of
a turn, only other values, such as the radius, may vary. A further candidate aims at a smaller change, has
wider ranges, or lets more elements change.
"""

from collections.abc import Iterable, Sequence
from math import inf

from roadgpt.brief.model import OTHER_SIDE
from roadgpt.brief.words import KINDS, LEAST_STRAIGHT, Range
from roadgpt.check.measures import Measures, way
from roadgpt.design.edit.request import Change
from roadgpt.design.edit.slopes import (
    bounded_slopes,
    climb_candidates,
    is_outside,
    is_too_steep_or_flat,
    only_parts,
    part_slope_candidates,
    road_slope_candidates,
    slope_steps,
)
from roadgpt.design.edit.steps import (
    Adjust,
    Become,
    EditCandidate,
    EditStep,
    Mirror,
    RoadLength,
    Wanted,
    near,
    straight,
    with_milder,
)
from roadgpt.design.elements import least_radius
from roadgpt.design.road_elements import RoadElement
from roadgpt.errors import EditError
from roadgpt.road import World

SHARPER, GENTLER = (1.25, 0.75), (0.75, 1.33)  # shares of angle and radius to aim at
TIGHTER, WIDER = 0.7, 1.4  # shares of the radius
LONGER, SHORTER = 1.4, 0.65  # shares of a length
ROAD_LONGER, ROAD_SHORTER = 1.3, 0.75  # shares of the length of a road
FLIPPED = Range(0.65, 1.25)  # shares of angle and radius that a turn may have when it goes the other way
CLEARLY, FURTHER = 0.45, 1.6  # least and greatest accepted share of a change without a number ('sharper')
LEAST_STEP = 10.0  # degrees that 'sharper' adds at least
SEEN_STEP = 9.0  # degrees: a smaller change of angle is hardly seen
WIDEST = 250.0  # m: a turn of a larger radius is hardly seen as one
LEAST_ANGLE = 13.0  # degrees: a turn of a smaller angle would not be seen
MOST_ANGLE = 210.0
SEEN = 10.6  # m: the shortest straight that is seen
KEPT = 17.5  # m that remain of each straight when the road is shortened
ROAD_SLACK = 0.02  # of the length of a road


def change_candidates(
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
    is_road = change.target is not None and change.target.noun == "road"
    if change.bound and change.what == "length" and is_road:
        elements = elements if is_outside(change, found.length) else []
    elif change.bound:
        elements = [element for element in elements if is_beyond(change, element)]
        if change.what == "slope" and elements:
            step = bounded_slopes(change, elements)
            return ((only_parts(change, step) if _is_of_parts(change, elements) else step,),)
    match change.what:
        case "angle" | "radius" | "shape":
            return _together(_bends(change, element, world) for element in elements)
        case "length" if is_road:
            return _road_lengths(change, elements, world) if elements else ()
        case "length":
            return _together(_lengths(change, element, world) for element in elements)
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
        case "side":
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
    return seen is not None and is_outside(
        change, getattr(seen, "degrees" if change.what == "angle" else change.what)
    )


def alternating_candidates(elements: Sequence[RoadElement], world: World) -> tuple[EditCandidate, ...]:
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
    rows = [row for row in map(with_milder, ways) if row]
    if not rows:
        return ()
    return tuple(tuple(row[min(i, len(row) - 1)] for row in rows) for i in range(max(map(len, rows))))


def _aim(change: Change, now: float) -> float | None:
    """Returns the requested value, given directly, as a difference or as a factor; None if none was given."""
    if change.to is not None:
        return change.to
    if change.by is not None:
        return now + change.more * change.by
    return None if change.times is None else now * change.times


def _towards(now: float, aim: float) -> Wanted:
    """Returns ``aim`` with a range from 0.45 to 1.6 times the change from ``now`` to ``aim``."""
    ends = now + CLEARLY * (aim - now), now + FURTHER * (aim - now)
    return Wanted(aim, Range(min(ends), max(ends)))


def _not_away(now: float, aim: float) -> Wanted:
    """Returns ``aim`` with a range from no change to 1.6 times the change from ``now`` to ``aim``."""
    ends = now, now + FURTHER * (aim - now)
    return Wanted(aim, Range(0.99 * min(ends), 1.01 * max(ends)))


def _bends(change: Change, element: RoadElement, world: World) -> list[EditStep]:
    seen = element.seen
    if element.kind != "turn" or seen is None:
        raise EditError(f"'{change.words}' is said of a straight, which does not bend; name a turn")
    d, r, least = seen.degrees, seen.radius, least_radius(world)
    if change.what == "shape":
        return _shaped(change, element, least)
    aim = _aim(change, d if change.what == "angle" else r)
    if aim is not None:
        return [_bent_to(change, element, aim, world)]
    if change.what == "radius" and change.more < 0 and 0.93 * r < least:  # then it turns further
        return [Adjust(element, _towards(d, 1.25 * d), near(r, 0.12 * r))]
    if change.what == "radius":
        aim = r * (1 + ((TIGHTER if change.more < 0 else WIDER) - 1) * min(change.dose, 1.4))
        aim = min(max(aim, min(least, r)), max(WIDEST, r))
        if abs(aim / r - 1) > 0.045:
            return [Adjust(element, near(d, 3.0), _towards(r, aim))]
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
        return [Adjust(element, _towards(d, degrees), _not_away(r, aim))]
    return [Adjust(element, _not_away(d, degrees), _towards(r, aim))]


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
        return Adjust(element, near(aim, 1.0), Wanted(seen.radius, Range(0.5 * seen.radius, 2 * seen.radius)))
    if aim < world.limits.min_radius:
        raise EditError(
            f"a radius of {aim:.1f} m is tighter than the {world.limits.min_radius:.1f} m that the rules "
            f"allow; ask for {least_radius(world):.0f} m or more"
        )
    if aim > WIDEST:
        raise EditError(
            f"a turn with a radius of {aim:.0f} m is hardly seen as one; ask for {WIDEST:g} or less"
        )
    aim = max(aim, least_radius(world))
    return Adjust(element, near(seen.degrees, 4.0), near(aim, 0.05 * aim))


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


def _lengths(change: Change, element: RoadElement, world: World) -> list[EditStep]:
    seen = element.seen
    before = seen.length if seen else element.length
    aim = _aim(change, before)
    share = 1 + ((LONGER if change.more > 0 else SHORTER) - 1) * change.dose
    wished = before * share if aim is None else aim
    if element.kind == "turn":
        assert seen is not None
        tight = least_radius(world)
        if seen.radius * wished / before >= tight:
            wanted = near(wished, 0.06 * wished) if aim is not None else _towards(before, wished)
            return [Adjust(element, near(seen.degrees, 2.0), None, wanted)]
        share = max(wished / before / (tight / seen.radius), 0.3)  # then it also turns less far
        return [Adjust(element, near(seen.degrees * share, 4.0), near(tight, 0.12 * tight))]
    if aim is None:
        wished = max(wished, before + 15 if change.more > 0 else 0.0, min(SEEN + 1, before))
        room = _towards(before, wished).room
        room = Range(max(min(room.lo, wished - 0.5), LEAST_STRAIGHT), max(room.hi, wished + 0.5))
        return [Adjust(element, length=Wanted(wished, room))]
    if wished < SEEN - 0.6:
        raise EditError(
            f"a straight of {max(wished, 0):.0f} m is not seen as one; ask for 10 m or more, or remove it"
        )
    return [Adjust(element, length=near(max(wished, SEEN), max(1.0, 0.02 * wished)))]


def _road_lengths(change: Change, elements: Sequence[RoadElement], world: World) -> tuple[EditCandidate, ...]:
    """Returns candidates that change the road's length by its straights alone, or by its turns as well."""
    own = sum(element.length for element in elements)
    aim = _aim(change, own)
    if aim is None:
        aim = own * (1 + ((ROAD_LONGER if change.more > 0 else ROAD_SHORTER) - 1) * change.dose)
    if aim < world.limits.min_length:
        raise EditError(f"a road of {aim:.0f} m is too short; ask for {world.limits.min_length:g} m or more")
    slack = max(2.0, ROAD_SLACK * aim)
    whole = RoadLength(Range(aim - slack, aim + slack))
    lengths = [(e, e.seen.length) for e in elements if e.kind == "gap" and e.seen is not None]
    spare = [length if aim > own else max(length - KEPT, 0.0) for _, length in lengths]
    share = (aim - own) / max(sum(spare), 1e-9)
    straights: list[EditStep] = [
        Adjust(element, length=Wanted(length + share * part, Range(SEEN)))
        for (element, length), part in zip(lengths, spare, strict=True)
    ]
    everything: list[EditStep] = [
        Adjust(element, length=Wanted(now, Range(SEEN))) for element, now in lengths
    ]
    for seen, element in ((e.seen, e) for e in elements if e.kind == "turn"):
        assert seen is not None
        radius = Range(min(least_radius(world), seen.radius), max(WIDEST, seen.radius))
        everything.append(Adjust(element, near(seen.degrees, 2.0), Wanted(seen.radius, radius)))
    can = sum(spare) and share > -1
    return ((*straights, whole), (*everything, whole)) if can else ((*everything, whole),)


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
