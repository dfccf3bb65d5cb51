"""Finds contradictions and impossible requirements in a Brief before a road is designed, and says what to
change.
"""

from math import inf
from typing import NamedTuple

from roadgpt.brief.amount import meets
from roadgpt.brief.map_fit import ROAD_WIDTH, check_room, least_length
from roadgpt.brief.model import Amount, Brief, Clause, Slope, exactly, span
from roadgpt.brief.normal import BUMPS, SINGLE, STRAIGHT, clauses_turn, normal, total, turns_of
from roadgpt.brief.part_climb import check_climb
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import (
    COUNTS,
    FIGURE_WINS,
    KINDS,
    LEAST_GRADE,
    LEAST_RADIUS,
    LEAST_STRAIGHT,
    LENGTH_SLACK,
    LONGEST_ROAD,
    MOST_LANES,
    ROAD_LENGTH_SLACK,
    SHARPNESS,
    SLOPES,
    STEEPEST,
    TURNING_SLACK,
    USUAL_MAP,
)
from roadgpt.errors import BriefError

LARGEST_ANGLE = 240.0  # degrees; a longer turn would cross its own beginning
SMALLEST_ANGLE = 10.0  # degrees; a smaller turn is measured as straight
SHORTEST_ROAD = 20.0  # metres
MOST_TURNS = 400.0
MOST_TURNING = 3000.0  # degrees of all turns together
GRADES = {slope: meaning.grade or Range() for slope, meaning in SLOPES.items()}
RISING = tuple(slope for slope, grade in GRADES.items() if grade.lo > 0)
FALLING = tuple(slope for slope, grade in GRADES.items() if grade.hi < 0)
LEVEL = tuple(slope for slope, grade in GRADES.items() if 0 in grade)


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
    """Checks, from the numbers of a Brief alone, whether some road could satisfy the Brief.

    For a route with junctions, each junction, each road and the sequence of lanes are checked. Whether a
    route or a network of roads (``brief.map``) fits into the square map is not checked.

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
    if brief.junctions or brief.map is not None:
        from roadgpt.brief.junction_check import check_network  # only for networks

        check_network(brief)
        for stretch in brief.stretches:
            check(stretch, None, min_radius, max_grade, road_width)
        return
    _lanes(brief)
    _counts(brief)
    _limits_of_every_turn(brief)
    brief = normal(brief)
    limits = _Limits(min_radius, min(100 * max_grade, STEEPEST))
    for clause in (*brief.clauses, *brief.both_ends):
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
    """Returns whether ``check`` finds nothing wrong with a Brief; the arguments are those of ``check``."""
    try:
        check(brief, map_size, min_radius, max_grade)
    except BriefError:
        return False
    return True


def _lanes(brief: Brief) -> None:
    if not meets(brief.lanes, Range(1, MOST_LANES)):
        raise BriefError(
            f"a road has 1 to {MOST_LANES} lanes in each direction, not {brief.lanes}; change it"
        )
    if not meets(brief.against, Range(0, MOST_LANES)):
        raise BriefError(f"a road has 0 to {MOST_LANES} oncoming lanes, not {brief.against}; change it")
    if brief.against is not None and span(brief.against).hi == 0 and (brief.divided or brief.centre):
        raise BriefError("a one-way road has no oncoming lanes; leave its median or centre line out")


def _counts(brief: Brief) -> None:
    counted = [(clause.count, f"{_noun(clause)}s") for clause in brief.clauses]
    whole = [(getattr(brief, name), f"{noun}s") for name, noun in COUNTS.items()]
    for amount, nouns in (*counted, *whole):
        for number in (amount.lo, amount.hi) if amount else ():
            if number is not None and (number < 0 or number != int(number)):
                raise BriefError(f"a road cannot have {number:g} {nouns}; ask for a whole number")
    for clause in brief.clauses:
        if 0 in (clause.count.lo, clause.count.hi):
            raise BriefError(f"a clause cannot ask for 0 {_noun(clause)}s; leave it out")


def _limits_of_every_turn(brief: Brief) -> None:
    """Checks that no turn has a figure beyond a limit that holds for all turns."""
    for name, noun, unit in (("radius", "a radius", "m"), ("degrees", "an angle", "degrees")):
        limit: Amount | None = getattr(brief, name)
        if limit is None or None not in (limit.lo, limit.hi):
            continue
        for clause in brief.clauses:
            if clause.kind in STRAIGHT:
                continue
            own = getattr(clause, name)
            meant = span(own) if own else _meant(clause, name)
            if _exclude(meant, span(limit)):
                raise BriefError(
                    f"every turn must have {noun} of {limit} {unit}, but a {_noun(clause)} has"
                    f" {own or meant} {unit}; leave out one of the two"
                )


def _meant(clause: Clause, name: str) -> Range | None:
    """Returns the range of radii or degrees that the words for a turn imply; None if they imply no range."""
    own: Range | None = getattr(KINDS[clause.kind], name)
    if clause.kind == "turn":
        sharp = SHARPNESS[clause.sharpness] if clause.sharpness else None
        return sharp.radius if sharp and name == "radius" else None
    return own


def _shape(clause: Clause, limits: _Limits) -> None:
    noun, least = _noun(clause), limits.min_radius
    radius, length = span(clause.radius).hi, span(clause.length).hi
    if radius * (1 + LENGTH_SLACK) < least:
        raise BriefError(f"a radius of {radius:g} m is too tight to drive; ask for {least:g} m or more")
    _angle(clause, noun)
    _radius(clause, noun)
    _incline(clause.slope, clause.incline, limits)
    check_climb(clause, limits.steepest)
    if length < 1:
        raise BriefError(f"a {noun} of {length:g} m is too short; ask for {LEAST_STRAIGHT:g} m or more")


def _angle(clause: Clause, noun: str) -> None:
    degrees = span(clause.degrees)
    if degrees.lo > LARGEST_ANGLE:
        raise BriefError(
            f"a turn of {degrees.lo:g} degrees would cross itself; ask for {LARGEST_ANGLE:g} or less"
        )
    if degrees.hi < SMALLEST_ANGLE:
        raise BriefError(
            f"a turn of {degrees.hi:g} degrees is practically straight; ask for {SMALLEST_ANGLE:g} or more"
        )
    own = KINDS[clause.kind].degrees
    if clause.kind in ("hairpin", "switchback", "u_turn") and own and degrees.hi * 1.1 < own.lo:
        raise BriefError(
            f"a {noun} turns {own.lo:g} degrees or more; ask for a turn of {degrees.hi:g} degrees instead"
        )


def _radius(clause: Clause, noun: str) -> None:
    asked, sharpness = span(clause.radius), clause.sharpness
    radius = Range(asked.lo * (1 - LENGTH_SLACK), asked.hi * (1 + LENGTH_SLACK))
    limits = SHARPNESS[sharpness].radius if sharpness else None
    own = KINDS[clause.kind].radius
    if limits and _exclude(radius, Range(FIGURE_WINS * limits.lo, limits.hi / FIGURE_WINS)):
        raise BriefError(
            f"a {sharpness} turn has a radius of {limits} m; leave out '{sharpness}', or the number"
        )
    if _exclude(radius, own):
        raise BriefError(f"a {noun} has a radius of {own} m; ask for a turn with this radius instead")
    if _exclude(own, limits):
        raise BriefError(
            f"a {noun} has a radius of {own} m and is never {sharpness}; leave out '{sharpness}'"
        )


def _exclude(one: Range | None, other: Range | None) -> bool:
    """Returns whether no number is in both ranges."""
    both = overlap(one, other)
    return both is not None and both.lo > both.hi


def _incline(slope: Slope | None, incline: Amount | None, limits: _Limits) -> None:
    least = span(incline).lo
    if least > limits.steepest:
        raise BriefError(
            f"a slope of {least:g} percent is too steep; ask for {limits.steepest:g} percent or less"
        )
    if slope in LEVEL and least > GRADES[slope].hi:
        raise BriefError(f"a level road cannot have a slope of {least:g} percent; leave out one of the two")


def _number_of_turns(brief: Brief) -> None:
    said, asked = total(brief.clauses), span(brief.turns)
    if clauses_turn(brief.clauses):
        if asked.hi == 0:
            raise BriefError(f"{_many(said, 'turn')} and no turns are asked for: leave out one of the two")
        if _exclude(span(said), asked):
            raise BriefError(
                f"the description names {_many(said, 'turn')}, but asks for {brief.turns} in all;"
                " make the numbers agree"
            )
    has_sides = brief.alternating or span(brief.left).lo > 0 or span(brief.right).lo > 0
    if asked.hi == 0 and (has_sides or clauses_turn(brief.both_ends)):
        raise BriefError("turns and no turns are asked for: leave out one of the two")
    if max(span(said).lo, asked.lo) > MOST_TURNS:
        raise BriefError(f"no map holds so many turns; ask for {MOST_TURNS:g} or fewer")


def _turning(brief: Brief) -> None:
    """Checks the sum of all angles against the smallest and largest sum that the turns can have."""
    if brief.turning is None:
        return
    asked, turns = span(brief.turning), span(brief.turns)
    if asked.lo > MOST_TURNING:
        raise BriefError(f"no map holds {asked.lo:g} degrees of turning; ask for less")
    if turns.hi == 0:
        raise BriefError("degrees of turning and no turns are asked for: leave out one of the two")
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    if turning:
        spans = [(turns_of(clause), _degrees_of(clause, brief.degrees)) for clause in turning]
        least = sum(count[0] * degrees.lo for count, degrees in spans)
        most = sum(count[1] * degrees.hi for count, degrees in spans)
    else:
        least = (max(turns.lo, 0) if brief.turns else 1) * SMALLEST_ANGLE
        most = LARGEST_ANGLE * turns.hi
    if asked.hi * (1 + TURNING_SLACK) < least:
        raise BriefError(
            f"the turns add up to {least:g} degrees or more, but {asked.hi:g} are asked for;"
            " ask for fewer turns or for more degrees"
        )
    if asked.lo * (1 - TURNING_SLACK) > most:
        raise BriefError(
            f"the turns add up to {most:g} degrees at most, but {asked.lo:g} are asked for;"
            " ask for more turns or for fewer degrees"
        )


def _degrees_of(clause: Clause, each: Amount | None) -> Range:
    """Returns the angles that one turn of a clause may have, with tolerance, in degrees."""
    possible, said = Range(SMALLEST_ANGLE, LARGEST_ANGLE), clause.degrees or each
    if said is None:
        return KINDS[clause.kind].degrees or possible
    low, high = span(said).lo * (1 - TURNING_SLACK), span(said).hi * (1 + TURNING_SLACK)
    return Range(low if low > -inf else possible.lo, high if high < inf else possible.hi)


def _sides(brief: Brief) -> None:
    """Checks that the numbers of left and right turns can add up to the number of all turns."""
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    turns = span(total(turning) if turning else brief.turns)
    least = 0.0
    for amount, side in ((brief.left, "left"), (brief.right, "right")):
        wished, sure = span(amount), sum(_sure(clause, side) for clause in turning)
        least += max(wished.lo, sure, 0)
        if sure > wished.hi:
            raise BriefError(
                f"the description names {_many(exactly(sure), f'{side} turn')}, but asks for"
                f" {amount}; make the numbers agree"
            )
        if wished.lo > turns.hi:
            raise BriefError(
                f"{wished.lo:g} {side} turns are more than the {turns.hi:g} turns in all; ask for fewer"
            )
    most = span(brief.left).hi + span(brief.right).hi
    if most == 0 and (turning or turns.lo > 1):
        raise BriefError(
            "turns are asked for, but none to the left and none to the right: allow one of the two"
        )
    if least > turns.hi:
        raise BriefError(
            f"{least:g} left and right turns are more than the {turns.hi:g} turns in all; ask for fewer"
        )
    if most < turns.lo:
        raise BriefError(f"{most:g} left and right turns do not add up to {turns.lo:g} turns; ask for more")


def _sure(clause: Clause, side: str) -> float:
    """Returns the least number of turns of a clause that go to this side."""
    least, _ = turns_of(clause)
    if (KINDS[clause.kind].alternating and clause.kind != "switchback") or clause.alternating:
        return least // 2
    if clause.kind == "switchback" and least > 1:
        return least // 2
    return least if clause.side == side and clause.kind in SINGLE | {"winding"} else 0


def _slopes(brief: Brief, limits: _Limits) -> None:
    climb, steepest = span(brief.climb), span(brief.steepest)
    _incline(brief.slope, brief.incline, limits)
    _incline(None, brief.steepest, limits)
    for clause in (*brief.clauses, *brief.both_ends):
        _slope_within(brief, clause)
    asked = max([span(brief.incline).lo, *(span(clause.incline).lo for clause in brief.clauses)])
    if asked > steepest.hi:
        raise BriefError(
            f"{asked:g} percent are asked for, but {steepest.hi:g} at the steepest place;"
            " leave out one of the two"
        )
    if brief.slope and span(brief.hills).lo > 0:
        raise BriefError("a hilly road climbs and falls; leave out that it is all uphill, downhill or flat")
    if (brief.slope in RISING and climb.hi < 0) or (brief.slope in FALLING and climb.lo > 0):
        raise BriefError("the slope goes one way and the height of the end the other; make them agree")
    if brief.slope == "flat" and (climb.lo > 10 or climb.hi < -10):
        raise BriefError("a flat road cannot gain or lose that much height; leave out one of the two")
    if brief.slope and not brief.incline:
        usual = min(abs(GRADES[brief.slope].lo), abs(GRADES[brief.slope].hi))
        least = FIGURE_WINS * usual if brief.slope.startswith("steeply") else LEAST_GRADE
        if brief.slope not in LEVEL and steepest.hi < least:
            raise BriefError(
                f"such a slope is {least:g} percent or more; allow the steepest place to be that steep"
            )
        if steepest.lo > 4 and brief.slope in LEVEL:
            raise BriefError("a level road cannot have a steep place; leave out one of the two")


def _slope_within(brief: Brief, clause: Clause) -> None:
    whole, slope = brief.slope, clause.slope
    if whole is None:
        return
    name = clause.kind.replace("_", "-")
    if clause.kind in BUMPS:
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
    most = span(brief.length).hi
    least, longest = least_length(brief, limits.min_radius), most * (1 + ROAD_LENGTH_SLACK)
    if longest < SHORTEST_ROAD:
        raise BriefError(f"a road of {most:g} m is too short; ask for {SHORTEST_ROAD:g} m or more")
    if least > longest:
        raise BriefError(f"{most:g} m is too short for all that; ask for {least:.0f} m or for fewer turns")
    if max(least, span(brief.length).lo * (1 - ROAD_LENGTH_SLACK)) > LONGEST_ROAD:
        raise BriefError(f"no road is longer than {LONGEST_ROAD:g} m; ask for a shorter one")
    climb, grade = span(brief.climb), min(limits.steepest, span(brief.steepest).hi)
    for way, height in (("climb", climb.lo), ("fall", -climb.hi)):
        if height > longest * grade / 100:
            raise BriefError(f"{most:g} m of road cannot {way} {height:g} m; ask for a longer road")
        if height > LONGEST_ROAD * grade / 100:
            raise BriefError(f"{LONGEST_ROAD:g} m of road cannot {way} {height:g} m; ask for less height")


def _many(amount: Amount, noun: str) -> str:
    return f"{amount} {noun}" + ("" if amount == exactly(1) else "s")


def _noun(clause: Clause) -> str:
    return KINDS[clause.kind].names[0]


def _said(slope: Slope) -> str:
    return SLOPES[slope].names[0]
