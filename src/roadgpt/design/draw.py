"""Chooses at random what a description leaves open: angle, radius and transitions of turns, and lengths of
straights.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import degrees, exp, inf, log, radians

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import KINDS, SHARPNESS
from roadgpt.check.measures import LEAST_TURN
from roadgpt.design.elements import MOST_TRANSITION, segments_of_turn, turn_element
from roadgpt.design.windows import Windows
from roadgpt.errors import DesignError
from roadgpt.road import World

ANY_TURN = Range(25, 120)  # degrees, where nothing is said: the table in brief.words
AIMS = {meaning.names[0]: meaning.aim for meaning in KINDS.values() if meaning.aim}
SHARPNESS_AIMS = {meaning.degrees: meaning.aim for meaning in SHARPNESS.values() if meaning.aim}
WIDEST = 115.0  # m, of a radius that nobody asked for
LONGEST_TURN = 170.0  # m along the curve
SEEN_ARC = 6.5  # m: a shorter arc is not measured with its own radius, which is averaged over some 9 m
SHORTEST_TURN = 11.0  # m along the arc, where no radius was asked for: less looks like a kink
TRANSITIONS = (0.12, 0.34)  # of the arc, for each clothoid
TRANSITION_LIMITS = (3.0, 16.0)  # m, of tight turns
RADII_OF_TRANSITION = 9.0  # of wide turns: RAS-L 1995 asks for a parameter A >= R / 3, so A^2 / R >= R / 9
WIDE_ANGLE = 80.0  # degrees: a turn of a large required radius may be long enough for this angle
LEAD = 16.5  # m: a straight of this length before the first or after the last turn is measured as 10 m
SEPARATE = 17.5  # m between two turns to the same side, so that they are measured as two
NEAR_RADIUS, NEAR_ANGLE, NEAR_SUM = 0.2, 0.1, 0.1  # shares of the tolerance of a number that are used
NEAR_LENGTH = 0.2  # the same for straights
OF_TOLERANCE = 0.6  # the share of angles and radii that is used in the greatest haste
KEPT = 0.5  # degrees by which a turn may differ from its share of a required sum
OFF_TOP, UP_TO = 0.6, 0.97  # share of its range to which a straight may grow: without haste, and at most
TIGHTER = 1.35  # ratio of the widest radius of a hard road to its least


def narrowed_turns(
    turns: Sequence[Feature], outline: Outline, windows: Windows, world: World, haste: float
) -> list[Feature]:
    """Returns the turns with the ranges from which their angle, radius, length and grade are chosen.

    The ranges lie a little inside the required ones. Where a number is required, they lie close around it,
    less close as ``haste`` grows from 0 to 1.

    Raises:
        DesignError: a range is empty, for example because the rules forbid a radius as too tight.
    """
    narrowed = [_narrowed(turn, outline, world, haste) for turn in turns]
    return [replace(turn, grade=windows.of(turn)) for turn in narrowed]


def _narrowed(turn: Feature, outline: Outline, world: World, haste: float) -> Feature:
    least = max(world.limits.design_radius, 0.8 * world.section.road_width)
    promised = overlap(turn.radius, outline.each_turn.radius)
    own = _inside(promised, 0.04).around(_loosened(NEAR_RADIUS, haste)) if promised else Range()
    radius = overlap(own, Range(least, inf))
    assert radius is not None
    if promised and promised.lo > promised.hi:
        raise DesignError(f"the radius asked for does not go with a {turn.name}; leave one of them out")
    if radius.lo > radius.hi:
        raise DesignError(
            f"a {turn.name} with a radius of {promised} m is tighter than the "
            f"{world.limits.min_radius:.4g} m that the rules allow; ask for {least + 1:.0f} m or more"
        )
    angle = overlap(turn.degrees, outline.each_turn.degrees) or ANY_TURN
    if angle.lo > angle.hi:
        raise DesignError(f"no {turn.name} can turn as far as was asked for; leave its degrees open")
    if angle.hi < LEAST_TURN:
        raise DesignError(
            f"a {turn.name} of {angle} degrees is not seen as a turn; ask for {LEAST_TURN + 5:g} or more"
        )
    length = overlap(turn.length, outline.each_turn.length)
    return replace(turn, degrees=_angles(turn, angle, haste), radius=radius, length=length)


def _loosened(share: float, haste: float) -> float:
    """Returns the share of a tolerance that is used if ``share`` of it is used without haste."""
    return share + haste * (OF_TOLERANCE - share)


def _angles(turn: Feature, promised: Range, haste: float) -> Range:
    """Returns the degrees to choose from: near a given number, usual for a word, or nearly all allowed."""
    if promised.number is not None:
        return promised.around(_loosened(NEAR_ANGLE, haste))
    if promised.hi - promised.lo <= 24:
        return _inside(promised, 0.25)
    span = overlap(SHARPNESS_AIMS.get(promised) or AIMS.get(turn.name), promised) or promised
    if span.lo > span.hi:
        span = promised
    return Range(span.lo, min(span.hi, span.lo + 110)).drawn_in(1.5, 0.1)


def _inside(span: Range, share: float) -> Range:
    """Returns a range narrowed at both ends by a share of its width.

    If it has no upper bound, the share is that of its lower bound.
    """
    return span.drawn_in(share * (span.lo if span.hi == inf else span.hi - max(span.lo, 0.0)), 0.5)


def hand_of(turn: Feature) -> int:
    """Returns -1 for a turn to the right, and 1 for a turn to the left or to either side."""
    return -1 if turn.side == "right" else 1


def drawn_turns(
    turns: Sequence[Feature], outline: Outline, world: World, rng: np.random.Generator, haste: float
) -> list[Element]:
    """Chooses the angle, radius and transitions of each turn at random.

    Args:
        turns: the turns with the ranges to choose from, as ``narrowed_turns`` returns them.
        outline: the requirements for the road.
        world: the World; the size of its map limits the length of a turn.
        rng: random number generator.
        haste: from 0 to 1; the larger it is, the smaller the angles and radii.
    """
    ranges = [turn.degrees or ANY_TURN for turn in turns]
    hands = [hand_of(turn) for turn in turns]
    angles = [degrees.lo + _share(rng, haste) * (degrees.hi - degrees.lo) for degrees in ranges]
    angles = _uncoiled(angles, ranges, hands, 215 + 115 * rng.random())
    if outline.turning:
        angles = _summed(angles, ranges, drawn_target(outline.turning, rng))
        turns = [replace(t, degrees=Range(a - KEPT, a + KEPT)) for t, a in zip(turns, angles, strict=True)]
    longest = longest_turn(len(turns), outline, world) * (1 - 0.6 * haste)
    return [
        drawn_turn(turn, angle, longest, outline.hard, rng, haste)
        for turn, angle in zip(turns, angles, strict=True)
    ]


def longest_turn(turns: int, outline: Outline, world: World) -> float:
    """Returns the greatest length of a turn in metres, for a road with ``turns`` turns."""
    wide = outline.each_turn.radius
    longest = max(LONGEST_TURN, wide.lo * radians(WIDE_ANGLE)) if wide and wide.lo > WIDEST else LONGEST_TURN
    by_map = min(2.2 * world.site.map_size / (turns + 1.2), longest)
    if outline.length is None or outline.length.hi == inf:
        return by_map
    straights = 2 * LEAD + 0.4 * SEPARATE * (turns - 1)
    return min(by_map, max(1.2 * (0.95 * outline.length.hi - straights) / max(turns, 1), 10.0))


def _share(rng: np.random.Generator, haste: float) -> float:
    return float(rng.random() * (1 - 0.9 * haste))


def _uncoiled(angles: list[float], ranges: Sequence[Range], hands: Sequence[int], most: float) -> list[float]:
    """Returns angles, reduced if possible so that the headings of the road span at most ``most`` degrees."""
    low = _swing([degrees.lo * hand for degrees, hand in zip(ranges, hands, strict=True)])
    now = _swing([angle * hand for angle, hand in zip(angles, hands, strict=True)])
    if now <= most or now <= low:
        return angles
    f = max((most - low) / (now - low), 0.0)
    return [degrees.lo + f * (a - degrees.lo) for a, degrees in zip(angles, ranges, strict=True)]


def drawn_target(asked: Range, rng: np.random.Generator) -> float:
    """Chooses the sum of the angles of all turns at random, in degrees, within the required range."""
    near = asked.around(NEAR_SUM)
    low = near.lo if near.lo > 0 else 0.6 * near.hi
    high = near.hi if near.hi < inf else 1.3 * near.lo
    return low + (high - low) * (0.3 + 0.4 * float(rng.random()))


def _summed(angles: list[float], ranges: Sequence[Range], target: float) -> list[float]:
    """Returns angles moved towards one end of their ranges until their sum is ``target``, if possible."""
    missing = target - sum(angles)
    ends = [degrees.hi if missing > 0 else degrees.lo for degrees in ranges]
    room_left = sum(ends) - sum(angles)
    f = min(missing / room_left, 1.0) if room_left else 0.0
    return [angle + f * (end - angle) for angle, end in zip(angles, ends, strict=True)]


def _swing(signed: Sequence[float]) -> float:
    heading, low, high = 0.0, 0.0, 0.0
    for angle in signed:
        heading += angle
        low, high = min(low, heading), max(high, heading)
    return high - low


def drawn_turn(
    turn: Feature, angle: float, longest: float, hard: bool, rng: np.random.Generator, haste: float
) -> Element:
    """Chooses the radius and the transitions of one turn at random.

    Args:
        turn: the turn with the ranges to choose from, as ``narrowed_turns`` returns it.
        angle: change of heading in degrees; it may be changed within its range so that the turn fits.
        longest: greatest length of the turn in metres.
        hard: True if a hard road was requested; the radius is then near the smallest one allowed.
        rng: random number generator.
        haste: from 0 to 1; the larger it is, the smaller the radius.
    """
    asked, radii = turn.degrees or ANY_TURN, turn.radius or Range(0)
    least, most, is_tight = radii.lo, radii.hi, radii.hi < inf
    if hard:
        most = max(min(most, least * TIGHTER), least)
    if turn.length:
        low, high = turn.length.lo, min(turn.length.hi, max(LONGEST_TURN, 1.2 * turn.length.lo))
        low = low if low > 0 else 0.5 * high
        length = low + (0.35 + 0.3 * rng.random()) * (high - low)
        transition = 0.1 * length
        radius = min(max((length - transition) / radians(angle), least), most)
        angle = min(max(degrees((length - transition) / radius), asked.lo), asked.hi)
        return turn_element(angle, hand_of(turn), radius, transition, turn.grade, turn.climb)
    if not is_tight and not hard:
        least = max(least, SHORTEST_TURN * (1 - haste) / radians(angle))
    wide = max(min(most, WIDEST if most == inf else most), min(least * 1.4, most))
    if is_tight:  # short turns are measured wider than they are
        wide = least + 0.85 * (wide - least)
    radius = exp(log(least) + _share(rng, haste) * (log(wide) - log(least)))
    if radius * radians(angle) > longest:
        if rng.random() < 0.7:
            angle = max(asked.lo, min(angle, degrees(longest / radius)))
        radius = max(least, min(radius, longest / radians(angle)))
    transition = _transition(is_tight, angle, radius, rng)
    return turn_element(angle, hand_of(turn), radius, transition, turn.grade, turn.climb)


def _transition(is_tight: bool, angle: float, radius: float, rng: np.random.Generator) -> float:
    """Returns a random clothoid length in metres; short where a required radius must be measurable."""
    arc = radius * radians(angle)
    share = TRANSITIONS[0] + (TRANSITIONS[1] - TRANSITIONS[0]) * rng.random()
    transition = min(
        max(share * arc, TRANSITION_LIMITS[0]), max(TRANSITION_LIMITS[1], radius / RADII_OF_TRANSITION)
    )
    if is_tight:
        transition = min(transition, max(arc - SEEN_ARC, 1.0))
    return min(transition, MOST_TRANSITION * arc / segments_of_turn(angle))


def drawn_straight(wish: Feature, rng: np.random.Generator, haste: float, least: float, mean: float) -> float:
    """Chooses the length of a required straight at random, in metres.

    Args:
        wish: the required straight.
        rng: random number generator.
        haste: from 0 to 1; the larger it is, the shorter a straight without an upper limit.
        least: least length in metres; reduced if the required range does not allow it.
        mean: average number of metres by which a straight without an upper limit exceeds its least length.
    """
    span = wish.length or Range(10, inf)
    low, high = span.lo, span.hi
    if high == inf:
        low = max(inside(low), 22.0, least)
        return free_straight(rng, haste, low, mean)
    low = max(low, 0.0)
    share = 0.5 + (0.4 if span.number is None else NEAR_LENGTH) * (rng.random() - 0.5)
    most = low + min(OFF_TOP + 3 * haste, UP_TO) * (high - low)
    return max(low + share * (high - low), min(least, most))


def inside(least: float) -> float:
    """Returns the length in metres that a straight is given so that ``least`` metres of it are measured."""
    return 1.05 * least + 3.0


def free_straight(rng: np.random.Generator, haste: float, least: float, mean: float) -> float:
    """Returns a random length, in metres, of a straight without requirements.

    The length is ``least`` plus a random part. This part is about ``mean`` metres on average if ``haste`` is
    0, and becomes shorter as ``haste`` grows towards 1.
    """
    return least + min(float(rng.exponential(mean)), 3 * mean) * (1 - 0.95 * haste)
