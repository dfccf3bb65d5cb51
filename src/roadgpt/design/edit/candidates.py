"""The ways in which a change can be made, the preferred one first: later ones give way where the map is full.

Words without numbers leave room ('sharper'), numbers do not: then only what was not said gives way, such as
the radius of a turn whose angle was.
"""

from collections.abc import Callable, Sequence
from math import radians

from roadgpt.brief.model import OTHER_SIDE
from roadgpt.brief.words import KINDS
from roadgpt.check.measures import Measures
from roadgpt.design.edit.length_candidates import road_length_candidates
from roadgpt.design.edit.request import Change
from roadgpt.design.edit.slope_candidates import (
    bounded_slope_candidates,
    road_slope_candidates,
    slope_candidates,
)
from roadgpt.design.edit.steps import Adjust, Become, EditStep, Mirror, straight
from roadgpt.design.elements import least_radius
from roadgpt.design.road_elements import RoadElement, is_turn
from roadgpt.errors import EditError
from roadgpt.road import World

EditCandidate = tuple[EditStep, ...]

SHARPER = (
    (1.25, 0.75),
    (1.15, 0.8),
    (1.35, 0.7),
    (1.1, 0.75),
    (1.2, 1.0),
    (1.0, 0.75),
    (1.1, 0.9),
    (1.1, 1.0),
)
GENTLER = (
    (0.75, 1.33),
    (0.7, 1.2),
    (0.8, 1.2),
    (0.75, 1.0),
    (0.85, 1.15),
    (0.6, 1.5),
    (0.9, 1.1),
    (1.0, 1.2),
)
TIGHTER = ((1.0, 0.7), (1.0, 0.8), (1.0, 0.6), (1.0, 0.88))
WIDER = ((1.0, 1.4), (1.0, 1.25), (1.0, 1.6), (1.0, 1.15))
FLIPPED = (
    (0.9, 1.0), (1.1, 1.0), (1.0, 0.8), (0.8, 1.0), (1.0, 1.25), (1.2, 1.0), (0.65, 1.0), (0.8, 0.8),
)  # fmt: skip
RADII = (1.0, 0.85, 1.2, 0.7, 1.4, 0.55, 1.7)  # where the angle was said, and the radius was not
LONGER, SHORTER = (1.4, 1.25, 1.6, 1.2, 1.9), (0.65, 0.75, 0.55, 0.8, 0.88)
LEAST_STEP = 10.0  # degrees that 'sharper' adds at least
WIDEST = 250.0  # m: a turn of a larger radius is hardly seen as one
LEAST_ANGLE = 13.0  # degrees: a turn that is gentler yet would not be seen
MOST_ANGLE = 210.0
SEEN = 10.6  # m: the shortest straight that is seen


def change_candidates(
    change: Change, elements: Sequence[RoadElement], found: Measures, world: World
) -> tuple[EditCandidate, ...]:
    """Returns all candidates, the preferred one first; none where everything is as was asked for already.

    Args:
        change: anything but adding, removing and mirroring.
        elements: those that are meant.
        found: measures of the whole road.
        world: limits.

    Raises:
        EditError: no road can be like that.
    """
    if change.bound:
        elements = [element for element in elements if _is_beyond(change, element, found)]
        if change.what == "slope" and elements:
            return bounded_slope_candidates(change, elements)
    match change.what:
        case "angle" | "radius" | "shape":
            return _each(elements, lambda element: _bends(change, element, world))
        case "length":
            if change.target is not None and change.target.noun == "road":
                return road_length_candidates(change, elements, found, world)
            return _each(elements, lambda element: _lengths(change, element, world))
        case "slope":
            if change.target is not None and change.target.noun == "road":
                return road_slope_candidates(change, elements, found, world)
            return _each(elements, lambda element: slope_candidates(change, element, found, world))
        case "side":
            if any(element.kind != "turn" for element in elements):
                raise EditError(f"'{change.words}' is said of a straight, which has no side; name a turn")
            wrong = [b for b in elements if change.side is None or b.side != change.side]
            return _flipped(wrong, world) if wrong else ()
        case _:
            return _each(elements, _straightened)


def _is_beyond(change: Change, element: RoadElement, found: Measures) -> bool:
    """Returns whether an element is beyond the bound of a change."""
    assert change.to is not None
    seen = element.seen
    if change.what == "slope":
        slopes = [abs(segment.incline) for segment in element.segments]
        return any((now - change.to) * change.bound < 0 for now in slopes)
    if seen is None:
        return False
    if change.target is not None and change.target.noun == "road" and change.what == "length":
        now = found.length
    else:
        now = {"angle": seen.degrees, "radius": seen.radius, "length": seen.length}[change.what]
    return (now - change.to) * change.bound < 0


def alternating_candidates(elements: Sequence[RoadElement], world: World) -> tuple[EditCandidate, ...]:
    """Returns the candidates that make turns alternate from the first one on; none where they do already."""
    side, wrong = elements[0].side, list[RoadElement]()
    for element in elements:
        wrong += [element] if element.side != side else []
        side = side and OTHER_SIDE[side]
    return _flipped(wrong, world) if wrong else ()


def _each(
    elements: Sequence[RoadElement], ways: Callable[[RoadElement], Sequence[EditStep]]
) -> tuple[EditCandidate, ...]:
    """All elements alike: the first way of each, the second way of each, ..."""
    rows = [row for row in (list(ways(element)) for element in elements) if row]
    if not rows:
        return ()
    return tuple(tuple(row[min(i, len(row) - 1)] for row in rows) for i in range(max(map(len, rows))))


def _bends(change: Change, element: RoadElement, world: World) -> list[EditStep]:
    seen = element.seen
    if element.kind != "turn" or seen is None:
        raise EditError(f"'{change.words}' is said of a straight, which does not bend; name a turn")
    least = least_radius(world)
    if change.what == "shape":
        pairs = _shapes(change, element, least)
    elif change.what == "angle":
        pairs = _angles(change, element)
    else:
        pairs = _radii(change, element, world)
    is_said = change.by is not None or change.to is not None or change.times is not None
    free = change.what == "angle" and is_said
    out: list[EditStep] = []
    for degrees, radius in pairs:
        radius = max(radius, min(least, seen.radius)) if not is_said or free else max(radius, least)
        radius = min(radius, max(WIDEST, seen.radius))
        if not is_turn(degrees) or degrees > MOST_ANGLE:
            continue
        is_other = abs(degrees - seen.degrees) > 2.5 or abs(radius / seen.radius - 1) > 0.045
        if not is_other and not is_said:
            continue
        slack = (1.0, 0.25 if free else 0.05) if is_said else (3.0, 0.12)
        if change.what == "radius" and is_said:
            slack = (4.0, 0.05)
        out.append(Adjust(element, degrees, radius, slack=slack))
    if not out and pairs:
        where = f"the turn of {seen.degrees:.0f} degrees with a radius of {seen.radius:.0f} m"
        raise EditError(f"{where} cannot be made so; a turn has {LEAST_ANGLE:g} to {MOST_ANGLE:g} degrees")
    return out


def _aim(change: Change, now: float) -> float | None:
    """The number that was asked for, where one was: said itself, as a difference or as a multiple."""
    if change.to is not None:
        return change.to
    if change.by is not None:
        return now + change.more * change.by
    return None if change.times is None else now * change.times


def _angles(change: Change, element: RoadElement) -> list[tuple[float, float]]:
    seen = element.seen
    assert seen is not None
    aim = _aim(change, seen.degrees)
    if aim is not None:
        if not LEAST_ANGLE - 1.5 <= aim <= MOST_ANGLE:
            raise EditError(
                f"a turn of {aim:.0f} degrees cannot be made; "
                f"ask for {LEAST_ANGLE:g} to {MOST_ANGLE:g} degrees"
            )
        return [(aim, seen.radius * share) for share in RADII]
    out = []
    for more, wider in SHARPER if change.more > 0 else GENTLER:
        more, wider = 1 + (more - 1) * change.dose, max(1 + (wider - 1) * change.dose, 0.4)
        degrees = seen.degrees * more
        if more > 1:
            degrees = max(degrees, seen.degrees + LEAST_STEP * change.dose)
            degrees = min(degrees, max(180.0, seen.degrees + 5))
        elif more < 1:
            degrees = max(degrees, min(LEAST_ANGLE, seen.degrees))
        out.append((degrees, seen.radius * wider))
    return out


def _radii(change: Change, element: RoadElement, world: World) -> list[tuple[float, float]]:
    seen = element.seen
    assert seen is not None
    aim = _aim(change, seen.radius)
    if aim is not None:
        if aim < world.min_radius:
            raise EditError(
                f"a radius of {aim:.1f} m is tighter than the {world.min_radius:.1f} m that the rules allow; "
                f"ask for {least_radius(world):.0f} m or more"
            )
        if aim > WIDEST:
            raise EditError(
                f"a turn with a radius of {aim:.0f} m is hardly seen as one; ask for {WIDEST:g} or less"
            )
        return [(seen.degrees * share, aim) for share in (1.0, 0.96, 1.04)]
    pairs = TIGHTER if change.more < 0 else WIDER
    least = least_radius(world)
    if change.more < 0 and seen.radius * 0.93 < least:  # as tight as may be: then it turns further
        return [(seen.degrees * more, seen.radius) for more in (1.25, 1.15, 1.1)]
    return [(seen.degrees * a, seen.radius * (1 + (r - 1) * min(change.dose, 1.4))) for a, r in pairs]


def _shapes(change: Change, element: RoadElement, least: float) -> list[tuple[float, float]]:
    """Angles and radii that a hairpin, or a gentle turn, may have; empty where it is one."""
    seen = element.seen
    assert seen is not None
    d, r = seen.degrees, seen.radius
    if change.kind in ("hairpin", "u_turn", "switchback"):
        meaning = KINDS[change.kind]
        assert meaning.degrees is not None
        tight = min(max(min(r, 22.0), least), 30.0)
        if d in meaning.degrees and r <= 34 and not (change.sharpness == "sharp" and r > 20):
            return []
        angles = (d,) if d in meaning.degrees else (170.0, 165.0, 180.0, 158.0, 152.0)
        return [(angle, radius) for angle in angles for radius in (tight, max(17.0, least), 26.0)]
    if change.kind is not None:
        raise EditError(
            "one turn cannot be made several; say: remove the turn, and add the others in its place"
        )
    if change.sharpness == "sharp":
        if r <= 29 and d >= 32:
            return []
        angle = max(d, 45.0)
        return [
            (angle, max(min(0.75 * r, 22.0), least)),
            (angle, least),
            (max(d, 60.0), 20.0),
            (max(d, 35.0), 24.0),
        ]
    bound = 60.0 if change.sharpness == "sweeping" else 40.0
    if r >= bound * 1.02 and 15 <= d <= 120:
        return []
    angle = min(max(d, 18.0), 115.0)
    wide = max(bound * 1.12, r)
    return [(min(angle, most), wide) for most in (115.0, 70.0, 50.0, 35.0, 25.0, 20.0)]


def _lengths(change: Change, element: RoadElement, world: World) -> list[EditStep]:
    seen = element.seen
    before = seen.length if seen else element.length
    if change.to is not None:
        lengths, slack = [change.to], 1.0
    elif change.by is not None:
        lengths, slack = [before + change.more * change.by], 1.0
    elif change.times is not None:
        lengths, slack = [before * change.times], 1.0
    else:
        shares = LONGER if change.more > 0 else SHORTER
        lengths = [before * (1 + (share - 1) * change.dose) for share in shares]
        if change.more > 0:
            lengths[0] = max(lengths[0], before + 15)
        slack = 2.5
    if element.kind == "turn":
        assert seen is not None
        tight = least_radius(world)
        out: list[EditStep] = []
        for length in lengths:
            radius = seen.radius * length / before
            if radius < tight:  # then it also turns less far
                degrees = seen.degrees * max(length / before / (tight / seen.radius), 0.3)
                out.append(Adjust(element, degrees, max(tight, min(seen.radius, radius)), slack=(4.0, 0.12)))
            else:
                out.append(
                    Adjust(element, seen.degrees, None, length, slack=(2.0, 0.1), length_slack=0.06 * length)
                )
        return out
    if change.to is None and change.by is None and change.times is None:
        lengths = [max(length, min(SEEN + 1, before)) for length in lengths]
    if lengths[0] < SEEN - 0.6:
        raise EditError(
            f"a straight of {max(lengths[0], 0):.0f} m is not seen as one; ask for 10 m or more, or remove it"
        )
    return [
        Adjust(element, length=max(length, SEEN), length_slack=max(slack, 0.02 * length))
        for length in lengths
    ]


def _flipped(elements: Sequence[RoadElement], world: World) -> tuple[EditCandidate, ...]:
    """The mirror image of each; where that finds no room, turned a little less or more as well."""
    flips = (Mirror(frozenset(element.name for element in elements)),)
    least = least_radius(world)
    out: list[EditCandidate] = [flips]
    for more, wider in FLIPPED:
        bends: list[EditStep] = []
        for element in elements:
            seen = element.seen
            assert seen is not None
            degrees, radius = seen.degrees * more, seen.radius * wider
            if is_turn(degrees - 3) and degrees <= MOST_ANGLE and radius >= min(least, seen.radius):
                bends.append(Adjust(element, degrees, radius, slack=(3.0, 0.12)))
        if len(bends) == len(elements):
            out.append((*flips, *bends))
    return tuple(out)


def _straightened(element: RoadElement) -> list[EditStep]:
    """A straight in the place of a turn: as long as the turn was, or as long as its chord."""
    if element.kind != "turn" or element.seen is None:
        return []
    chord = 2 * element.seen.radius * abs(radians(min(element.seen.degrees, 180)) / 2) * 0.8
    lengths = [element.length, chord, 25.0, 60.0]
    return [Become(element, (straight(length, element.incline),)) for length in lengths]
