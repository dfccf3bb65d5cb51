"""Chooses at random what a description leaves open: angle, radius and transitions of turns, and lengths of
straights. Turns that must be alike get one angle and radius, and straights one length."""

from collections.abc import Sequence
from dataclasses import replace
from math import degrees, exp, inf, log, radians
from typing import NamedTuple

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import KINDS, LEAST_STRAIGHT, SHARPNESS
from roadgpt.check.matching import LikeGroup, like_groups, like_straights
from roadgpt.check.measures import LEAST_TURN
from roadgpt.design.elements import MOST_TRANSITION, segments_of_turn, turn_element
from roadgpt.design.sequence import TurnSequence
from roadgpt.design.windows import Windows
from roadgpt.errors import DesignError
from roadgpt.road import World

ANY_TURN = Range(25, 120)  # degrees, where nothing is said: the table in brief.words
AIMS = {meaning.names[0]: meaning.aim for meaning in KINDS.values() if meaning.aim}
SHARPNESS_AIMS = {meaning.degrees: meaning.aim for meaning in SHARPNESS.values() if meaning.aim}
WORD_RADII = frozenset(meaning.radius for meaning in (*KINDS.values(), *SHARPNESS.values()))
"""The ranges of radii of words such as "gentle"; turns named with these words use the whole range."""
FEWEST_TO_BOUND = 3  # turns of which one is as tight as a bound allows
NEAR_BOUND = 1.06  # greatest ratio of its radius to the bound
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
ANGLE_SPREAD = 0.4  # degrees by which the angles of like turns may differ from the one that was drawn
SPREAD = 0.01  # share by which radii and lengths may differ
JOIN_MEAN = 14.0  # m by which a straight between like turns exceeds its least length on average
FILLED = (0.5, 1.0)  # share of what the turns leave of the required length that like straights fill
NARROW = 1.25  # ratio of the ends of a range that was given as one number, which needs no drawing


class DraftTask(NamedTuple):
    """The requirements, the World and the random generator with which the parts of a draft are drawn."""

    outline: Outline
    windows: Windows
    world: World
    rng: np.random.Generator
    haste: float  # from 0 to 1; the larger it is, the smaller the lengths, angles and radii


def narrowed_turns(turns: Sequence[Feature], task: DraftTask) -> list[Feature]:
    """Returns the turns with the ranges from which their angle, radius, length and grade are chosen. The
    ranges lie a little inside the required ones. If a number is required, its range lies close around the
    number; the more haste, the wider. Raises DesignError if a range is empty, for example because the rules
    forbid a radius as too tight."""
    narrowed = [_narrowed(turn, task) for turn in turns]
    return [replace(turn, grade=task.windows.of(turn)) for turn in narrowed]


def with_one_at_bound(
    narrowed: Sequence[Feature], turns: Sequence[Feature], task: DraftTask
) -> list[Feature]:
    """Returns the narrowed turns; the radius of a random turn is set to at most 1.06 times the least allowed.

    This needs three turns or more, which all have the same least radius, given as a number. The road then
    meets both "no radius below 25 m" and "25 m at the tightest". ``turns`` are the same turns with the
    required ranges."""
    out, bounds = [*narrowed], {overlap(turn.radius, task.outline.each_turn.radius) for turn in turns}
    bound = bounds.pop()
    if bounds or len(turns) < FEWEST_TO_BOUND or bound is None or bound.hi < inf or bound in WORD_RADII:
        return out
    at = int(task.rng.integers(len(out)))
    low = (out[at].radius or bound).lo
    out[at] = replace(out[at], radius=Range(low, NEAR_BOUND * low))
    return out


def _narrowed(turn: Feature, task: DraftTask) -> Feature:
    outline, world, haste = task.outline, task.world, task.haste
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
    """Returns a range narrowed at both ends by a share of its width, or of its lower bound if it has no upper
    one."""
    return span.drawn_in(share * (span.lo if span.hi == inf else span.hi - max(span.lo, 0.0)), 0.5)


def hand_of(turn: Feature) -> int:
    """Returns -1 for a turn to the right, and 1 for a turn to the left or to either side."""
    return -1 if turn.side == "right" else 1


def drawn_turns(turns: Sequence[Feature], task: DraftTask) -> list[Element]:
    """Chooses the angle, radius and transitions of each turn at random, from the ranges of
    ``narrowed_turns``."""
    rng, turning = task.rng, task.outline.turning
    ranges = [turn.degrees or ANY_TURN for turn in turns]
    hands = [hand_of(turn) for turn in turns]
    angles = [degrees.lo + _share(task) * (degrees.hi - degrees.lo) for degrees in ranges]
    angles = _uncoiled(angles, ranges, hands, 215 + 115 * rng.random())
    if turning:
        angles = _summed(angles, ranges, drawn_target(turning, rng))
        turns = [replace(t, degrees=Range(a - KEPT, a + KEPT)) for t, a in zip(turns, angles, strict=True)]
    longest = longest_turn(len(turns), task) * (1 - 0.6 * task.haste)
    return [drawn_turn(turn, angle, longest, task) for turn, angle in zip(turns, angles, strict=True)]


def longest_turn(turns: int, task: DraftTask) -> float:
    """Returns the greatest length of a turn in metres, for a road with ``turns`` turns."""
    outline = task.outline
    wide = outline.each_turn.radius
    longest = max(LONGEST_TURN, wide.lo * radians(WIDE_ANGLE)) if wide and wide.lo > WIDEST else LONGEST_TURN
    by_map = min(2.2 * task.world.site.map_size / (turns + 1.2), longest)
    if outline.length is None or outline.length.hi == inf:
        return by_map
    straights = 2 * LEAD + 0.4 * SEPARATE * (turns - 1)
    return min(by_map, max(1.2 * (0.95 * outline.length.hi - straights) / max(turns, 1), 10.0))


def _share(task: DraftTask) -> float:
    return float(task.rng.random() * (1 - 0.9 * task.haste))


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


def drawn_turn(turn: Feature, angle: float, longest: float, task: DraftTask) -> Element:
    """Chooses the radius and the transitions of one turn at random, within the ranges of ``narrowed_turns``.
    On a hard road, the radius is near the smallest one allowed. ``angle``, the change of heading in degrees,
    may be changed within its range so that the turn is no longer than ``longest`` metres."""
    rng, hard = task.rng, task.outline.hard
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
        least = max(least, SHORTEST_TURN * (1 - task.haste) / radians(angle))
    wide = max(min(most, WIDEST if most == inf else most), min(least * 1.4, most))
    if is_tight:  # short turns are measured wider than they are
        wide = least + 0.85 * (wide - least)
    radius = exp(log(least) + _share(task) * (log(wide) - log(least)))
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


def drawn_straight(wish: Feature, least: float, mean: float, task: DraftTask) -> float:
    """Chooses the length of a required straight at random, in metres. It is at least ``least`` metres if the
    required range allows that. Without an upper limit, the length exceeds its lower limit by about ``mean``
    metres on average, and by less in haste."""
    span = wish.length or Range(10, inf)
    low, high = span.lo, span.hi
    if high == inf:
        low = max(inside(low), 22.0, least)
        return free_straight(low, mean, task)
    low = max(low, 0.0)
    share = 0.5 + (0.4 if span.number is None else NEAR_LENGTH) * (task.rng.random() - 0.5)
    most = low + min(OFF_TOP + 3 * task.haste, UP_TO) * (high - low)
    return max(low + share * (high - low), min(least, most))


def inside(least: float) -> float:
    """Returns the length in metres that a straight is given so that ``least`` metres of it are measured."""
    return 1.05 * least + 3.0


def free_straight(least: float, mean: float, task: DraftTask) -> float:
    """Returns a random length, in metres, of a straight without requirements: ``least`` plus a random part,
    which is about ``mean`` metres on average without haste."""
    return least + min(float(task.rng.exponential(mean)), 3 * mean) * (1 - 0.95 * task.haste)


def with_like_parts(order: TurnSequence, task: DraftTask) -> TurnSequence:
    """Returns the sequence with narrow ranges for turns and straights that must be alike, as
    ``check.matching`` finds them. The others are left as they are."""
    turns = [*order.turns]
    for group in like_groups(turns):
        angles, radii = _like_turn(group, len(turns), task)
        for place in group:
            turns[place] = replace(turns[place], degrees=angles, radius=radii)
    gaps = [[*gap] for gap in order.gaps]
    arcs = sum(_arc(turn) for turn in turns)
    for group in like_straights(gaps):
        length = _like_length(group, gaps, arcs, task)
        for place in group:
            named = gaps[place][0] if gaps[place] else group.common
            gaps[place] = [replace(named, length=length)]
    return TurnSequence(tuple(turns), tuple(map(tuple, gaps)))


def _like_turn(group: LikeGroup, turns: int, task: DraftTask) -> tuple[Range, Range]:
    """Returns the narrow ranges of angle and radius of a group of like turns."""
    (turn,) = narrowed_turns([group.common], task)
    span = turn.degrees or ANY_TURN
    if task.outline.turning and len(group) == turns:
        share = drawn_target(task.outline.turning, task.rng) / turns
        if share in (group.common.degrees or Range()):
            span = Range(share, share)
            turn = replace(turn, degrees=span)
    angle = span.lo + float(task.rng.random()) * (1 - 0.9 * task.haste) * (span.hi - span.lo)
    longest = longest_turn(turns, task) * (1 - 0.6 * task.haste)
    made = drawn_turn(turn, angle, longest, task)
    angle = abs(made.turn)
    return (
        Range(angle - ANGLE_SPREAD, angle + ANGLE_SPREAD),
        Range(made.radius * (1 - SPREAD), made.radius * (1 + SPREAD)),
    )


def _arc(turn: Feature) -> float:
    """Returns the length in metres that a turn is likely to have."""
    angles, radii = turn.degrees or ANY_TURN, turn.radius or Range(2 * LEAD, 2 * LEAD)
    radius = radii.lo if radii.hi == inf else (radii.lo + radii.hi) / 2
    return radians((angles.lo + angles.hi) / 2) * radius


def _like_length(group: LikeGroup, gaps: Sequence[Sequence[Feature]], arcs: float, task: DraftTask) -> Range:
    """Returns the narrow range of lengths of a group of like straights, in metres."""
    span = group.common.length
    if span and span.lo > 0 and span.hi < NARROW * span.lo:
        return span
    is_even = span is None
    least = SEPARATE if is_even else inside((span or Range(LEAST_STRAIGHT)).lo)
    length = (
        free_straight(least, JOIN_MEAN, task)
        if is_even
        else drawn_straight(group.common, LEAD, JOIN_MEAN, task)
    )
    asked = task.outline.length
    if asked and asked.hi < inf:
        others = [place for place in range(len(gaps)) if place not in group]
        rest = sum(SEPARATE + sum(each.length.lo for each in gaps[at] if each.length) for at in others)
        left = (max(asked.lo, 0.0) + asked.hi) / 2 - arcs - rest
        length = max(left / len(group) * float(task.rng.uniform(*FILLED)), least)
    length = min(length, (span or Range()).hi * (1 - SPREAD))
    return Range((1 - SPREAD) * length, (1 + SPREAD) * length)
