"""Lists ways to make a change: target values, and ranges for the values measured on the changed road.

Words ('sharper') allow wide ranges. If a number is given, such as the angle of a turn, only other values may
vary, such as its radius. A second candidate has wider ranges, or lets more elements change.
"""

from collections.abc import Callable, Sequence
from math import inf

from roadgpt.brief.model import OTHER_SIDE
from roadgpt.brief.words import KINDS, LEAST_STRAIGHT, PERCENT_SLACK, Range
from roadgpt.check.measures import Measures, way
from roadgpt.design.edit.request import Change
from roadgpt.design.edit.steps import (
    Adjust,
    Become,
    EditCandidate,
    EditStep,
    Mirror,
    RoadLength,
    SlopeOfAll,
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
CLEARLY, FURTHER = 0.45, 1.6  # shares of a change that was only named ('sharper') that will do
LEAST_STEP = 10.0  # degrees that 'sharper' adds at least
SEEN_STEP = 9.0  # degrees: a smaller change of angle is hardly seen
WIDEST = 250.0  # m: a turn of a larger radius is hardly seen as one
LEAST_ANGLE = 13.0  # degrees: a turn that is gentler yet would not be seen
MOST_ANGLE = 210.0
SEEN = 10.6  # m: the shortest straight that is seen
KEPT = 17.5  # m of a straight that others are shortened to
ROAD_SLACK = 0.02  # of the length of a road
STEEPER, FLATTER = 1.5, 0.5  # shares of a grade
STEEPER_BY = 2.0  # percentage points that 'steeper' adds at least
LEVEL, CLEARLY_LEVEL = 1.0, 0.8  # percent
STEEP_FROM = 4.0  # percent: what a level place becomes that is to be steeper


def change_candidates(
    change: Change, elements: Sequence[RoadElement], found: Measures, world: World
) -> tuple[EditCandidate, ...]:
    """Returns all candidates, the preferred one first; none if the road already is as requested.

    Args:
        change: Any change except an addition, a removal or a mirror image.
        elements: The elements to change.
        found: The measurements of the whole road.
        world: The limits that the rules check, such as the steepest grade.

    Raises:
        EditError: No road can have the requested values.
    """
    if change.bound:
        elements = [element for element in elements if _is_beyond(change, element, found)]
        if change.what == "slope" and elements:
            up = sum(element.incline * element.length for element in elements) >= 0
            most = change.to or 0.0
            slope = _between(0, most) if change.bound < 0 else _between(most, inf, 1 if up else -1)
            return ((SlopeOfAll(frozenset(element.name for element in elements), slope),),)
    is_road = change.target is not None and change.target.noun == "road"
    match change.what:
        case "angle" | "radius" | "shape":
            return _each(elements, lambda element: _bends(change, element, world))
        case "length" if is_road:
            return _road_lengths(change, elements, world)
        case "length":
            return _each(elements, lambda element: _lengths(change, element, world))
        case "slope" if is_road:
            return _road_slopes(change, elements, found, world)
        case "slope":
            return _each(elements, lambda element: _slopes(change, element, found, world))
        case "side":
            if any(element.kind != "turn" for element in elements):
                raise EditError(f"'{change.words}' is said of a straight, which has no side; name a turn")
            wrong = [b for b in elements if change.side is None or b.side != change.side]
            return _flipped(wrong, world) if wrong else ()
        case _:
            return _each(elements, _straightened)


def _is_beyond(change: Change, element: RoadElement, found: Measures) -> bool:
    """Is an element beyond the bound of a change?"""
    assert change.to is not None
    if change.what == "slope":
        values = [abs(segment.incline) for segment in element.segments]
    elif element.seen is None:
        values = []
    elif change.what == "length" and change.target is not None and change.target.noun == "road":
        values = [found.length]
    else:
        values = [getattr(element.seen, "degrees" if change.what == "angle" else change.what)]
    return any((now - change.to) * change.bound < 0 for now in values)


def alternating_candidates(elements: Sequence[RoadElement], world: World) -> tuple[EditCandidate, ...]:
    """Returns the candidates that make turns alternate between left and right; none if they already do."""
    side, wrong = elements[0].side, list[RoadElement]()
    for element in elements:
        wrong += [element] if element.side != side else []
        side = side and OTHER_SIDE[side]
    return _flipped(wrong, world) if wrong else ()


def _each(
    elements: Sequence[RoadElement], ways: Callable[[RoadElement], Sequence[EditStep]]
) -> tuple[EditCandidate, ...]:
    """All elements alike: the first way of each, the second way of each, ..."""
    rows = [row for row in (with_milder(ways(element)) for element in elements) if row]
    if not rows:
        return ()
    return tuple(tuple(row[min(i, len(row) - 1)] for row in rows) for i in range(max(map(len, rows))))


def _aim(change: Change, now: float) -> float | None:
    """The number that was asked for, where one was: said itself, as a difference or as a multiple."""
    if change.to is not None:
        return change.to
    if change.by is not None:
        return now + change.more * change.by
    return None if change.times is None else now * change.times


def _towards(now: float, aim: float) -> Wanted:
    """A value that was not said: clearly on the way from one to the other, or somewhat further."""
    ends = now + CLEARLY * (aim - now), now + FURTHER * (aim - now)
    return Wanted(aim, Range(min(ends), max(ends)))


def _not_away(now: float, aim: float) -> Wanted:
    """A value that may stay as it is, or go the way of the aim."""
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
    """A turn whose angle, or radius, was said."""
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
    """A hairpin, a sharp or a gentle turn; nothing where it is one."""
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
    """Another length of the road: by its straights alone, or by its turns as well."""
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
    """The mirror image of each; where that finds no room, turned a little less or more as well."""
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
    """A straight in the place of a turn, as long as the turn was if there is room for it."""
    bends = element.kind == "turn" and element.seen is not None
    return [Become(element, (straight(element.length, element.incline),))] if bends else []


def _slopes(change: Change, element: RoadElement, found: Measures, world: World) -> list[EditStep]:
    """One turn or straight on another grade."""
    now = element.seen.grade if element.seen else element.incline
    limit = 100 * world.limits.max_grade
    sign = {"up": 1, "down": -1}.get(change.way or "", 0) or (
        1 if now >= LEVEL else -1 if now <= -LEVEL else 0
    )
    sign = sign or (-1 if found.grade <= -LEVEL else 1)
    aim: float | None = None
    if change.to is not None and change.way != "flat":
        aim = sign * change.to
    elif change.by is not None:
        aim = sign * max(abs(now) + (change.more or 1) * change.by, 0.0)
    if aim is not None:
        _refuse_too_steep(abs(aim), limit)
    elif change.times is not None:
        aim = now * change.times
    if aim is not None:
        return _graded(element, 1, aim, (aim - 0.5, aim + 0.5), (aim - PERCENT_SLACK, aim + PERCENT_SLACK))
    if change.way == "flat":
        if abs(now) < CLEARLY_LEVEL and all(abs(s.incline) < LEVEL for s in element.segments):
            return []
        return _graded(element, 1, 0.0, (-0.5, 0.5), (-CLEARLY_LEVEL, CLEARLY_LEVEL))
    if change.way and not change.more:
        return [] if way(now) == change.way else _graded(element, sign, 5.0, (3.0, 12.0), (1.3, 13.0))
    if change.more > 0 and change.way and way(now) != change.way:
        return _graded(element, sign, 6.0, (3.0, 12.0))
    if change.more < 0:
        is_level = abs(now) < LEVEL
        return [] if is_level else _graded(element, 1, FLATTER * now, (0.1 * now, 0.9 * now))
    steep = max(abs(now) * (1 + (STEEPER - 1) * change.dose), abs(now) + STEEPER_BY * change.dose)
    steep = min(steep if abs(now) >= LEVEL else STEEP_FROM, limit - 0.3)
    if steep <= abs(now) + 0.4:
        raise EditError(f"it is as steep as the rules allow there: {now:.1f} % of {limit:g} %")
    return _graded(element, sign, steep, (min(abs(now) + 0.4, steep - 0.2), min(steep + 1.5, limit)))


def _refuse_too_steep(grade: float, limit: float) -> None:
    if grade > limit:
        raise EditError(f"{grade:g} % is steeper than the {limit:g} % that the rules allow; ask for less")


def _graded(element: RoadElement, sign: int, aim: float, *rooms: tuple[float, float]) -> list[EditStep]:
    """A step for each range, all with the same aim; percent, downhill where the sign is -1."""
    ends = [sorted((sign * one, sign * other)) for one, other in rooms]
    return [Adjust(element, grade=Wanted(sign * aim, Range(low, high))) for low, high in ends]


def _road_slopes(
    change: Change, elements: Sequence[RoadElement], found: Measures, world: World
) -> tuple[EditCandidate, ...]:
    """Many elements on other grades."""
    names = frozenset(element.name for element in elements)
    limit = 100 * world.limits.max_grade
    sign = {"up": 1, "down": -1}.get(change.way or "", 0)
    _refuse_too_steep(change.to or 0.0, limit)
    inclines = [segment.incline for element in elements for segment in element.segments]
    if change.way == "flat" or change.to == 0:
        slopes = [_between(0, 0)]
    elif change.to is not None:
        slopes = [_between(change.to, change.to, sign or (-1 if found.grade < 0 else 1))]
    elif change.by is not None:
        more = (change.more or 1) * change.by
        slopes = [lambda incline: incline + (more if incline >= 0 else -more)]
    elif change.times is not None:
        slopes = [_times(change.times)]
    elif sign and not change.more:
        if inclines and min(incline * sign for incline in inclines) >= 1.5:
            return ()
        slopes = [_between(low, 12.0, sign) for low in (4.0, 3.0)]
    elif change.more < 0:
        slopes = [_times(FLATTER), _times(0.75)]
    elif all(abs(incline) < LEVEL for incline in inclines):
        slopes = [_between(STEEP_FROM, limit, sign or 1)]
    else:
        slopes = [_times(1 + (times - 1) * change.dose) for times in (STEEPER, 1.3, 1.15)]
    return tuple((SlopeOfAll(names, slope),) for slope in slopes)


def _times(times: float) -> Callable[[float], float]:
    return lambda incline: incline * times


def _between(low: float, high: float, sign: int = 0) -> Callable[[float], float]:
    """Brings inclines between two sizes; uphill or downhill where the sign is 1 or -1."""
    return lambda incline: (sign or (1 if incline >= 0 else -1)) * min(max(abs(incline), low), high)
