"""Composes the elements of a road at random, within its requirements.

A sequence of left and right turns and of the required straights is chosen first. Each turn gets an angle and
a radius, and each gap between turns the straights that lie in it."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import ceil, degrees, exp, inf, log, radians
from typing import NamedTuple

import numpy as np

from roadgpt.brief.design_speed import BETWEEN_SAME_SIDE
from roadgpt.brief.element import Element
from roadgpt.brief.map_fit import longest_straight
from roadgpt.brief.model import OTHER_SIDE
from roadgpt.brief.outline import USUALLY_WIDEST, Feature, Outline, both
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import KINDS, LEAST_STRAIGHT, SHARPNESS, STEEPEST
from roadgpt.check.matching import LikeGroup, change_of_grade, like_groups, like_straights
from roadgpt.check.measures import LEAST_TURN, GradeChange
from roadgpt.check.rules.too_abrupt import MOST
from roadgpt.design.elements import MOST_TRANSITION, segments_of_turn, turn_element
from roadgpt.design.vertical import COMFORT
from roadgpt.errors import DesignError
from roadgpt.language.names import Side
from roadgpt.road import World

HAIRPINS = ("hairpin", "switchback")  # names of turns with which a road climbs or descends a slope
SEVERAL = 3  # hairpins, if their number is open
USUAL = (0.10, 0.20, 0.26, 0.20, 0.14, 0.10)  # probabilities of 1, 2, ... turns, if the number is open
MORE = (0.45, 0.30, 0.17, 0.08)  # probabilities of 0, 1, ... turns more than the least required number
SWITCH = 0.6  # probability that a turn goes to the other side than the one before, if its side is open
WIDE = 100.0  # degrees: larger turns to one side would coil up, so they mostly alternate
SWITCH_WIDE = 0.9
SMALL, LARGE = 27.0, 105.0  # degrees of usual turns, which bound their number if their sum is required
LONG = 700.0  # m: a shorter road with a few turns fits on the usual map
ROUNDS = 60  # of drawing sides until the numbers of left and right turns are right


Rng = np.random.Generator
OpenTurn = tuple[Feature, bool]
"""A turn whose side may be open, and whether it must go to the side opposite to the previous turn."""
OpenSequence = tuple[list[OpenTurn], list[list[Feature]]]
"""Such turns, and the straights required before, between and after them."""


class TurnSequence(NamedTuple):
    """The left and right turns of a road, and the straights required before, between and after them."""

    turns: tuple[Feature, ...]
    gaps: tuple[tuple[Feature, ...], ...]

    def is_leg(self, gap: int) -> bool:
        """Returns whether a gap, counted from 0, lies between two hairpins or switchbacks."""
        return 0 < gap < len(self.turns) and all(map(is_hairpin, self.turns[gap - 1 : gap + 1]))


def is_hairpin(feature: Feature) -> bool:
    """Returns whether the description calls the turn a hairpin or a switchback."""
    return feature.name in HAIRPINS


def is_long(outline: Outline) -> bool:
    """Returns whether a length of 700 m or more is required and the number of turns is left open."""
    return outline.length is not None and outline.length.lo >= LONG and may_repeat_last_turn(outline)


def may_repeat_last_turn(outline: Outline) -> bool:
    """Returns whether the road may have more turns like its last one."""
    turning = [group for group in outline.groups if group.feature.kind == "turn"]
    is_last = bool(outline.groups) and outline.groups[-1].feature.kind == "turn" and outline.ends is None
    if not turning:
        return outline.turns.hi == inf and outline.ends is None
    return len(turning) == 1 and is_last and turning[0].hi is None


def drawn_sequence(outline: Outline, rng: Rng, plain: bool) -> TurnSequence:
    """Chooses at random what the Outline leaves open: the number of turns, the side of each, and where
    straights are. If ``plain``, the road has as few turns as the requirements allow. Raises DesignError if
    the required numbers of left, right and all turns contradict each other."""
    turns, gaps = _listed(outline, rng, plain) if outline.names_all_turns else _free(outline, rng, plain)
    for feature, index in ((outline.starts, 0), (outline.ends, -1)):
        if feature is not None and feature.kind == "straight":
            gap = gaps[index]
            if not gap or not _shares(gap[index], feature):
                gap.insert(0 if index == 0 else len(gap), feature)
            else:
                gap[index] = both(gap[index], feature)
        elif feature is not None and turns:
            one, switches = turns[index]
            turns[index] = replace(both(one, feature), side=feature.side or one.side), switches
    sides = _sides(turns, outline, rng)
    features = tuple(replace(turn, side=side) for (turn, _), side in zip(turns, sides, strict=True))
    return TurnSequence(features, tuple(map(tuple, gaps)))


def _listed(outline: Outline, rng: Rng, plain: bool) -> OpenSequence:
    turns: list[OpenTurn] = []
    gaps: list[list[Feature]] = [[]]
    counts = _group_counts(outline, rng, plain)
    for group, count in zip(outline.groups, counts, strict=True):
        feature = group.feature
        if feature.kind == "straight":
            gaps[-1] += [feature] * count
            continue
        for number in range(count):
            switches = group.alternating and number > 0
            turns.append((replace(feature, side=None) if switches else feature, switches))
            gaps.append([])
    return turns, gaps


def _group_counts(outline: Outline, rng: Rng, plain: bool) -> list[int]:
    groups = outline.groups
    counts = [
        SEVERAL if not plain and (group.lo, group.hi) == (2, None) and is_hairpin(group.feature) else group.lo
        for group in groups
    ]
    open_ = [i for i, g in enumerate(groups) if g.feature.kind == "turn" and g.hi != g.lo]
    total = sum(count for count, g in zip(counts, groups, strict=True) if g.feature.kind == "turn")
    missing = int(max(outline.turns.lo - total, _turned(outline).lo - total, 0))
    more = 0 if plain or not open_ else int(rng.choice(len(MORE), p=MORE))
    spare = outline.turns.hi - total
    for _ in range(int(min(max(missing, more), spare)) if open_ else 0):
        able = [i for i in open_ if (groups[i].hi is None or counts[i] < (groups[i].hi or 0))]
        if not able:
            break
        counts[able[rng.integers(len(able))]] += 1
    return counts


def _free(outline: Outline, rng: Rng, plain: bool) -> OpenSequence:
    count = _turn_count(outline, rng, plain)
    turns = [(Feature("turn", "turn"), False)] * count
    gaps: list[list[Feature]] = [[] for _ in range(count + 1)]
    straights = [group.feature for group in outline.groups for _ in range(group.lo)]
    apart = len(straights) <= count + 1
    where = rng.choice(count + 1, size=len(straights), replace=not apart)
    for index, feature in zip(sorted(where), straights, strict=True):
        gaps[index].append(feature)
    return turns, gaps


def _turn_count(outline: Outline, rng: Rng, plain: bool) -> int:
    low = int(max(outline.turns.lo, outline.left.lo, 0) if outline.turns.lo > 0 else max(outline.left.lo, 0))
    low = max(low, int(max(outline.left.lo, 0) + max(outline.right.lo, 0)))
    high = min(outline.turns.hi, outline.left.hi + outline.right.hi)
    if low > high:
        sides = {"left": outline.left, "right": outline.right}
        asked = " and ".join(f"{span} to the {side}" for side, span in sides.items() if span != Range())
        raise DesignError(f"no road has turns {outline.turns} in all, {asked}; change one of these numbers")
    # a road for which only climbs and falls are required gets few turns
    only_slopes = bool(outline.groups) and all(group.feature.grade for group in outline.groups)
    enough = _turned(outline)
    low, high = max(low, int(min(enough.lo, high))), max(low, min(high, enough.hi))
    if plain or only_slopes:
        return low
    if low <= 1:
        some = 1 + int(rng.choice(len(USUAL), p=USUAL))
        return int(min(max(some, low), high))
    return int(min(low + rng.choice(len(MORE), p=MORE), high))


def _turned(outline: Outline) -> Range:
    """Returns the range of the number of turns whose usual angles can have the required sum."""
    if outline.turning is None:
        return Range(0)
    most = outline.turning.hi // SMALL if outline.turning.hi < inf else inf
    return Range(ceil(max(outline.turning.lo, 0) / LARGE), most)


def _shares(one: Feature, other: Feature) -> bool:
    shared = overlap(one.length, other.length), overlap(one.grade, other.grade)
    return all(each.lo <= each.hi for each in shared if each)


def _sides(turns: Sequence[OpenTurn], outline: Outline, rng: Rng) -> list[Side]:
    left, right, n = outline.left, outline.right, len(turns)
    for _ in range(ROUNDS):
        sides = _drawn_sides(turns, outline, rng)
        if sides is not None and sides.count("left") in left and n - sides.count("left") in right:
            return sides
    raise DesignError(f"the sides asked for the {n} turns contradict each other; leave one of them open")


def _drawn_sides(turns: Sequence[OpenTurn], outline: Outline, rng: Rng) -> list[Side] | None:
    sides: list[Side] = []
    for turn, switches in turns:
        if sides and (switches or outline.alternating):
            side = OTHER_SIDE[sides[-1]]
            if turn.side not in (None, side) and not switches:
                return None
        else:
            side = turn.side or _free_side(turn, sides, len(turns), outline, rng)
        sides.append(side)
    return sides


def _free_side(turn: Feature, sides: Sequence[Side], count: int, outline: Outline, rng: Rng) -> Side:
    rest = count - len(sides)
    lefts, rights = sides.count("left"), len(sides) - sides.count("left")
    if lefts >= outline.left.hi or outline.right.lo - rights >= rest:
        return "right"
    if rights >= outline.right.hi or outline.left.lo - lefts >= rest:
        return "left"
    if not sides:
        return "left" if rng.random() < 0.5 else "right"
    wide = turn.degrees is not None and turn.degrees.lo >= WIDE
    return OTHER_SIDE[sides[-1]] if rng.random() < (SWITCH_WIDE if wide else SWITCH) else sides[-1]


UNDER_LIMIT = 0.4  # percentage points kept off the steepest grade allowed
MARGIN = 0.5  # percentage points kept off the ends of a required range of grades
HILL_GRADE = 2.5  # percent, of hills at a design speed: in haste they are as gentle as that
CLEARLY = 0.6  # percentage points between two straights of different grades that go the same way
MARGIN_SHARE = 0.2  # of the width of the range: no more is kept off


class Windows:
    """The ranges of grade, in percent, that the road and each of its features may have."""

    def __init__(self, outline: Outline, world: World) -> None:
        limit = min(100 * world.limits.max_grade, STEEPEST) - UNDER_LIMIT
        if outline.steepest:
            limit = min(limit, outline.steepest.hi - min(UNDER_LIMIT, 0.2 * outline.steepest.hi))
        self.limit = Range(-limit, limit)
        """The grades that are allowed anywhere."""
        self.floor = outline.speed.vertical_radius if outline.speed else 0.0
        """The least vertical radius in metres at the design speed; 0 if none is asked for."""
        self.comfort = world.limits.speed_limit**2 / COMFORT
        """The vertical radius in metres that is comfortable at the speed limit."""
        self.least = max(world.limits.speed_limit**2 / MOST, self.floor)
        """The least vertical radius in metres that the rule ``too_abrupt`` allows at the speed limit, or
        ``floor`` if that is more."""
        self.hill = self.floor * 2 * HILL_GRADE / 100
        """The length in metres of a climb or a fall between two vertical curves of the design speed."""
        self.base: Range | None = None
        """The grades of features without a requirement of their own; None if they are free."""
        self.way = {"up": "uphill", "down": "downhill"}.get(outline.grade or "", "flat")
        self.allowed = {"up": Range(-1, inf), "down": Range(-inf, 1), "flat": Range(-1, 1)}.get(
            outline.grade or "", self.limit
        )
        if outline.grade == "flat":
            self.base = Range(-0.4, 0.4, number=0.0)
        elif outline.grade or outline.grade_range:
            usual = Range(-12, -3) if outline.grade == "down" else Range(3, 12)
            self.base = (outline.grade_range or usual).drawn_in(MARGIN, MARGIN_SHARE)
        if self.base:
            self.base = overlap(self.base, self.limit) or self.base
            if self.base.lo > self.base.hi:
                most = f"the {self.limit.hi + UNDER_LIMIT:.3g} % that it may have"
                raise DesignError(f"a road of {outline.grade_range} % is steeper than {most}; ask for less")

    def of(self, feature: Feature) -> Range | None:
        """Returns the range of grades for the design of a feature, a little inside its required range or, if
        it has none, that for the road; None if that is open as well. Raises DesignError if the required grade
        is steeper than allowed, or contradicts that of the whole road."""
        if feature.grade is None:
            return self.base
        own = overlap(feature.grade.drawn_in(MARGIN, MARGIN_SHARE), self.limit) or self.limit
        said = f"a {feature.name} of {feature.grade} %"
        if own.lo > own.hi:
            most = f"the {self.limit.hi + UNDER_LIMIT:.3g} % that the road may have"
            raise DesignError(f"{said} is steeper than {most}; ask for less")
        meets = overlap(own, self.base) or own
        if meets.lo > meets.hi and (own.hi <= self.allowed.lo or own.lo >= self.allowed.hi):
            whole = f"a road that is {self.way} all the way"
            raise DesignError(f"{said} contradicts {whole}; leave one of them out")
        return meets if meets.lo <= meets.hi else own

    def row(self, straights: Sequence[Feature]) -> list[Range | None]:
        """Returns a range of grades per straight; an open grade gets a range unlike that of a neighbour."""
        out = [self.of(straight) for straight in straights]
        for i, straight in enumerate(straights):
            known = out[i - 1] if i else (out[i + 1] if i + 1 < len(out) else None)
            if straight.grade is None and self.base is None and known:
                out[i] = self.other(known)
        for i, (one, other) in enumerate(pairwise(straights)):
            out[i : i + 2] = _divided(out[i : i + 2], change_of_grade(one.grade, other.grade))
        return out

    def other(self, grade: Range | None) -> Range:
        """Returns a range of grades that measurements can distinguish from the range ``grade``."""
        if self.base and not (self.base.lo <= 0 <= self.base.hi):
            return Range(0, 0)
        return Range(0, 0) if grade is None or grade.lo > 1 or grade.hi < -1 else Range(3.5, 6)

    @staticmethod
    def between(one: Range | None, other: Range | None) -> float:
        """Returns the least change of grade between two ranges, in percentage points; 0 if they overlap."""
        return max(one.lo - other.hi, other.lo - one.hi, 0.0) if one and other else 0.0

    def part(self, one: Range | None, other: Range | None) -> bool:
        """Returns whether the grade must change between two features with these ranges of grade."""
        return self.between(one, other) > 0


def _divided(pair: list[Range | None], change: GradeChange | None) -> list[Range | None]:
    """Returns the ranges of grade of two straights, clearly apart from the grade between them; unchanged if
    there is no change, or if one of them would become empty."""
    one, other = pair
    if change is None or one is None or other is None:
        return pair
    low, high = Range(hi=change.grade - CLEARLY / 2), Range(lo=change.grade + CLEARLY / 2)
    first, second = (low, high) if change.rises else (high, low)
    found = [overlap(one, first) or one, overlap(other, second) or other]
    return [*found] if all(each.lo <= each.hi for each in found) else pair


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
OF_LENGTH = 0.25  # of the required length of a turn, for each clothoid that a design speed needs, at most
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
LIKE_JOIN_MEAN = 14.0  # m by which a straight between like turns exceeds its least length on average
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
    return [_narrowed(turn, task) for turn in turns]


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
    degrees = _angles(turn, angle, haste)
    return replace(turn, degrees=degrees, radius=radius, length=length, grade=task.windows.of(turn))


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
    rng, hard, speed = task.rng, task.outline.hard, task.outline.speed
    least_transition = speed.transition if speed else 0.0
    asked, radii = turn.degrees or ANY_TURN, turn.radius or Range(0)
    least, most, is_tight = radii.lo, radii.hi, radii.hi < inf
    if hard:
        most = max(min(most, least * TIGHTER), least)
    if turn.length and not (turn.bump and turn.length.hi == inf):
        low, high = turn.length.lo, min(turn.length.hi, max(LONGEST_TURN, 1.2 * turn.length.lo))
        low = low if low > 0 else 0.5 * high
        length = low + (0.35 + 0.3 * rng.random()) * (high - low)
        transition = max(0.1 * length, min(least_transition, OF_LENGTH * length))
        radius = min(max((length - transition) / radians(angle), least), most)
        angle = min(max(degrees((length - transition) / radius), asked.lo), asked.hi)
        return turn_element(angle, hand_of(turn), radius, transition, turn.grade, turn.climb, bool(turn.bump))
    if turn.length:
        shortest = inside(turn.length.lo)
        angle = max(angle, min(degrees(shortest / most), asked.hi))
        least = min(max(least, shortest / radians(angle)), most)
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
    transition = _transition(is_tight, angle, radius, least_transition, rng)
    return turn_element(angle, hand_of(turn), radius, transition, turn.grade, turn.climb, bool(turn.bump))


def _transition(is_tight: bool, angle: float, radius: float, least: float, rng: Rng) -> float:
    arc, (low, high) = radius * radians(angle), TRANSITION_LIMITS
    share = TRANSITIONS[0] + (TRANSITIONS[1] - TRANSITIONS[0]) * rng.random()
    transition = max(min(max(share * arc, low), max(high, radius / RADII_OF_TRANSITION)), least)
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
    which is about ``mean`` metres on average without haste, or 1 m for each km/h of the design speed."""
    mean = max(mean, task.outline.speed.kmh) if task.outline.speed else mean
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
    (turn,) = narrowed_turns([group.common], task)
    span = turn.degrees or ANY_TURN
    if task.outline.turning and len(group) == turns:
        share = drawn_target(task.outline.turning, task.rng) / turns
        if share in (group.common.degrees or Range()):
            span = Range(share, share)
            turn = replace(turn, degrees=span)
    angle = span.lo + _share(task) * (span.hi - span.lo)
    made = drawn_turn(turn, angle, longest_turn(turns, task) * (1 - 0.6 * task.haste), task)
    angle = abs(made.turn)
    radii = Range(made.radius * (1 - SPREAD), made.radius * (1 + SPREAD))
    return Range(angle - ANGLE_SPREAD, angle + ANGLE_SPREAD), radii


def _arc(turn: Feature) -> float:
    angles, radii = turn.degrees or ANY_TURN, turn.radius or Range(2 * LEAD, 2 * LEAD)
    radius = radii.lo if radii.hi == inf else (radii.lo + radii.hi) / 2
    return radians((angles.lo + angles.hi) / 2) * radius


def _like_length(group: LikeGroup, gaps: Sequence[Sequence[Feature]], arcs: float, task: DraftTask) -> Range:
    span = group.common.length
    if span and span.lo > 0 and span.hi < NARROW * span.lo:
        return span
    if span is None:
        least = SEPARATE
        length = free_straight(least, LIKE_JOIN_MEAN, task)
    else:
        least = inside(span.lo)
        length = drawn_straight(group.common, LEAD, LIKE_JOIN_MEAN, task)
    asked = task.outline.length
    if asked and asked.hi < inf:
        others = [place for place in range(len(gaps)) if place not in group]
        rest = sum(SEPARATE + sum(each.length.lo for each in gaps[at] if each.length) for at in others)
        left = (max(asked.lo, 0.0) + asked.hi) / 2 - arcs - rest
        length = max(left / len(group) * float(task.rng.uniform(*FILLED)), least)
    length = min(length, (span or Range()).hi * (1 - SPREAD))
    return Range((1 - SPREAD) * length, (1 + SPREAD) * length)


LEAD_MEAN = 26.0  # m by which a lead-in or lead-out exceeds its least length on average
JOIN_MEAN = 16.0  # m by which a straight between turns exceeds its least length on average
LEG = 33.0  # m, least length of a straight between hairpins; 30 m of it are measured as straight
LEG_MEAN = 25.0  # m by which such a straight exceeds LEG on average
CRAMPED = 0.5  # haste from which hairpins are joined like other turns
LONELY_MEAN = 60.0  # m by which a straight beside the only turn exceeds its least length on average
APPROACH = 35.0  # m of additional straight in front of a turn of a hard road, about: room to gain speed
DIRECT = 0.35  # probability that turns to opposite sides follow each other almost without a straight
HARDLY = 7.0  # m
CHANGE = 24.0  # m of straight for the change from one required grade to another
LONGEST_CHANGE = 100.0  # m; more would not fit on the map
STEP_ASIDE = 14.0  # m with the grade of a turn before a required straight, as none changes in the turn
OPEN = Range(LEAST_STRAIGHT, inf)  # m, of a required straight without a required length
ALONE = (60.0, 240.0)  # m, of a road without turns and without a required length
HILL = 42.0  # m of one climb or fall of a hilly road
OVER_HILL = 1.25  # ratio of such a length to the length that is cut into hills later
CLIMBS_AT = 12.0  # percent at most, where a road must be long enough for its climb
MODERATE = 5.0  # percent, of a straight whose height is given and whose length is open
EASE = 0.85  # of that grade, on average
SHORT_LEAD = 5.0  # m, of a lead-in or lead-out of a road that must be short
NEAR_NUMBER = 0.1  # share of the tolerance of a length that is used where possible
ROUNDING = 0.1  # m by which a straight from corner to corner is shorter than the diagonal
FEWEST_METRES = 1.0  # m, of a straight that is shortened so that the whole length is right


def composed(order: TurnSequence, task: DraftTask) -> list[Element] | None:
    """Returns the elements of a draft in driving order; None if they cannot have the required length."""
    outline = task.outline
    narrowed = narrowed_turns(order.turns, task)
    if order.turns:
        narrowed = with_one_at_bound(narrowed, order.turns, task)
    turns: list[Element | None] = list(drawn_turns(narrowed, task))
    elements: list[Element] = []
    legs = map(order.is_leg, range(len(order.gaps)))
    for before, gap, after, leg in zip([None, *turns], order.gaps, [*turns, None], legs, strict=True):
        elements += gap_between(before, gap, after, task, leg)
        if after:
            elements.append(after)
    if outline.hills:
        elements = _with_hills(elements, outline.hills, max(HILL, OVER_HILL * task.windows.hill), task.rng)
    length = asked_length(outline, task.windows)
    whole = _with_length(elements, length, task) if length else elements
    if whole is None or (order.turns and any(group.feature.kind == "turn" for group in outline.groups)):
        return whole
    whole = _evened(whole, [wish for gap in order.gaps for wish in gap])
    return _from_corner_to_corner(whole, task) if outline.turns.hi == 0 else whole


def _evened(elements: list[Element], wishes: Sequence[Feature]) -> list[Element]:
    free = [i for i, one in enumerate(elements) if one.is_elastic and one.required_length is not None]
    open_wishes = [wish for wish in wishes if not wish.length or wish.length.hi == inf]
    have_grades = all(wish.grade and wish.grade.number is not None for wish in open_wishes)
    heights = {abs(wish.climb.number or 0.0) if wish.climb else 0.0 for wish in open_wishes}
    are_alike = have_grades or (len(heights) == 1 and all(heights))
    if not free or len(free) != len(open_wishes) or not are_alike:
        return elements
    length = sum(elements[i].length for i in free) / len(free)
    return [one._replace(straight=length) if i in free else one for i, one in enumerate(elements)]


def _from_corner_to_corner(elements: list[Element], task: DraftTask) -> list[Element]:
    """Returns the straights of a road without turns, shortened if they do not fit on the map's diagonal;
    unchanged, so that the road is too large for the map, if they would be shorter than required."""
    world, whole = task.world, sum(element.length for element in elements)
    longest = longest_straight(world.site.map_size, world.section.road_width) - ROUNDING
    keep = min(longest / whole, 1.0)
    asked = [(whole, task.outline.length), *((each.length, each.required_length) for each in elements)]
    if any(span and keep * length < span.lo for length, span in asked):
        return elements
    return [element._replace(straight=keep * element.length) for element in elements]


def asked_length(outline: Outline, windows: Windows) -> Range | None:
    """Returns the range of lengths in metres that the road may have; None if any length will do. If a climb
    but no length is required, the range begins at the length that the climb needs at a moderate grade."""
    if outline.length or not outline.climb:
        return outline.length
    height = max(outline.climb.lo, -outline.climb.hi, 0.0)
    allowed = windows.base or windows.limit
    steepest = min(max(allowed.hi, -allowed.lo), CLIMBS_AT)
    return Range(100 * height / (EASE * max(steepest, 1.0)), inf)


def gap_between(
    before: Element | None,
    wishes: Sequence[Feature],
    after: Element | None,
    task: DraftTask,
    is_leg: bool = False,
) -> list[Element]:
    """Returns the straights between two turns, or between a turn and an end of the road, where ``before`` or
    ``after`` is None. ``wishes`` are required here, in order. If ``is_leg``, both turns are hairpins."""
    outline, windows, rng = task.outline, task.windows, task.rng
    before, after = before and before.halves[-1], after and after.halves[0]
    if is_leg and not wishes and task.haste < CRAMPED:
        return [Element(free_straight(LEG, LEG_MEAN, task))]
    if wishes:
        few = outline.turns.hi <= 1 and len(wishes) == 1
        return _asked_gap(before, wishes, after, LONELY_MEAN if few else JOIN_MEAN, task)
    if not before and not after:
        length = ALONE[0] + rng.random() * (ALONE[1] - ALONE[0]) * (1 - 0.6 * task.haste)
        return [Element(length, required_grade=windows.base)]
    if not before or not after:
        mean = LONELY_MEAN if outline.turns.hi == 1 else LEAD_MEAN
        return [Element(free_straight(LEAD, mean, task) + _approach(after, task))]
    changes = windows.part(before.required_grade, after.required_grade)
    curve = windows.floor * windows.between(before.required_grade, after.required_grade) / 100
    least = max(CHANGE, curve) if changes else 0.0
    if before.turn * after.turn > 0:
        usual = BETWEEN_SAME_SIDE * outline.speed.kmh * (1 - task.haste) if outline.speed else 0.0
        least = max(least, SEPARATE, usual)
    elif not changes and rng.random() < DIRECT:
        length = HARDLY * rng.random()
        return [Element(length)] if length > FEWEST_METRES else []
    length = free_straight(max(least, FEWEST_METRES), JOIN_MEAN, task)
    return [Element(length + _approach(after, task))]


def _approach(after: Element | None, task: DraftTask) -> float:
    return APPROACH * (0.4 + task.rng.random()) if task.outline.hard and after else 0.0


def _asked_gap(
    before: Element | None, wishes: Sequence[Feature], after: Element | None, mean: float, task: DraftTask
) -> list[Element]:
    out: list[Element] = []
    windows = task.windows
    grades = windows.row(wishes)
    if before and windows.part(before.required_grade, grades[0]):
        out.append(Element(STEP_ASIDE, required_grade=before.required_grade))
    for number, (wish, grade) in enumerate(zip(wishes, grades, strict=True)):
        neighbours = [grades[i] for i in (number - 1, number + 1) if 0 <= i < len(grades)]
        if number == 0 and before:
            neighbours.append(before.required_grade)
        if number == len(wishes) - 1 and after:
            neighbours.append(after.required_grade)
        if windows.floor and (wish.length or OPEN).hi == inf:  # a turn of open grade leads to another slope
            neighbours = [Range(0, 0) if other is None else other for other in neighbours]
        changes = [_change(grade, other, task) for other in neighbours if windows.part(grade, other)]
        least = max(LEAD, sum(changes) + 8.0 if changes else 0.0, _room_of_climb(wish))
        if number and not windows.part(grades[number - 1], grade):
            out.append(_ledge(grades[number - 1], grade, windows))
        length = drawn_straight(wish, least, mean, task)
        if wish.length and wish.length.number is not None:
            # the straight alone is then a little short, and with what looks straight a little long
            beside = (before if number == 0 else None, after if number == len(wishes) - 1 else None)
            length = max(length - sum(map(_looks_straight, beside)) / 2, min(least, length))
        asked = wish.length or OPEN
        if windows.floor and asked.hi == inf:
            curves = sum(windows.between(grade, other) for other in neighbours) * windows.floor / 200
            asked = Range(max(asked.lo, curves))
        out.append(Element(length, required_length=asked, required_grade=grade, required_climb=wish.climb))
    if after and windows.part(grades[-1], after.required_grade):
        out.append(Element(STEP_ASIDE, required_grade=after.required_grade))
    return out


def _room_of_climb(wish: Feature) -> float:
    """Returns the length in metres on which a straight of open length has its height at a moderate grade."""
    if wish.climb is None or (wish.length and wish.length.hi < inf):
        return 0.0
    return 100 * min(abs(wish.climb.lo), abs(wish.climb.hi)) / MODERATE


def _looks_straight(turn: Element | None) -> float:
    return turn.transition * min(turn.radius / USUALLY_WIDEST, 1.0) if turn else 0.0


def _ledge(before: Range | None, after: Range | None, windows: Windows) -> Element:
    grade = windows.other(after)
    changes = windows.between(before, grade) + windows.between(grade, after)
    length = max(STEP_ASIDE, windows.least * changes / 100)
    return Element(length, required_length=Range(length, length), required_grade=grade)


def _change(grade: Range | None, other: Range | None, task: DraftTask) -> float:
    """Returns the length in metres of straight to reserve for a change of grade at its end. Without haste, a
    comfortable parabola between the two grades has room, unless it needs more than 100 m."""
    change = task.windows.between(grade, other) / 100
    comfortable = min(task.windows.comfort * change, LONGEST_CHANGE) * (1 - task.haste)
    return max(CHANGE * (1 - 0.3 * task.haste), comfortable, task.windows.floor * change)


def _with_hills(elements: list[Element], hills: Range, hill: float, rng: Rng) -> list[Element]:
    stretches = int(hills.lo) + 1
    room = sum(max(int(element.length / hill), 1) for element in elements if element.length > 0.7 * hill)
    free = [i for i, element in enumerate(elements) if element.is_elastic]
    out = list(elements)
    for _ in range(max(stretches - room, 0) if free else 0):
        i = free[rng.integers(len(free))]
        out[i] = out[i]._replace(straight=out[i].length + hill)
    return out


def _with_length(elements: list[Element], asked: Range, task: DraftTask) -> list[Element] | None:
    """Returns the elements with free straights changed so that the road has the required length; None if they
    cannot be shortened enough."""
    rng, now = task.rng, sum(element.length for element in elements)
    core = asked.around(NEAR_NUMBER)
    if core.lo + 1 < now < core.hi - 1:
        return elements
    low = core.lo if core.lo > 0 else 0.7 * asked.hi
    high = core.hi if core.hi < inf else 1.3 * asked.lo
    target = low + (high - low) * (0.15 + 0.7 * rng.random())
    free = [i for i, element in enumerate(elements) if element.is_elastic]
    if not free:
        return elements
    missing = target - now
    if missing > 0:
        shares = rng.dirichlet(np.ones(len(free)))
        lengths = [elements[i].length + missing * share for i, share in zip(free, shares, strict=True)]
    else:
        least = [_least(elements, i, LEAD if task.haste < 0.5 else SHORT_LEAD) for i in free]
        slack = sum(elements[i].length - floor for i, floor in zip(free, least, strict=True))
        if slack < -missing:
            return elements if now < asked.hi - 1 else None
        keep = 1 + missing / slack
        lengths = [floor + keep * (elements[i].length - floor) for i, floor in zip(free, least, strict=True)]
    out = list(elements)
    for i, length in zip(free, lengths, strict=True):
        out[i] = out[i]._replace(straight=length)
    return out


def _least(elements: Sequence[Element], index: int, lead: float) -> float:
    least = lead
    if 0 < index < len(elements) - 1:
        is_same = elements[index - 1].turn * elements[index + 1].turn > 0
        least = SEPARATE if is_same else FEWEST_METRES
    required = elements[index].required_length
    if required:
        least = max(least, inside(required.lo), CHANGE)
    return min(least, elements[index].length)
