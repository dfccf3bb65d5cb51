"""Defines what words such as "motorway" require, and whether the map can hold such a road.

The readers read "motorway" as a road with sweeping turns. The turns of an actual motorway are wider: every
turn gets a radius of 600 m or more if the map and the required length can hold such turns. Otherwise the
turns are only sweeping, and ``remarks`` reports this. In both cases, no place is steeper than 5 percent.
Requirements for turns and slopes ("a motorway with a hairpin") take precedence over those of the word.

Sources: AASHTO, A Policy on Geometric Design of Highways and Streets (2018), for 70 mph: radii of 2,040 ft or
more (622 m) at 6 percent superelevation, grades up to 5 percent in mountains, curves at least 15 ft long per
mph (1,050 ft, 320 m). RAA 2008, design classes EKA 1 A, 1 B, 2 and 3: radii of at least 900, 720, 470 and 280
m, grades up to 4, 4.5, 4.5 and 6 percent.
"""

from math import ceil, radians

from roadgpt.brief.model import Brief, Clause, span
from roadgpt.brief.normal import STRAIGHT, normal, total, turns_of
from roadgpt.brief.words import LARGEST_MAP, LENGTH_SLACK, MOTORWAY_GRADE, MOTORWAY_RADIUS, ROAD_LENGTH_SLACK

OPEN_KINDS = frozenset({"turn", "s_bend", "winding"})
"""The kinds of turns whose radius is not fixed by their kind."""
SHORTEST_CURVE = 320.0  # metres
BETWEEN = 17.5  # metres from one turn to the next, at least
LEADS = 33.0  # metres of straight before the first turn and after the last turn together
SIDES = 1.3  # a nearly straight road may be this many sides of the map long
COMFORT = 1.5  # the proposed map is this many times the least length of the road
ROUND = 500.0  # metres: the proposed map is rounded up to this
STEEP = ("steeply_up", "steeply_down")


def has_wide_turns(brief: Brief, map_size: float) -> bool:
    """Returns True if the Brief asks for a motorway and for no tighter turns, and if the wide turns of a
    motorway fit on the map and into the required length; ``map_size`` is in metres.
    """
    return brief.motorway and not _is_tighter(brief) and not _lack_of_room(brief, map_size)


def has_low_grades(brief: Brief) -> bool:
    """Returns True if the Brief asks for a motorway and requires no grade that is too steep for one."""
    if not brief.motorway:
        return False
    things: list[Brief | Clause] = [brief, *brief.clauses, *brief.both_ends]
    steep = any(thing.slope in STEEP and not thing.incline for thing in things)
    amounts = [brief.steepest, *(thing.incline for thing in things)]
    return not steep and not any(span(amount).lo > MOTORWAY_GRADE for amount in amounts)


def remarks(brief: Brief, map_size: float) -> tuple[str, ...]:
    """Returns sentences, without full stops, on what "motorway" requires and whether the map can hold it.

    Empty if the Brief asks for no motorway; ``map_size`` is the side of the map in metres.
    """
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
    if needed <= SIDES * map_size:
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
    """Returns the least length of one turn in metres."""
    degrees = max(span(clause.degrees).lo, 0.0)
    return max(SHORTEST_CURVE, max(MOTORWAY_RADIUS, span(clause.radius).lo) * radians(degrees))


def _is_tighter(brief: Brief) -> bool:
    """True if the Brief asks for a turn that no motorway has."""
    clauses = (*brief.clauses, *brief.both_ends)
    things: tuple[Brief | Clause, ...] = (brief, *clauses)
    return any(clause.kind not in OPEN_KINDS | STRAIGHT for clause in clauses) or any(
        thing.sharpness == "sharp" or span(thing.radius).hi * (1 + LENGTH_SLACK) < MOTORWAY_RADIUS
        for thing in things
    )


def _up(metres: float, step: float) -> float:
    return ceil(metres / step) * step
