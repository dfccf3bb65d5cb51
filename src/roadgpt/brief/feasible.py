"""Finds contradictions and impossible requirements in a Brief before a road is designed, and says what to
change.
"""

from math import inf
from typing import NamedTuple

from roadgpt.brief.map_fit import ROAD_WIDTH, check_room
from roadgpt.brief.minimum_length import least_length
from roadgpt.brief.model import Amount, Brief, Clause, exactly
from roadgpt.brief.normal import SINGLE, STRAIGHT, normal, total, turns_of
from roadgpt.brief.words import (
    KINDS,
    LEAST_RADIUS,
    LEAST_STRAIGHT,
    LENGTH_SLACK,
    ROAD_LENGTH_SLACK,
    SHARPNESS,
    SLOPES,
    STEEPEST,
    TURNING_SLACK,
    USUAL_MAP,
    Range,
)
from roadgpt.errors import BriefError

LARGEST_ANGLE = 240.0  # degrees; a longer turn would cross its own beginning
SMALLEST_ANGLE = 10.0  # degrees; a smaller turn is measured as straight
SHORTEST_ROAD = 20.0  # metres
MOST_TURNS = 200.0
MOST_TURNING = 3000.0  # degrees of all turns together
RISING = ("up", "gently_up", "steeply_up")
FALLING = ("down", "gently_down", "steeply_down")
LEVEL = ("flat", "nearly_flat")


class _Limits(NamedTuple):
    min_radius: float
    """In metres."""
    steepest: float
    """In percent."""


def check(
    brief: Brief,
    map_size: float | None = USUAL_MAP,
    min_radius: float = LEAST_RADIUS,
    max_grade: float = STEEPEST / 100,
    road_width: float = ROAD_WIDTH,
) -> None:
    """Checks, from the numbers of a Brief alone, whether some road could satisfy it.

    Args:
        brief: the requirements; the Brief need not be in normal form.
        map_size: side of the square map in metres; None skips the check whether the road fits.
        min_radius: radius of the tightest turn allowed, in metres.
        max_grade: steepest slope allowed, as a ratio (0.15 is 15 %); values above 0.15 have no effect.
        road_width: width of the carriageway in metres.

    Raises:
        NoRoomError: the map is too small; a larger one may hold the road.
        BriefError: there is a contradiction or an impossible requirement; the message, one sentence, names
            the first one found.
    """
    for clause in brief.clauses:
        _counts(clause)
    _whole_counts(brief)
    brief = normal(brief)
    limits = _Limits(min_radius, min(100 * max_grade, STEEPEST))
    for clause in (*brief.clauses, *(c for c in (brief.starts, brief.ends) if c)):
        _shape(clause, limits)
    each = Clause(kind="turn", sharpness=brief.sharpness, degrees=brief.degrees, radius=brief.radius)
    _shape(each, limits)
    _number_of_turns(brief)
    _turning(brief)
    _sides(brief)
    _slopes(brief, limits)
    _length(brief, limits)
    if map_size is not None:
        check_room(brief, map_size, min_radius, road_width)


def is_possible(
    brief: Brief,
    map_size: float | None = USUAL_MAP,
    min_radius: float = LEAST_RADIUS,
    max_grade: float = STEEPEST / 100,
) -> bool:
    """Returns whether ``check`` finds nothing wrong with a Brief."""
    try:
        check(brief, map_size, min_radius, max_grade)
    except BriefError:
        return False
    return True


def _counts(clause: Clause) -> None:
    for number in (clause.count.lo, clause.count.hi):
        if number is not None and (number < 0 or number != int(number)):
            raise BriefError(f"a road cannot have {number:g} {_noun(clause)}s; ask for a whole number")
    if clause.count.hi == 0 or clause.count.lo == 0:
        raise BriefError(f"a clause cannot ask for 0 {_noun(clause)}s; leave it out")


def _whole_counts(brief: Brief) -> None:
    for amount, noun in ((brief.turns, "turns"), (brief.left, "left turns"), (brief.right, "right turns")):
        for number in (amount.lo, amount.hi) if amount else ():
            if number is not None and (number < 0 or number != int(number)):
                raise BriefError(f"a road cannot have {number:g} {noun}; ask for a whole number")


def _shape(clause: Clause, limits: _Limits) -> None:
    noun, least = _noun(clause), limits.min_radius
    if clause.radius and clause.radius.hi is not None and clause.radius.hi * (1 + LENGTH_SLACK) < least:
        raise BriefError(
            f"a radius of {clause.radius.hi:g} m is too tight to drive; ask for {least:g} m or more"
        )
    if clause.degrees:
        _angle(clause, noun)
    _radius(clause, noun)
    _incline(clause.slope, clause.incline, limits)
    if clause.length and clause.length.hi is not None and clause.length.hi < 1:
        raise BriefError(
            f"a {noun} of {clause.length.hi:g} m is too short; ask for {LEAST_STRAIGHT:g} m or more"
        )


def _angle(clause: Clause, noun: str) -> None:
    degrees = clause.degrees or exactly(90)
    if degrees.lo is not None and degrees.lo > LARGEST_ANGLE:
        raise BriefError(
            f"a turn of {degrees.lo:g} degrees would cross itself; ask for {LARGEST_ANGLE:g} or less"
        )
    if degrees.hi is not None and degrees.hi < SMALLEST_ANGLE:
        raise BriefError(
            f"a turn of {degrees.hi:g} degrees is practically straight; ask for {SMALLEST_ANGLE:g} or more"
        )
    own = KINDS[clause.kind].degrees
    bends_back = clause.kind in ("hairpin", "switchback", "u_turn")
    if bends_back and own and degrees.hi is not None and degrees.hi * 1.1 < own.lo:
        raise BriefError(
            f"a {noun} turns {own.lo:g} degrees or more; ask for a turn of {degrees.hi:g} degrees instead"
        )


def _radius(clause: Clause, noun: str) -> None:
    radius, sharpness = clause.radius, clause.sharpness
    limits = SHARPNESS[sharpness].radius if sharpness else None
    if radius and limits and not _overlaps(radius, limits, 0.15):
        raise BriefError(
            f"a {sharpness} turn has a radius of {limits} m; leave out '{sharpness}', or the number"
        )
    own = KINDS[clause.kind].radius
    if radius and own and not _overlaps(radius, own, 0.15):
        raise BriefError(f"a {noun} has a radius of {own} m; ask for a turn with this radius instead")
    if own and limits and max(own.lo, limits.lo) > min(own.hi, limits.hi):
        raise BriefError(
            f"a {noun} has a radius of {own} m and is never {sharpness}; leave out '{sharpness}'"
        )


def _overlaps(amount: Amount, limits: Range, slack: float) -> bool:
    low = amount.lo * (1 - slack) if amount.lo is not None else -inf
    high = amount.hi * (1 + slack) if amount.hi is not None else inf
    return low <= limits.hi and high >= limits.lo


def _incline(slope: str | None, incline: Amount | None, limits: _Limits) -> None:
    if incline is None:
        return
    _not_too_steep(incline, limits)
    if slope in LEVEL and (incline.lo or 0) > (1 if slope == "flat" else 3.5):
        raise BriefError(
            f"a level road cannot have a slope of {incline.lo:g} percent; leave out one of the two"
        )


def _not_too_steep(incline: Amount, limits: _Limits) -> None:
    if incline.lo is not None and incline.lo > limits.steepest:
        raise BriefError(
            f"a slope of {incline.lo:g} percent is too steep; ask for {limits.steepest:g} percent or less"
        )


def _number_of_turns(brief: Brief) -> None:
    said = total(brief.clauses)
    if any(clause.kind not in STRAIGHT for clause in brief.clauses) and brief.turns:
        if brief.turns.hi == 0:
            raise BriefError(f"{_many(said, 'turn')} and no turns are asked for: leave out one of the two")
        if not _meet(said, brief.turns):
            raise BriefError(
                f"the description names {_many(said, 'turn')}, but asks for {brief.turns} in all;"
                " make the numbers agree"
            )
    if brief.turns and brief.turns.hi == 0:
        ends = any(c and c.kind not in STRAIGHT for c in (brief.starts, brief.ends))
        sided = any(a and (a.lo or 0) > 0 for a in (brief.left, brief.right))
        if ends or sided or brief.alternating:
            raise BriefError("turns and no turns are asked for: leave out one of the two")
    if max(said.lo or 0, (brief.turns.lo or 0) if brief.turns else 0) > MOST_TURNS:
        raise BriefError(f"no map holds so many turns; ask for {MOST_TURNS:g} or fewer")


def _turning(brief: Brief) -> None:
    """Checks the sum of all angles against the smallest and largest sum that the turns can have."""
    if brief.turning is None:
        return
    if brief.turning.lo is not None and brief.turning.lo > MOST_TURNING:
        raise BriefError(f"no map holds {brief.turning.lo:g} degrees of turning; ask for less")
    if brief.turns and brief.turns.hi == 0:
        raise BriefError("degrees of turning and no turns are asked for: leave out one of the two")
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    if turning:
        spans = [(turns_of(clause), _degrees_of(clause, brief.degrees)) for clause in turning]
        least = sum(count[0] * degrees.lo for count, degrees in spans)
        most = sum(count[1] * degrees.hi for count, degrees in spans)
    else:
        turns = brief.turns or Amount(lo=1)
        least = (turns.lo or 0) * SMALLEST_ANGLE
        most = LARGEST_ANGLE * (inf if turns.hi is None else turns.hi)
    if brief.turning.hi is not None and brief.turning.hi * (1 + TURNING_SLACK) < least:
        raise BriefError(
            f"the turns add up to {least:g} degrees or more, but {brief.turning.hi:g} are asked for;"
            " ask for fewer turns or for more degrees"
        )
    if brief.turning.lo is not None and brief.turning.lo * (1 - TURNING_SLACK) > most:
        raise BriefError(
            f"the turns add up to {most:g} degrees at most, but {brief.turning.lo:g} are asked for;"
            " ask for more turns or for fewer degrees"
        )


def _degrees_of(clause: Clause, each: Amount | None) -> Range:
    """Returns the angles that one turn of a clause may have, with tolerance, in degrees."""
    said = clause.degrees or each
    own = KINDS[clause.kind].degrees or Range(SMALLEST_ANGLE, LARGEST_ANGLE)
    if said is None:
        return own
    low = SMALLEST_ANGLE if said.lo is None else said.lo * (1 - TURNING_SLACK)
    return Range(low, LARGEST_ANGLE if said.hi is None else said.hi * (1 + TURNING_SLACK))


def _sides(brief: Brief) -> None:
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    for wished, side in _sides_of(brief):
        if wished is None:
            continue
        sure = _named(turning, side)
        if wished.hi is not None and sure > wished.hi:
            raise BriefError(
                f"the description names {_many(exactly(sure), f'{side} turn')}, but asks for"
                f" {wished}; make the numbers agree"
            )
        most = total(brief.clauses) if turning else brief.turns
        if most and most.hi is not None and (wished.lo or 0) > most.hi:
            raise BriefError(
                f"{wished.lo:g} {side} turns are more than the {most.hi:g} turns in all; ask for fewer"
            )
    _both_sides(brief, turning)


def _both_sides(brief: Brief, turning: list[Clause]) -> None:
    """Lefts and rights must make up all turns, and no more."""
    both = [amount for amount in (brief.left, brief.right) if amount]
    turns = total(turning) if turning else brief.turns
    if (
        len(both) == 2
        and all(amount.hi == 0 for amount in both)
        and (turning or (turns and (turns.lo or 0) > 1))
    ):
        raise BriefError(
            "turns are asked for, but none to the left and none to the right: allow one of the two"
        )
    if not turns:
        return
    least = sum(max(a.lo or 0 if a else 0, _named(turning, s)) for a, s in _sides_of(brief))
    if turns.hi is not None and least > turns.hi:
        raise BriefError(
            f"{least:g} left and right turns are more than the {turns.hi:g} turns in all; ask for fewer"
        )
    most = sum(inf if amount.hi is None else amount.hi for amount in both)
    if len(both) == 2 and most < (turns.lo or 0):
        raise BriefError(f"{most:g} left and right turns do not add up to {turns.lo:g} turns; ask for more")


def _sides_of(brief: Brief) -> tuple[tuple[Amount | None, str], ...]:
    return ((brief.left, "left"), (brief.right, "right"))


def _named(turning: list[Clause], side: str) -> float:
    return sum(_sure(clause, side) for clause in turning)


def _sure(clause: Clause, side: str) -> float:
    """Returns how many turns of a clause must go to this side."""
    least, _ = turns_of(clause)
    if (KINDS[clause.kind].alternating and clause.kind != "switchback") or clause.alternating:
        return least // 2
    if clause.kind == "switchback" and least > 1:
        return least // 2
    return least if clause.side == side and clause.kind in SINGLE | {"winding"} else 0


def _slopes(brief: Brief, limits: _Limits) -> None:
    _incline(brief.slope, brief.incline, limits)
    if brief.steepest:
        _not_too_steep(brief.steepest, limits)
    for clause in (*brief.clauses, *(end for end in (brief.starts, brief.ends) if end)):
        _slope_within(brief, clause)
    if brief.slope and brief.hills and (brief.hills.lo or 0) > 0:
        raise BriefError("a hilly road climbs and falls; leave out that it is all uphill, downhill or flat")
    rises, falls = brief.slope in RISING, brief.slope in FALLING
    climb = brief.climb
    if climb and ((rises and climb.hi is not None and climb.hi < 0) or (falls and (climb.lo or 0) > 0)):
        raise BriefError("the slope goes one way and the height of the end the other; make them agree")
    if (
        climb
        and brief.slope == "flat"
        and ((climb.lo or 0) > 10 or (climb.hi is not None and climb.hi < -10))
    ):
        raise BriefError("a flat road cannot gain or lose that much height; leave out one of the two")
    steepest, grade = brief.steepest, SLOPES[brief.slope].grade if brief.slope else None
    if steepest and grade and not brief.incline:
        least = 0.0 if grade.lo <= 0 <= grade.hi else min(abs(grade.lo), abs(grade.hi))
        if steepest.hi is not None and steepest.hi < least - 1:
            raise BriefError(
                f"such a slope is {least:g} percent or more; allow the steepest place to be that steep"
            )
        if (steepest.lo or 0) > 4 and brief.slope in LEVEL:
            raise BriefError("a level road cannot have a steep place; leave out one of the two")


def _slope_within(brief: Brief, clause: Clause) -> None:
    whole, slope = brief.slope, clause.slope
    if whole is None:
        return
    name = clause.kind.replace("_", "-")
    if clause.kind in ("crest", "dip"):
        raise BriefError(f"a {name} climbs and falls; leave out that the whole road is {_said(whole)}")
    if slope is None:
        return
    up_and_down = (whole in RISING and slope in FALLING) or (whole in FALLING and slope in RISING)
    if up_and_down or (whole in LEVEL and slope in (*RISING, *FALLING)):
        raise BriefError(
            f"the whole road is {_said(whole)}, but a {name} is {_said(slope)};"
            " say the slope of each part instead"
        )


def _length(brief: Brief, limits: _Limits) -> None:
    if brief.length is None:
        return
    least = least_length(brief, limits.min_radius)
    longest = inf if brief.length.hi is None else brief.length.hi * (1 + ROAD_LENGTH_SLACK)
    if longest < SHORTEST_ROAD:
        raise BriefError(f"a road of {brief.length.hi:g} m is too short; ask for {SHORTEST_ROAD:g} m or more")
    if least > longest:
        raise BriefError(
            f"{brief.length.hi:g} m is too short for all that; ask for {least:.0f} m or for fewer turns"
        )
    for way, height in _heights(brief.climb):
        if height > longest * limits.steepest / 100:
            raise BriefError(
                f"{brief.length.hi:g} m of road cannot {way} {height:g} m; ask for a longer road"
            )


def _heights(climb: Amount | None) -> list[tuple[str, float]]:
    """Returns the verb and the height in metres that a road must climb or fall at least."""
    if climb is None:
        return []
    return [("climb", climb.lo or 0.0), ("fall", -(climb.hi or 0.0))]


def _meet(one: Amount, other: Amount) -> bool:
    low = max(one.lo or 0, other.lo or 0)
    high = min(inf if one.hi is None else one.hi, inf if other.hi is None else other.hi)
    return low <= high


def _many(amount: Amount, noun: str) -> str:
    return f"{amount} {noun}" + ("" if amount == exactly(1) else "s")


def _noun(clause: Clause) -> str:
    return KINDS[clause.kind].names[0]


def _said(slope: str) -> str:
    return SLOPES[slope].names[0]  # type: ignore[index]
