"""Converts a Brief to an Outline: ranges for values that can be measured on the finished geometry.

Designers aim for values inside the ranges of an Outline, and the rule ``promises`` compares a finished road
with them. All numbers are in the units of ``words.py`` (degrees, metres, percent with uphill positive), and
are measured as in ``check.measures``."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any, Literal, TypeVar

from roadgpt.brief.amount import about
from roadgpt.brief.design_speed import SpeedLimits, limits_at
from roadgpt.brief.map_fit import has_low_grades, has_wide_turns
from roadgpt.brief.model import Amount, Brief, Clause, span
from roadgpt.brief.normal import BUMPS, clauses_turn, turns_of, with_continued_grades, with_like_numbers
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import (
    FEATURE,
    FIGURE_WINS,
    KINDS,
    LEAST_GRADE,
    LEAST_STRAIGHT,
    MOTORWAY_GRADE,
    MOTORWAY_RADIUS,
    OVER,
    ROAD,
    SHARPNESS,
    SIZES,
    SLOPES,
    STEEPEST,
    Quantity,
    heading_from,
)
from roadgpt.language.names import Bump, Kind, Side, Slope

SMALLEST_TURN = 12.0  # degrees; a bend of less than 10 is not measured as a turn
SMALLEST_OF_MOST = 0.6  # "turns of at most 20 degrees" have at least this share of the 20 degrees
LARGEST_TURN = 270.0  # degrees, if only a lower bound was given
USUALLY_WIDEST = 300.0  # metres: a wider bend is not a turn, unless such turns are asked for
ROOMY = 150.0  # metres: a map of this side holds a sweeping turn of 60 m radius with its straights
EASIER = 0.75  # the usual grades of a word are kept if the least of them is at most this share of a limit
WIDER, WIDER_THAN_MOST, WIDER_OF_SPEED = 1.5, 1.1, 1.8
"""Ratios to the least and to the greatest radius that is asked for, and to the least one of a design speed; a
wider bend is not a turn."""
USUALLY_STEEPEST = 12.0  # percent, of a part whose height is given and whose length and grade are open
BUMP_SLOPES: Mapping[Kind, tuple[Slope, Slope]] = {"crest": ("up", "down"), "dip": ("down", "up")}
STRAIGHT_ON = Clause(kind="straight")
TOGETHER = {name: kind.names[0] for name, kind in KINDS.items() if kind.turns and kind.turns.lo > 1}
"""The kinds that consist of several turns, with their names; the turns share the height of the clause."""
NO_LIMIT = Range()
Sloped = TypeVar("Sloped", Brief, Clause)


@dataclass(frozen=True, slots=True)
class Feature:
    """A required turn or straight; a field that is None sets no requirement."""

    kind: Literal["turn", "straight"]
    name: str
    """The name of the feature in messages, such as 'hairpin'."""
    side: Side | None = None
    degrees: Range | None = None
    radius: Range | None = None
    length: Range | None = None
    grade: Range | None = None
    climb: Range | None = None
    """How many metres the feature rises from its start to its end; negative if it falls."""
    bump: Bump | None = None
    """What lies in the middle half of a turn; ``grade`` and ``climb`` are then those of its first slope."""

    @property
    def slopes(self) -> "tuple[Feature, Feature]":
        """The requirements for the two slopes of ``bump``, each of which is measured like a straight."""
        first = Feature(
            "straight", "straight", length=Range(LEAST_STRAIGHT), grade=self.grade, climb=self.climb
        )
        grade, climb = (span and span.negative for span in (self.grade, self.climb))
        return first, replace(first, grade=grade, climb=climb)

    def limits(self, *more: str) -> str:
        """Returns the requirements as text, such as ': to the left, 25 to 120 degrees'; empty if there are
        none. The texts in ``more`` are added at the end."""
        spans = {name: getattr(self, name) for name in FEATURE}
        if self.kind == "straight":
            del spans["degrees"]
        said = [f"to the {self.side}"] if self.side else []
        said += [FEATURE[name].asked.format(span) for name, span in spans.items() if span]
        said += [OVER[self.bump]] if self.bump else []
        said += more
        return ": " + ", ".join(said) if said else ""


def both(one: Feature, other: Feature) -> Feature:
    """Returns a feature with the requirements of two features; ranges are intersected and may become
    empty. The result has the name of the second feature if the first name is only its kind."""
    name = other.name if one.name == one.kind else one.name
    ranges: dict[str, Any] = {name: overlap(getattr(one, name), getattr(other, name)) for name in FEATURE}
    return replace(one, name=name, side=one.side or other.side, bump=one.bump or other.bump, **ranges)


@dataclass(frozen=True, slots=True)
class Group:
    """``lo`` to ``hi`` equal features in a row; ``hi`` is None if there is no upper limit."""

    feature: Feature
    lo: int = 1
    hi: int | None = 1
    alternating: bool = False
    """True if the features alternate between left and right; ``feature.side`` is then the direction of the
    first."""

    @property
    def counted(self) -> str:
        """The number and kind of the features, such as '2 or more hairpins' or '4 serpentine turns'."""
        noun = self.feature.name + (" turn" if self.feature.name in TOGETHER.values() else "")
        return f"{Range(self.lo, inf if self.hi is None else self.hi)} {noun}{'' if self.hi == 1 else 's'}"

    def __str__(self) -> str:
        sides = ["alternating sides"] if self.alternating else []
        return self.counted + self.feature.limits(*sides)


@dataclass(frozen=True, slots=True)
class Outline:
    """All requirements of a Brief for one road, as ranges for measurable values; None sets no requirement."""

    groups: tuple[Group, ...]
    """The features in driving order; if any feature is a turn, the groups name all turns of the road."""
    turns: Range
    left: Range = NO_LIMIT
    right: Range = NO_LIMIT
    alternating: bool = False
    each_turn: Feature = Feature("turn", "turn")
    """Limits for every turn, in addition to those of its group."""
    grade: Literal["up", "down", "flat"] | None = None
    """The slope of the whole road: 'up' means that every stretch of 20 m rises, 'down' that every one falls,
    'flat' that all grades are between -1 and 1 percent."""
    grade_range: Range | None = None
    """Range in percent: for the mean grade of the whole road if ``grade`` is 'up' or 'down', else for the
    grade at every place."""
    turning: Range | None = None
    """The range of the sum of the angles of all turns, in degrees."""
    steepest: Range | None = None
    climb: Range | None = None
    hills: Range | None = None
    length: Range | None = None
    radius: Range | None = None
    """The range of the radius at the tightest place of the road, in metres; ``outline`` never sets it."""
    starts: Feature | None = None
    ends: Feature | None = None
    alike: bool = False
    """Whether turns of one name must be equal, and straights equally long; see ``Brief.alike``."""
    hard: bool = False
    speed: SpeedLimits | None = None
    """What the design speed requires; its least radius is also that of ``each_turn``."""
    heading: float | None = None
    """The heading at the start, in degrees counter-clockwise from east; only of roads that have a place."""

    @property
    def widest(self) -> float:
        """The largest radius in metres at which a bend of this road counts as a turn."""
        ends = (end for end in (self.starts, self.ends) if end)
        features = (self.each_turn, *(group.feature for group in self.groups), *ends)
        radii = [feature.radius for feature in features if feature.radius]
        most = [WIDER_THAN_MOST * radius.hi for radius in radii if radius.hi < inf]
        fast = [WIDER_OF_SPEED * self.speed.radius] if self.speed else []
        return max([USUALLY_WIDEST, *most, *fast, *(WIDER * radius.lo for radius in radii)])

    @property
    def names_all_turns(self) -> bool:
        """True if the groups name every turn of the road in order."""
        return any(group.feature.kind == "turn" for group in self.groups) or self.turns.hi == 0


def outline(brief: Brief, map_size: float = inf) -> Outline:
    """Returns the Outline of a Brief.

    Args:
        brief: the requirements.
        map_size: side of the map in metres. On a map of less than 150 m, sweeping turns only need a radius of
            40 m, as gentle turns do; a motorway gets wide turns only if the map can hold them."""
    roomy = map_size >= ROOMY
    brief = _with_figures_first(with_like_numbers(brief))
    groups = tuple(
        _merged(group for clause in without_joints(brief.clauses) for group in _groups(clause, roomy))
    )
    grade, grade_range = _whole_grade(brief)
    whole: dict[str, Any] = {
        name: _near(getattr(brief, name), row) for name, row in ROAD.items() if name != "radius"
    }
    whole["hills"] = _count(brief.hills) if brief.hills else None
    if grade is None and grade_range:  # nearly flat: the limit holds at every place
        whole["steepest"] = overlap(
            whole["steepest"], Range(0, max(abs(grade_range.lo), abs(grade_range.hi)))
        )
    found = Outline(
        groups=groups,
        turns=_turn_count(brief, groups),
        left=_count(brief.left),
        right=_count(brief.right),
        alternating=brief.alternating,
        each_turn=_turn(
            Clause(kind="turn", sharpness=brief.sharpness, degrees=brief.degrees, radius=brief.radius),
            roomy,
            angle_is_free=True,
        ),
        grade=grade,
        grade_range=grade_range,
        **whole,
        starts=_groups(brief.starts, roomy)[0].feature if brief.starts else None,
        ends=_last(brief.ends, roomy) if brief.ends else None,
        alike=brief.alike,
        hard=brief.hard,
        heading=heading_from(brief.comes_from) if brief.comes_from else None,
    )
    found = _with_both_ends(found)
    if has_low_grades(brief):
        found = replace(found, steepest=overlap(found.steepest, Range(0, MOTORWAY_GRADE)))
    limits = limits_at(brief.speed) if brief.speed else None
    least = [MOTORWAY_RADIUS] if has_wide_turns(brief, map_size) else []
    for radius in (*least, *([limits.radius] if limits else [])):
        wide = overlap(found.each_turn.radius, Range(radius))
        found = replace(found, each_turn=replace(found.each_turn, radius=wide))
    return replace(found, speed=limits)


def _with_both_ends(found: Outline) -> Outline:
    """Returns the Outline with two turns or more if the first and the last turn cannot be the same one."""
    first, last = found.starts, found.ends
    if found.names_all_turns or first is None or last is None or "straight" in (first.kind, last.kind):
        return found
    shared = [overlap(getattr(first, name), getattr(last, name)) for name in ("degrees", "radius", "grade")]
    sides = {first.side, last.side} - {None}
    if len(sides) < 2 and all(span is None or span.lo <= span.hi for span in shared):
        return found
    return replace(found, turns=Range(max(found.turns.lo, 2), found.turns.hi))


def _with_figures_first(brief: Brief) -> Brief:
    """Replaces the usual grades of a word for a slope if a number in the Brief requires lower ones.

    "Uphill" usually means 3 to 12 percent. "Uphill, at most 2 percent" means 1 to 2 percent. "Uphill, 6 m
    over 300 m" also allows the 2 percent that follow from these numbers. "Uphill, 6 m" allows 1 to 12
    percent, since the length of the road is open."""
    most = span(brief.steepest).hi
    clauses = tuple(_within(clause, most) for clause in with_continued_grades(brief.clauses))
    brief = _within(brief.model_copy(update={"clauses": clauses}), most)
    usual = SLOPES[brief.slope].grade if brief.slope and not brief.incline else None
    height, metres = _near(brief.climb, ROAD["climb"]), _near(brief.length, ROAD["length"])
    if usual is None or 0 in usual or height is None:
        return brief
    low, high = sorted((abs(usual.lo), abs(usual.hi)))
    mean = 100 * min(abs(height.lo), abs(height.hi)) / metres.hi if metres else 0.0
    return brief.model_copy(update={"incline": Amount(lo=min(max(mean, LEAST_GRADE), low), hi=high)})


def _within(said: Sloped, most: float) -> Sloped:
    """Returns a Brief or a clause with an incline of ``most`` percent or less, if its slope has no number of
    its own and the usual grades of the slope are too close to ``most`` or above it; else unchanged."""
    usual = SLOPES[said.slope].grade if said.slope and not said.incline else None
    if said.slope is None or usual is None or 0 in usual:
        return said
    least = min(abs(usual.lo), abs(usual.hi))
    if least <= EASIER * most or (said.slope.startswith("steeply") and most < FIGURE_WINS * least):
        return said
    return said.model_copy(update={"incline": Amount(lo=max(most / 2, LEAST_GRADE), hi=most)})


def _groups(clause: Clause, roomy: bool) -> list[Group]:
    if clause.kind in BUMPS:
        one = [Group(_straight(slope)) for slope in slopes_of_bump(clause)]
        return int(max(span(clause.count).lo, 1)) * one
    if clause.kind == "straight":
        return [Group(_straight(clause))]
    lo, hi = turns_of(clause)
    meaning = KINDS[clause.kind]
    alternates = (clause.alternating or meaning.alternating) and hi > 1
    return [Group(_turn(clause, roomy), int(lo), None if hi == inf else int(hi), alternates)]


def _turn(clause: Clause, roomy: bool, angle_is_free: bool = False) -> Feature:
    meaning = KINDS[clause.kind]
    degrees, radius = (None if angle_is_free else meaning.degrees), meaning.radius
    if clause.sharpness:
        sharpness = "gentle" if clause.sharpness == "sweeping" and not roomy else clause.sharpness
        radius = overlap(radius, SHARPNESS[sharpness].radius)
        if not meaning.own_angle:
            asked = SHARPNESS[sharpness].degrees or NO_LIMIT
            degrees = Range(asked.lo) if angle_is_free else asked
    if clause.degrees:
        degrees = _angle(clause.degrees)
    if clause.radius:
        radius = _near(clause.radius, FEATURE["radius"])
    length = _near(clause.length, FEATURE["length"])
    turn = Feature("turn", meaning.names[0], clause.side, degrees, radius, length)
    if clause.bump:
        slope = _straight(slopes_of_bump(clause)[0])
        length = sum_of(slope.length, slope.length)
        return replace(turn, length=length, grade=slope.grade, climb=slope.climb, bump=clause.bump)
    return _climbing(replace(turn, grade=_grade(clause.slope, clause.incline)), clause)


def _straight(clause: Clause) -> Feature:
    length = KINDS["straight"].length
    if clause.size:
        length = SIZES[clause.size].length
    if clause.length:
        length = _near(clause.length, FEATURE["length"])
    grade = _grade(clause.slope, clause.incline)
    asked = Feature("straight", "straight", None, KINDS["straight"].degrees, None, length, grade)
    return _climbing(asked, clause)


def climb_of_each(clause: Clause) -> Amount | None:
    """Returns how many metres each single turn or straight of a clause rises or falls; None if the clause
    asks for no height. The turns of an S-bend share its height equally."""
    if clause.climb is None or clause.kind not in TOGETHER:
        return clause.climb
    turns = KINDS[clause.kind].turns
    share = turns.lo if turns else 1.0
    if not KINDS[clause.kind].whole:
        share = max(share, span(clause.count).lo)
    return clause.climb.times(1 / share)


def slopes_of_bump(clause: Clause) -> list[Clause]:
    """Returns the two slopes of a crest or a dip, which may lie in a turn: each has the whole height, and
    half of the length."""
    length, ways = clause.length and clause.length.times(0.5), BUMP_SLOPES[clause.bump or clause.kind]
    return [clause.model_copy(update={"slope": way, "length": length}) for way in ways]


def without_joints(clauses: tuple[Clause, ...]) -> list[Clause]:
    """Leaves out each crest between a climbing and a falling straight, and each dip between a falling and a
    climbing straight: such a crest or dip is only the place where the straights meet. A crest or dip with
    requirements of its own stays."""
    around = zip((STRAIGHT_ON, *clauses), clauses, (*clauses[1:], STRAIGHT_ON), strict=False)
    return [clause for before, clause, after in around if not _is_joint(before, clause, after)]


def _is_joint(before: Clause, clause: Clause, after: Clause) -> bool:
    if clause != Clause(kind=clause.kind) or not before.kind == after.kind == "straight":
        return False
    slopes = tuple((each.slope or "").rpartition("_")[2] for each in (before, after))
    return slopes == BUMP_SLOPES.get(clause.kind)


def sum_of(one: Range | None, other: Range | None) -> Range | None:
    """Returns the range of the length, or of the height, of two straights that are measured as one."""
    if one is None or other is None:
        return one or other
    number = one.number + other.number if one.number is not None and other.number is not None else None
    return Range(one.lo + other.lo, one.hi + other.hi, number)


def limits_of_climb(
    climb: Range, length: Range | None, grade: Range | None, has_radius: bool
) -> tuple[Range | None, Range]:
    """Returns the ranges of length (metres) and grade (percent, positive) of a part of a given height.

    ``length`` and ``grade`` are the ranges that are asked for, or None. ``has_radius`` is True for a turn
    whose radius is given; the angle and the radius then determine the length."""
    allowed = grade or Range(LEAST_GRADE, STEEPEST)
    low, high = max(climb.lo, 0.0), climb.hi
    if length is None and not has_radius:
        least = 100 * low / min(allowed.hi, USUALLY_STEEPEST if grade is None else inf)
        most = 100 * high / allowed.lo if grade else inf
        number = 100 * climb.number / grade.number if grade and grade.number and climb.number else None
        length = Range(least, most, number)
    if length is None or length.lo <= 0:
        return length, allowed
    number = 100 * climb.number / length.number if climb.number and length.number else None
    implied = Range(100 * low / length.hi, 100 * high / length.lo, number)
    found = overlap(implied, allowed) or implied
    return length, found if found.lo <= found.hi else implied


def _climbing(feature: Feature, clause: Clause) -> Feature:
    """Returns a feature of a clause with the height that is asked of it, and the lengths and grades that are
    possible with it."""
    each = _near(climb_of_each(clause), FEATURE["climb"])
    if each is None:
        return feature
    given = None if clause.length is None and clause.size is None else feature.length
    size = _near(clause.incline, FEATURE["grade"])
    length, grade = limits_of_climb(each, given, size, has_radius=feature.radius is not None)
    if feature.kind == "straight":
        length = length and overlap(length, Range(LEAST_STRAIGHT))
    falls = (clause.slope or "up").endswith("down")
    each = replace(each, lo=max(each.lo, 0.0))  # "at most 2 m uphill" does not fall
    climb, grade = (each.negative, grade.negative) if falls else (each, grade)
    return replace(feature, length=length, grade=grade, climb=climb)


def _merged(groups: Iterable[Group]) -> list[Group]:
    """Merges neighbouring straights of the same grade, since a measurement cannot tell them apart."""
    out: list[Group] = []
    for group in groups:
        last = out[-1].feature if out else None
        if last and last.kind == group.feature.kind == "straight" and last.grade == group.feature.grade:
            length = sum_of(last.length, group.feature.length)
            climb = sum_of(last.climb, group.feature.climb)
            out[-1] = Group(replace(last, length=length, climb=climb))
        else:
            out.append(group)
    return out


def _last(clause: Clause, roomy: bool) -> Feature:
    """Returns the last feature of a clause; its side is open if the turns alternate."""
    group = _groups(clause, roomy)[-1]
    return replace(group.feature, side=None) if group.alternating else group.feature


def _grade(slope: Slope | None, incline: Amount | None) -> Range | None:
    """Returns a range in percent; a number takes precedence over 'steep' and gets its sign from the slope."""
    if incline is None:
        return SLOPES[slope].grade if slope else None
    size = _near(incline, FEATURE["grade"]) or NO_LIMIT
    size = overlap(size, Range(LEAST_GRADE, STEEPEST)) or size
    return size.negative if slope and slope.endswith("down") else size


def _whole_grade(brief: Brief) -> tuple[Literal["up", "down", "flat"] | None, Range | None]:
    span = _grade(brief.slope, brief.incline)
    if span is None:
        return None, None
    if brief.slope == "flat" and not brief.incline:
        return "flat", span
    if brief.slope == "nearly_flat" and not brief.incline:
        return None, span
    return ("down" if span.hi < 0 else "up"), span


def _turn_count(brief: Brief, groups: Sequence[Group]) -> Range:
    """Returns how many turns the road has.

    These are the turns of the groups if any group turns, otherwise the number that was asked for; a road of
    straights alone has none."""
    turning = [group for group in groups if group.feature.kind == "turn"]
    wished = _count(brief.turns)
    if turning:
        most = inf if any(g.hi is None for g in turning) else sum(g.hi or 0 for g in turning)
        return overlap(Range(sum(g.lo for g in turning), most), wished) or NO_LIMIT
    if brief.turns:
        return wished
    ends_turn = clauses_turn(brief.both_ends)
    sides = [_count(side) for side in (brief.left, brief.right) if side]
    if sides or ends_turn or brief.hard:
        return Range(max(sum(max(side.lo, 0) for side in sides), 1 if ends_turn or brief.hard else 0))
    return Range(0, 0) if groups else Range(1)


def _count(amount: Amount | None) -> Range:
    return Range(max(span(amount).lo, 0), span(amount).hi) if amount else NO_LIMIT


def _angle(amount: Amount) -> Range:
    """Returns the range of a turn's angle in degrees; an open end gets the limit of what can be driven."""
    near = _near(amount, FEATURE["degrees"]) or NO_LIMIT
    low = near.lo if near.lo > -inf else max(SMALLEST_TURN, SMALLEST_OF_MOST * near.hi)
    return Range(low, near.hi if near.hi < inf else max(LARGEST_TURN, near.lo), near.number)


def _near(amount: Amount | None, quantity: Quantity) -> Range | None:
    return None if amount is None else about(amount, quantity.slack)
