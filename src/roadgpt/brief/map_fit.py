"""Checks from the numbers of a Brief whether its road can fit on the map, and proposes what would fit."""

from math import ceil, floor, inf, pi, prod, radians, sin, sqrt

from roadgpt.brief.model import Brief, Clause, span
from roadgpt.brief.normal import STRAIGHT, total, turns_of
from roadgpt.brief.refusal import NoRoomError
from roadgpt.brief.words import (
    KINDS,
    LARGEST_MAP,
    LEAST_STRAIGHT,
    LENGTH_SLACK,
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
GAP = 16.0  # metres of straight between two turns to the same side


def longest_straight(map_size: float, road_width: float = ROAD_WIDTH) -> float:
    """Returns the length in metres of the longest straight on the map: from corner to corner, as far from the
    border as the whole carriageway needs.
    """
    return sqrt(2) * (map_size - road_width - 2 * EDGE)


def check_room(brief: Brief, map_size: float, min_radius: float, road_width: float = ROAD_WIDTH) -> None:
    """Checks that a map is not obviously too small for a Brief in normal form; only the design shows whether
    the road really fits. Lengths are in metres.

    Raises:
        NoRoomError: the road cannot fit; the message says what would fit.
    """
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
    if straight * (1 - LENGTH_SLACK) > longest:
        raise _too_long("a straight", straight, brief, map_size, road_width)
    if not brief.turns or brief.turns.hi != 0:
        return
    said = sum(max(span(c.length).lo, 0) for c in brief.clauses if c.kind in STRAIGHT)
    if least_length(brief, 0.0) > longest:
        raise _too_long("a straight road", said or least_length(brief, 0.0), brief, map_size, road_width)
    length = span(brief.length).lo
    if length * (1 - ROAD_LENGTH_SLACK) > longest:
        raise _too_long("a straight road", length, brief, map_size, road_width)


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
    turns have a radius of ``min_radius`` metres or more.
    """
    metres = sum(_way(clause, min_radius) for clause in brief.clauses)
    extra = span(brief.turns).lo - span(total(brief.clauses)).lo
    return metres + max(extra, 0) * WAY_OF_A_TURN


def metres_of(brief: Brief, min_radius: float) -> float:
    """Returns the least length in metres that a road needs to meet a Brief, as ``least_length`` does, or the
    length that the Brief asks for if that is more."""
    said = (brief.length.lo or 0.0) if brief.length else 0.0
    return max(least_length(brief, min_radius), said)


def _way(clause: Clause, min_radius: float) -> float:
    """Returns the least length of a clause in metres."""
    if clause.kind in STRAIGHT:
        size = SIZES[clause.size].length if clause.size else None
        least = (1 - LENGTH_SLACK) * span(clause.length).lo
        return least if least > -inf else size.lo if size else LEAST_STRAIGHT
    least, _ = turns_of(clause)
    arc = prod(_bend(clause, min_radius), start=pi / 180)
    return least * max(arc + (0 if clause.kind in ("s_bend", "chicane") else GAP), WAY_OF_A_TURN * 0.8)


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
