"""Finds contradictions and impossible requirements in a Brief before a road is designed, and says what to
change."""

from collections.abc import Iterator
from itertools import pairwise
from math import inf, radians

from roadgpt.brief.amount import meets
from roadgpt.brief.design_speed import SpeedLimits, limits_at
from roadgpt.brief.map_fit import ROAD_WIDTH, check_room, least_length
from roadgpt.brief.model import OTHER_SIDE, Amount, Brief, Clause, exactly, span
from roadgpt.brief.normal import BUMPS, SINGLE, STRAIGHT, clauses_turn, normal, total, turns_of
from roadgpt.brief.outline import outline, slopes_of_bump
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.scene_places import check_scene
from roadgpt.brief.sentence import clause_text, road_words
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
    OVER,
    PART_CLIMB_SLACK,
    PERCENT_SLACK,
    ROAD_LENGTH_SLACK,
    SHARPNESS,
    SLOPES,
    STEEPEST,
    TURNING_SLACK,
    USUAL_MAP,
)
from roadgpt.errors import BriefError
from roadgpt.language.names import Slope

LARGEST_ANGLE = 240.0  # degrees; a longer turn would cross its own beginning
SMALLEST_ANGLE = 10.0  # degrees; a smaller turn is measured as straight
SHORTEST_ROAD = 20.0  # metres
MOST_TURNS = 400.0
MOST_TURNING = 3000.0  # degrees of all turns together
GRADES = {slope: meaning.grade or Range() for slope, meaning in SLOPES.items()}
RISING = tuple(slope for slope, grade in GRADES.items() if grade.lo > 0)
FALLING = tuple(slope for slope, grade in GRADES.items() if grade.hi < 0)
LEVEL = tuple(slope for slope, grade in GRADES.items() if 0 in grade)


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
            the first one found."""
    is_network = bool(brief.junctions) or brief.map is not None
    if is_network:
        from roadgpt.brief.junction_check import faults_of_network  # only for networks

        faults = faults_of_network(brief)
    else:
        faults = _faults(brief, min_radius, min(100 * max_grade, STEEPEST))
    if fault := next(faults, ""):
        raise BriefError(fault)
    for stretch in brief.roads if brief.junctions else ():
        check(stretch, None, min_radius, max_grade, road_width)
    check_scene(brief.scene, brief)
    if map_size is not None and not is_network:
        check_room(normal(brief), map_size, min_radius, road_width)


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


def _faults(brief: Brief, min_radius: float, steepest: float) -> Iterator[str]:
    """Yields what is impossible or contradicts something else, as sentences that say what to change."""
    yield from _lanes(brief)
    yield from _counts(brief)
    yield from _limits_of_every_turn(brief)
    yield from _bumps(brief)
    brief = normal(brief)
    each = Clause(kind="turn", sharpness=brief.sharpness, degrees=brief.degrees, radius=brief.radius)
    for clause in (*brief.clauses, *brief.both_ends, each):
        yield from _shape(clause, min_radius, steepest)
    for look in (_number_of_turns, _turning, _sides):
        yield from look(brief)
    yield from _slopes(brief, steepest)
    yield from _length(brief, min_radius, steepest)
    if brief.speed is not None:
        yield from _design_speed(brief, limits_at(brief.speed))


def _lanes(brief: Brief) -> Iterator[str]:
    for amount, least, noun in (
        (brief.lanes, 1, "lanes in each direction"),
        (brief.against, 0, "oncoming lanes"),
    ):
        if not meets(amount, Range(least, MOST_LANES)):
            yield f"a road has {least} to {MOST_LANES} {noun}, not {amount}; change it"
    is_one_way = brief.against is not None and span(brief.against).hi == 0
    if is_one_way and bool(brief.divided or brief.centre):
        yield "a one-way road has no oncoming lanes; leave its median or centre line out"


def _counts(brief: Brief) -> Iterator[str]:
    counted = [(clause.count, f"{_noun(clause)}s") for clause in brief.clauses]
    whole = [(getattr(brief, name), f"{noun}s") for name, noun in COUNTS.items()]
    for amount, nouns in (*counted, *whole):
        for number in filter(None, (amount.lo, amount.hi) if amount else ()):
            if number < 0 or number != int(number):
                yield f"a road cannot have {number:g} {nouns}; ask for a whole number"
    for clause in brief.clauses:
        if 0 in (clause.count.lo, clause.count.hi):
            yield f"a clause cannot ask for 0 {_noun(clause)}s; leave it out"


def _bumps(brief: Brief) -> Iterator[str]:
    """Checks that each crest or dip inside a turn lies in a single turn that has no other slope."""
    for clause in (*brief.clauses, *brief.both_ends):
        if clause.bump and clause.kind not in SINGLE:
            singles = "only a turn, a hairpin, a switchback or a U-turn"
            yield f"{singles} can lead {OVER[clause.bump]}; name one in the place of '{_noun(clause)}'"
        if clause.bump and clause.slope:
            slope, over = SLOPES[clause.slope].names[0], OVER[clause.bump]
            yield f"a turn {over} goes up and down, so it is not {slope}; leave out one of the two"


def _limits_of_every_turn(brief: Brief) -> Iterator[str]:
    """Checks that no turn has a figure beyond a limit that holds for all turns."""
    for name in ("radius", "degrees"):
        limit: Amount | None = getattr(brief, name)
        if limit is None or None not in (limit.lo, limit.hi):
            continue
        for clause in brief.clauses:
            own = getattr(clause, name)
            meant: Range | None = span(own) if own else getattr(KINDS[clause.kind], name)
            if clause.kind == "turn" and not own:
                is_sharp = clause.sharpness and name == "radius"
                meant = SHARPNESS[clause.sharpness].radius if clause.sharpness and is_sharp else None
            if clause.kind not in STRAIGHT and _exclude(meant, span(limit)):
                every = Brief(turns=brief.turns, **{name: limit})
                yield f"'{road_words(every)}' contradicts '{clause_text(clause)}'; leave out one of the two"


def _shape(clause: Clause, min_radius: float, steepest: float) -> Iterator[str]:
    noun, least = _noun(clause), min_radius
    radius, length, degrees = span(clause.radius).hi, span(clause.length).hi, span(clause.degrees)
    if radius * (1 + LENGTH_SLACK) < least:
        yield f"a radius of {radius:g} m is too tight to drive; ask for {least:g} m or more"
    if degrees.lo > LARGEST_ANGLE:
        yield f"a turn of {degrees.lo:g} degrees would cross itself; ask for {LARGEST_ANGLE:g} or less"
    if degrees.hi < SMALLEST_ANGLE:
        yield f"a turn of {degrees.hi:g} degrees is practically straight; ask for {SMALLEST_ANGLE:g} or more"
    own = KINDS[clause.kind].degrees or Range()
    if clause.kind in ("hairpin", "switchback", "u_turn") and degrees.hi * 1.1 < own.lo:
        yield f"a {noun} turns {own.lo:g} degrees or more; ask for a turn of {degrees.hi:g} degrees instead"
    if length < 1:
        yield f"a {noun} of {length:g} m is too short; ask for {LEAST_STRAIGHT:g} m or more"
    if (clause.climb is not None and (clause.climb.lo or 0) < 0) or span(clause.climb).hi <= 0:
        yield f"a {noun} cannot rise or fall by {clause.climb} m; ask for more than 0 m, up or down"
    yield from _incline(clause.slope, clause.incline, steepest)
    if clause.bump and (metres := _arc(clause).hi) * (1 + LENGTH_SLACK) < 2 * LEAST_STRAIGHT:
        yield (
            f"a {noun} of {metres:.0f} m is too short for a {clause.bump}; ask for a wider one, or for "
            f"{2 * LEAST_STRAIGHT:g} m or more"
        )
    if not _is_radius_possible(clause) or not _is_climb_possible(clause, steepest):
        yield f"no road can have {clause_text(clause)}; leave out one of the words or numbers"


def _is_radius_possible(clause: Clause) -> bool:
    asked, own = span(clause.radius), KINDS[clause.kind].radius
    radius = Range(asked.lo * (1 - LENGTH_SLACK), asked.hi * (1 + LENGTH_SLACK))
    limits = (SHARPNESS[clause.sharpness].radius if clause.sharpness else None) or Range()
    usual = Range(FIGURE_WINS * limits.lo, limits.hi / FIGURE_WINS)
    return not (_exclude(radius, usual) or _exclude(radius, own) or _exclude(own, limits))


def _arc(clause: Clause) -> Range:
    """Returns the range of the lengths, in metres, that a turn of this clause can have."""
    degrees = span(clause.degrees) if clause.degrees else KINDS[clause.kind].degrees or Range()
    sharp = SHARPNESS[clause.sharpness].radius if clause.sharpness else None
    radius = span(clause.radius) if clause.radius else overlap(KINDS[clause.kind].radius, sharp) or Range()
    low, high = radians(max(degrees.lo, 0.0)), radians(min(degrees.hi, LARGEST_ANGLE))
    arc = Range(low * max(radius.lo, 0.0), high * radius.hi)
    return overlap(arc, span(clause.length)) or arc


def _is_climb_possible(clause: Clause, steepest: float) -> bool:
    """Returns whether the height of a clause in normal form goes with its slope, length and grade."""
    if clause.climb is None:
        return True
    slope = slopes_of_bump(clause)[0] if clause.kind in BUMPS else clause
    length, grade, height = span(slope.length), span(clause.incline), span(clause.climb)
    if clause.bump:
        length = Range(*(metres / 2 for metres in (_arc(clause).lo, _arc(clause).hi)))
    longest, least = length.hi * (1 + LENGTH_SLACK), height.lo * (1 - PART_CLIMB_SLACK)
    shortest, most = length.lo * (1 - LENGTH_SLACK), height.hi * (1 + PART_CLIMB_SLACK)
    is_too_steep = shortest > -inf and shortest * (grade.lo - PERCENT_SLACK) / 100 > most
    is_too_gentle = longest < inf and longest * (grade.hi + PERCENT_SLACK) / 100 < least
    is_wrong = clause.incline is not None and (is_too_steep or is_too_gentle)
    is_level = clause.slope in ("flat", "nearly_flat")
    return not is_level and least <= longest * steepest / 100 and not is_wrong


def _exclude(one: Range | None, other: Range | None) -> bool:
    both = overlap(one, other)
    return both is not None and both.lo > both.hi


def _incline(slope: Slope | None, incline: Amount | None, steepest: float) -> Iterator[str]:
    least = span(incline).lo
    if least > steepest:
        yield f"a slope of {least:g} percent is too steep; ask for {steepest:g} percent or less"
    if slope in LEVEL and least > GRADES[slope].hi:
        yield f"a level road cannot have a slope of {least:g} percent; leave out one of the two"


def _number_of_turns(brief: Brief) -> Iterator[str]:
    said, asked = total(brief.clauses), span(brief.turns)
    has_turns = clauses_turn(brief.clauses)
    has_sides = brief.alternating or span(brief.left).lo > 0 or span(brief.right).lo > 0
    many = f"{said} turn{'' if said == exactly(1) else 's'}" if has_turns else "turns"
    if asked.hi == 0 and (has_turns or has_sides or clauses_turn(brief.both_ends)):
        yield f"{many} and no turns are asked for: leave out one of the two"
    if has_turns and _exclude(span(said), asked):
        yield f"the description names {many}, but asks for {brief.turns} in all; make the numbers agree"
    if max(span(said).lo, asked.lo) > MOST_TURNS:
        yield f"no map holds so many turns; ask for {MOST_TURNS:g} or fewer"


def _turning(brief: Brief) -> Iterator[str]:
    """Checks the sum of all angles against the smallest and largest sum that the turns can have."""
    if brief.turning is None:
        return
    asked, turns = span(brief.turning), span(brief.turns)
    spans = [
        (turns_of(clause), _degrees_of(clause, brief.degrees))
        for clause in brief.clauses
        if clause.kind not in STRAIGHT
    ]
    least = sum(count[0] * degrees.lo for count, degrees in spans)
    most = sum(count[1] * degrees.hi for count, degrees in spans)
    if not spans:
        least = (max(turns.lo, 0) if brief.turns else 1) * SMALLEST_ANGLE
        most = LARGEST_ANGLE * turns.hi
    is_possible = asked.hi * (1 + TURNING_SLACK) >= least and asked.lo * (1 - TURNING_SLACK) <= most
    if asked.lo > MOST_TURNING or turns.hi == 0 or not is_possible:
        yield (
            f"the turns add up to {Range(least, min(most, MOST_TURNING))} degrees, and not to"
            f" {brief.turning}; ask for other turns or other degrees"
        )


def _degrees_of(clause: Clause, each: Amount | None) -> Range:
    possible, said = Range(SMALLEST_ANGLE, LARGEST_ANGLE), clause.degrees or each
    if said is None:
        return KINDS[clause.kind].degrees or possible
    low, high = span(said).lo * (1 - TURNING_SLACK), span(said).hi * (1 + TURNING_SLACK)
    return Range(low if low > -inf else possible.lo, high if high < inf else possible.hi)


def _sides(brief: Brief) -> Iterator[str]:
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT]
    turns = span(total(turning) if turning else brief.turns)
    least, most, is_wrong = 0.0, 0.0, False
    for amount, side in ((brief.left, "left"), (brief.right, "right")):
        wished, sure = span(amount), sum(_sure(clause, side) for clause in turning)
        least, most = least + max(wished.lo, sure, 0), most + wished.hi
        is_wrong = is_wrong or sure > wished.hi
    said = " and ".join(
        f"{n} to the {side}" for side in OTHER_SIDE if (n := getattr(brief, side)) is not None
    )
    is_never = most == 0 and (bool(turning) or turns.lo > 1)
    if is_wrong or is_never or least > turns.hi or most < turns.lo:
        yield (
            f"the turns to the left and to the right ({said}) do not add up to {turns} in all; make the"
            " numbers agree"
        )


def _sure(clause: Clause, side: str) -> float:
    """Returns the least number of turns of a clause that go to this side."""
    least, _ = turns_of(clause)
    is_one_switchback = clause.kind == "switchback" and least <= 1
    if clause.alternating or (KINDS[clause.kind].alternating and not is_one_switchback):
        return least // 2
    return least if clause.side == side and clause.kind in SINGLE | {"winding"} else 0


def _slopes(brief: Brief, most: float) -> Iterator[str]:
    climb, steepest, slope = span(brief.climb), span(brief.steepest), brief.slope
    yield from _incline(slope, brief.incline, most)
    yield from _incline(None, brief.steepest, most)
    asked = max([span(brief.incline).lo, *(span(clause.incline).lo for clause in brief.clauses)])
    if asked > steepest.hi:
        yield f"{asked:g} percent are asked for, and {steepest.hi:g} at the steepest place; leave one out"
    if slope is None:
        return
    for clause in (*brief.clauses, *brief.both_ends):
        own = clause.slope
        up_and_down = (slope in RISING and own in FALLING) or (slope in FALLING and own in RISING)
        is_hill = clause.bump or clause.kind in BUMPS or (slope in LEVEL and own in (*RISING, *FALLING))
        if is_hill or up_and_down:
            yield (
                f"the whole road is {SLOPES[slope].names[0]}, and not {clause_text(clause)}; say the slope of"
                " each part instead"
            )
    is_high = slope == "flat" and (climb.lo > 10 or climb.hi < -10)
    is_turned = (slope in RISING and climb.hi < 0) or (slope in FALLING and climb.lo > 0)
    usual = min(abs(GRADES[slope].lo), abs(GRADES[slope].hi))
    least = FIGURE_WINS * usual if slope.startswith("steeply") else LEAST_GRADE
    is_steep = steepest.lo > 4 if slope in LEVEL else steepest.hi < least
    wishes = ("slope", "incline", "steepest", "climb", "hills")
    said = road_words(Brief(**{name: getattr(brief, name) for name in wishes}))
    if is_high or is_turned or span(brief.hills).lo > 0 or (is_steep and not brief.incline):
        yield f"no road can be {said}; leave out one of them"


def _length(brief: Brief, min_radius: float, steepest: float) -> Iterator[str]:
    most = span(brief.length).hi
    least, longest = least_length(brief, min_radius), most * (1 + ROAD_LENGTH_SLACK)
    if longest < SHORTEST_ROAD:
        yield f"a road of {most:g} m is too short; ask for {SHORTEST_ROAD:g} m or more"
    if least > longest:
        yield f"{most:g} m is too short for all that; ask for {least:.0f} m or for fewer turns"
    if max(least, span(brief.length).lo * (1 - ROAD_LENGTH_SLACK)) > LONGEST_ROAD:
        yield f"no road is longer than {LONGEST_ROAD:g} m; ask for a shorter one"
    climb, grade = span(brief.climb), min(steepest, span(brief.steepest).hi)
    for way, height in (("climb", climb.lo), ("fall", -climb.hi)):
        metres = min(longest, LONGEST_ROAD)
        if height > metres * grade / 100:
            yield f"{min(most, LONGEST_ROAD):g} m of road cannot {way} {height:g} m; ask for a longer road"


def _design_speed(brief: Brief, limits: SpeedLimits) -> Iterator[str]:
    """Checks the turns against the least radius of a design speed, and lengths against its vertical curves,
    which lie half on either side of the place where two slopes meet."""
    found, fast = outline(brief.model_copy(update={"speed": None})), f"a road for {limits.kmh:g} km/h"
    features = [group.feature for group in found.groups for _ in range(max(group.lo, 1))]
    ends = [end for end in (found.starts, found.ends) if end is not None]
    for each in (*features, *ends, found.each_turn):
        most, longest = (each.radius or Range()).hi, (each.length or Range()).hi
        if most < limits.radius:
            yield (
                f"{fast} has turns of {limits.radius:.0f} m radius or more, but a {each.name} of {most:g} m"
                " or less is asked for; leave out one of the two"
            )
        angle = each.degrees.lo if each.degrees and each.kind == "turn" else 0.0
        least = limits.radius * radians(angle)
        if least > longest:
            yield (
                f"a {each.name} of {angle:g} degrees is {least:.0f} m long or longer on {fast}; change its"
                " length, or the speed"
            )
    halves = [0.0]
    for one, other in pairwise(each.grade for each in features):
        change = max(one.lo - other.hi, other.lo - one.hi, 0.0) if one and other else 0.0
        halves.append(limits.vertical_radius * change / 200)
    needed = [before + after for before, after in pairwise([*halves, 0.0])]
    rooms = [("road", found.length or Range()), *((each.name, each.length or Range()) for each in features)]
    needed = [sum(needed), *needed]
    for (name, room), metres in zip(rooms, needed, strict=False):
        if metres > room.hi:
            yield (
                f"the vertical curves of {fast} need {metres:.0f} m of a {name} that is {room.hi:.0f} m long"
                " at most; ask for longer or gentler slopes, or for a lower speed"
            )


def _noun(clause: Clause) -> str:
    return KINDS[clause.kind].names[0]
