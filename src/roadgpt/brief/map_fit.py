"""Checks from the numbers of a Brief whether its road can fit on the map, and proposes what would fit.

The readers read "motorway" as a road with sweeping turns. The turns of an actual motorway are wider: every
turn gets a radius of 600 m or more if the map and the required length can hold such turns. Otherwise the
turns are only sweeping, and ``motorway_remarks`` reports this. In both cases, no place is steeper than 5
percent. Requirements for turns and slopes ("a motorway with a hairpin") take precedence over those of the
word.

Sources: AASHTO, A Policy on Geometric Design of Highways and Streets (2018), for 70 mph: radii of 2,040 ft or
more (622 m) at 6 percent superelevation, grades up to 5 percent in mountains, curves at least 15 ft long per
mph (1,050 ft, 320 m). RAA 2008, design classes EKA 1 A, 1 B, 2 and 3: radii of at least 900, 720, 470 and 280
m, grades up to 4, 4.5, 4.5 and 6 percent."""

from math import ceil, floor, inf, pi, prod, radians, sin, sqrt

from roadgpt.brief.design_speed import limits_at
from roadgpt.brief.model import Brief, Clause, span
from roadgpt.brief.normal import STRAIGHT, normal, total, turns_of
from roadgpt.brief.refusal import NoRoomError
from roadgpt.brief.words import (
    KINDS,
    LARGEST_MAP,
    LEAST_STRAIGHT,
    LENGTH_SLACK,
    MOTORWAY_GRADE,
    MOTORWAY_RADIUS,
    ROAD_LENGTH_SLACK,
    SHARPNESS,
    SIZES,
)

ROAD_WIDTH = 8.0  # metres: two lanes of 4 m
EDGE = 0.3  # metres kept free between ribbon and border of the map, for rounding and the bulge of splines
WIDTH_OF_A_TURN = 40.0  # metres: lanes of 8 m, shoulders, and the width of the bend itself
SIDES_OF_ROAD = 1.3  # a road with turns fits if it is this many sides of the map long
BESIDE_TURNS = 0.6  # share of the longest straight that still fits on a road with turns
ROUND_MAP = 50.0  # metres: map sizes are proposed in these steps
WAY_OF_A_TURN = 30.0  # metres that a turn and the straight after it need at least
ALL_OF_IT = "a straight road"
GAP = 16.0  # metres of straight between two turns to the same side


def longest_straight(map_size: float, road_width: float = ROAD_WIDTH) -> float:
    """Returns the length in metres of the longest straight on the map: from corner to corner, as far from the
    border as the whole carriageway needs."""
    return sqrt(2) * (map_size - road_width - 2 * EDGE)


def check_room(brief: Brief, map_size: float, min_radius: float, road_width: float = ROAD_WIDTH) -> None:
    """Checks that a map is not obviously too small for a Brief in normal form; only the design shows whether
    the road really fits. Lengths are in metres.

    Raises:
        NoRoomError: the road cannot fit; the message says what would fit."""
    _straights(brief, map_size, road_width)
    _turns(brief, map_size, road_width)
    least = least_length(brief, min_radius)
    metres = max(least, span(brief.length).lo * (1 - ROAD_LENGTH_SLACK))
    if metres > map_size * map_size / WIDTH_OF_A_TURN:
        offer = floor(SIDES_OF_ROAD * map_size / 10) * 10
        less = f"{offer} m, " if brief.length and least < offer else ""
        raise NoRoomError(
            f"a map of {map_size:g} m has no room for {metres:.0f} m of such road; ask for {less}fewer turns"
            " or a larger map",
            brief,
        )


def _turns(brief: Brief, map_size: float, road_width: float) -> None:
    """Checks that the ends of each turn of required radius are no farther apart than two corners."""
    for clause in brief.clauses:
        said = span(clause.radius).lo
        if said <= 0 or clause.kind in STRAIGHT:
            continue
        degrees, radius = _bend(clause, 0.0)
        if 2 * radius * sin(radians(min(degrees, 180.0) / 2)) > longest_straight(map_size, road_width):
            raise NoRoomError(
                f"a turn with a radius of {said:g} m has no room on a map of {map_size:g} m;"
                f" ask for {map_size / 2:g} m or a larger map",
                brief,
            )


def _straights(brief: Brief, map_size: float, road_width: float) -> None:
    """Checks that each straight fits from corner to corner; if there are no turns, the whole road has to."""
    longest = longest_straight(map_size, road_width)
    straight = max((span(c.length).lo for c in brief.clauses if c.kind == "straight"), default=0.0)
    asked = [("a straight", straight, straight * (1 - LENGTH_SLACK))]
    if brief.turns and brief.turns.hi == 0:
        said = sum(max(span(c.length).lo, 0) for c in brief.clauses if c.kind in STRAIGHT)
        least, length = least_length(brief, 0.0), span(brief.length).lo
        asked += [(ALL_OF_IT, said or least, least), (ALL_OF_IT, length, length * (1 - ROAD_LENGTH_SLACK))]
    for what, metres, least in asked:
        if least > longest:
            raise _too_long(what, metres, brief, map_size, road_width)


def _too_long(what: str, metres: float, brief: Brief, map_size: float, road_width: float) -> NoRoomError:
    longest = longest_straight(map_size, road_width)
    size = ceil((metres / sqrt(2) + road_width + 2 * EDGE) / ROUND_MAP) * ROUND_MAP
    is_all = brief.turns is not None and brief.turns.hi == 0
    offer = floor(longest if is_all else BESIDE_TURNS * longest)
    size *= 1 if is_all else round(1 / BESIDE_TURNS)
    larger = f" or use --map-size {size:g}" if size <= LARGEST_MAP else ""
    return NoRoomError(
        f"{what} of {metres:g} m does not fit on a map of {map_size:g} m, which is {floor(longest)} m from"
        f" corner to corner; ask for {offer} m{larger}",
        brief,
    )


def least_length(brief: Brief, min_radius: float) -> float:
    """Returns a lower bound, in metres, on the length of a road with the clauses and turns of a Brief, whose
    turns have a radius of ``min_radius`` metres or more, and the radius that the design speed needs."""
    limits = limits_at(brief.speed) if brief.speed else None
    least = max(min_radius, limits.radius) if limits else min_radius
    metres = sum(_way(clause, least) for clause in brief.clauses)
    extra = span(brief.turns).lo - span(total(brief.clauses)).lo
    return metres + max(extra, 0) * max(WAY_OF_A_TURN, limits.shortest_turn if limits else 0.0)


def metres_of(brief: Brief, min_radius: float) -> float:
    """Returns the least length in metres that a road needs to meet a Brief, as ``least_length`` does, or the
    length that the Brief asks for if that is more."""
    said = (brief.length.lo or 0.0) if brief.length else 0.0
    return max(least_length(brief, min_radius), said)


def _way(clause: Clause, min_radius: float) -> float:
    if clause.kind in STRAIGHT:
        size = SIZES[clause.size].length if clause.size else None
        least = (1 - LENGTH_SLACK) * span(clause.length).lo
        return least if least > -inf else size.lo if size else LEAST_STRAIGHT
    least, _ = turns_of(clause)
    arc = prod(_bend(clause, min_radius), start=pi / 180)
    return least * max(arc + (0 if KINDS[clause.kind].whole else GAP), WAY_OF_A_TURN * 0.8)


def _bend(clause: Clause, min_radius: float) -> tuple[float, float]:
    """Returns the least angle in degrees and the least radius in metres of each turn of a clause."""
    own, sharp = KINDS[clause.kind].degrees, SHARPNESS[clause.sharpness] if clause.sharpness else None
    angle = clause.degrees.lo if clause.degrees and clause.degrees.lo else own.lo if own else 25.0
    if sharp and sharp.degrees and not clause.degrees and clause.kind == "turn":
        angle = sharp.degrees.lo
    radius = sharp.radius.lo if sharp and sharp.radius else 0.0
    if clause.radius and clause.radius.lo:
        radius = (1 - LENGTH_SLACK) * clause.radius.lo
    return angle, max(radius, min_radius)


SHORTEST_CURVE = 320.0  # metres
BETWEEN = 17.5  # metres from one turn to the next, at least
LEADS = 33.0  # metres of straight before the first turn and after the last turn together
COMFORT = 1.5  # the proposed map is this many times the least length of the road
ROUND = 500.0  # metres: the proposed map is rounded up to this
STEEP = ("steeply_up", "steeply_down")


def has_wide_turns(brief: Brief, map_size: float) -> bool:
    """Returns True if the Brief asks for a motorway and for no tighter turns, and if the wide turns of a
    motorway fit on the map and into the required length; ``map_size`` is in metres."""
    return brief.motorway and not _is_tighter(brief) and not _lack_of_room(brief, map_size)


def has_low_grades(brief: Brief) -> bool:
    """Returns True if the Brief asks for a motorway and requires no grade that is too steep for one."""
    if not brief.motorway:
        return False
    things: list[Brief | Clause] = [brief, *brief.clauses, *brief.both_ends]
    steep = any(thing.slope in STEEP and not thing.incline for thing in things)
    amounts = [brief.steepest, *(thing.incline for thing in things)]
    return not steep and not any(span(amount).lo > MOTORWAY_GRADE for amount in amounts)


def motorway_remarks(brief: Brief, map_size: float) -> tuple[str, ...]:
    """Returns sentences, without full stops, on what "motorway" requires and whether the map can hold it.

    Empty if the Brief asks for no motorway; ``map_size`` is the side of the map in metres."""
    if not brief.motorway:
        return ()
    wide, low = f"turns of {MOTORWAY_RADIUS:g} m radius or more", f"grades of {MOTORWAY_GRADE:g} % or less"
    is_low = has_low_grades(brief)
    slopes = f"{low} are still met" if is_low else "this one is steeper, as was asked for"
    if _needed(brief) == 0:
        return (f"a motorway has {low}" if is_low else slopes,)
    lack = "but tighter ones are asked for" if _is_tighter(brief) else _lack_of_room(brief, map_size)
    if is_low and not lack:
        return (f"a motorway has {wide}, and {low}",)
    return (f"a motorway has {wide}{f', {lack}' if lack else ''}; {slopes}",)


def _lack_of_room(brief: Brief, map_size: float) -> str:
    """Returns why the map or the required length is too small for a motorway, and what to do; else empty."""
    needed = _needed(brief)
    most = brief.length.hi * (1 + ROAD_LENGTH_SLACK) if brief.length and brief.length.hi else needed
    if needed > most:
        metres = most / (1 + ROAD_LENGTH_SLACK)
        why = f"and {metres:g} m of road cannot hold one, so turns are tighter here"
        return f"{why}; ask for {_up(needed, 50):g} m"
    if needed <= SIDES_OF_ROAD * map_size:
        return ""
    size = _up(COMFORT * needed, ROUND)
    larger = f"; use --map-size {size:g}" if size <= LARGEST_MAP else ""
    return f"and a map of {map_size:g} m cannot hold one, so turns are tighter here{larger}"


def _needed(brief: Brief) -> float:
    """Returns the least length in metres of a motorway with the turns of the Brief; 0 if it has no turns."""
    said = normal(brief)
    if said.turns and said.turns.hi == 0:
        return 0.0
    turning = [clause for clause in said.clauses if clause.kind not in STRAIGHT]
    straights = sum(max(span(c.length).lo, 0) for c in said.clauses if c.kind in STRAIGHT)
    sides = sum(max(span(side).lo, 0) for side in (said.left, said.right))
    count = max(span(total(turning)).lo, span(said.turns).lo, sides, 1)
    more = count - span(total(turning)).lo
    curves = sum(turns_of(clause)[0] * _curve(clause) for clause in turning)
    if more > 0:
        curves += more * _curve(Clause(kind="turn", degrees=said.degrees, radius=said.radius))
    return curves + (count - 1) * BETWEEN + straights + LEADS


def _curve(clause: Clause) -> float:
    degrees = max(span(clause.degrees).lo, 0.0)
    return max(SHORTEST_CURVE, max(MOTORWAY_RADIUS, span(clause.radius).lo) * radians(degrees))


def _is_tighter(brief: Brief) -> bool:
    clauses = (*brief.clauses, *brief.both_ends)
    things: tuple[Brief | Clause, ...] = (brief, *clauses)
    return any(not (KINDS[clause.kind].wide or clause.kind in STRAIGHT) for clause in clauses) or any(
        thing.sharpness == "sharp" or span(thing.radius).hi * (1 + LENGTH_SLACK) < MOTORWAY_RADIUS
        for thing in things
    )


def _up(metres: float, step: float) -> float:
    return ceil(metres / step) * step
