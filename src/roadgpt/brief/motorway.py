"""Motorways, freeways, Autobahnen: what the word promises, and whether the map has room for that.

The readers take the word for sweeping turns. A real one is wider still: on a map that has room for it every
turn has a radius of 600 m or more, and no place is steeper than 5 percent. On a smaller map its turns are as
wide as sweeping ones are there, and ``remarks`` says so. What is said of the turns themselves ("a motorway
with a hairpin") wins over the word.

Sources: AASHTO, A Policy on Geometric Design of Highways and Streets (2018), for 70 mph: radii from 2,040 ft
on (622 m) at 6 percent superelevation, 5 percent of grade in mountains, curves of 15 ft for each mph or more
(1,050 ft, 320 m). RAA 2008, design classes EKA 1 A, 1 B, 2 and 3: radii from 900, 720, 470 and 280 m on,
grades up to 4, 4.5, 4.5 and 6 percent.
"""

import re
import unicodedata
from collections.abc import Iterator
from math import ceil, radians

from roadgpt.brief.map_fit import LARGEST_MAP
from roadgpt.brief.model import Brief, Clause
from roadgpt.brief.normal import STRAIGHT, normal, total, turns_of
from roadgpt.brief.words import LENGTH_SLACK, MOTORWAY_GRADE, MOTORWAY_RADIUS, ROAD_LENGTH_SLACK


def _bag(*lines: str) -> frozenset[str]:
    return frozenset(word for line in lines for word in line.split())


NAMES = _bag(
    "motorway motorways freeway freeways expressway expressways highway highways interstate turnpike",
    "autobahn autobahnen schnellstrasse schnellstraße kraftfahrstrasse kraftfahrstraße autoroute autoroutes",
    "autopista autopistas autovia autovias autostrada autostrade superstrada superstrade",
)
PAIRS = frozenset([("dual", "carriageway"), ("voie", "rapide"), ("voies", "rapides")])
NOT_ONE = _bag(
    "no not without off from to towards toward near beside leaving leave join joining over under",
    "kein keine keiner ohne neben zur zum von pas sans vers quitter sin hacia junto senza verso accanto non",
)
"""Before the word, these speak of a road that is none, or only near one."""
BACK = 3  # words before it that are looked at
PARTS_OF_ONE = _bag(
    "exit exits ramp ramps slip interchange junction entrance bridge services ausfahrt auffahrt"
)
"""Behind the word, these make another road of it."""
OPEN_KINDS = frozenset({"turn", "s_bend", "winding"})
"""Turns whose radius is not part of what they are."""
SHORTEST_CURVE = 320.0  # metres
BETWEEN = 17.5  # metres from one turn to the next, at least
LEADS = 33.0  # metres of straight before the first and after the last
SIDES = 1.3  # of the map, which lies along a road that is nearly straight
COMFORT = 1.5  # of the road that a motorway needs at least: the map that is proposed
ROUND = 500.0  # metres, of that map
STEEP = ("steeply_up", "steeply_down")


def says_motorway(words: str) -> bool:
    """Does a description, in any of the five languages, ask for a motorway?"""
    plain = "".join(c for c in unicodedata.normalize("NFD", words.lower()) if not unicodedata.combining(c))
    said = re.findall(r"[^\W\d_]+", plain)
    for at, (word, after) in enumerate(zip(said, [*said[1:], ""], strict=True)):
        is_pair = (word, after) in PAIRS
        if is_pair or word in NAMES:
            follows = "".join(said[at + 2 : at + 3]) if is_pair else after
            if follows not in PARTS_OF_ONE and not NOT_ONE & {*said[max(at - BACK, 0) : at]}:
                return True
    return False


def has_wide_turns(brief: Brief, map_size: float) -> bool:
    """Is every turn to be as wide as a motorway's: is it one, and is there room for it?"""
    return brief.motorway and not _is_tighter(brief) and not _lack_of_room(brief, map_size)


def has_low_grades(brief: Brief) -> bool:
    """Is no place to be steeper than on a motorway?"""
    if not brief.motorway:
        return False
    things: list[Brief | Clause] = [brief, *_clauses(brief)]
    steep = any(thing.slope in STEEP and not thing.incline for thing in things)
    amounts = [brief.steepest, *(thing.incline for thing in things)]
    return not steep and not any(amount and (amount.lo or 0) > MOTORWAY_GRADE for amount in amounts)


def remarks(brief: Brief, map_size: float) -> tuple[str, ...]:
    """What a word promises on this map, and what of it cannot be kept there: a sentence without full stop."""
    if not brief.motorway:
        return ()
    wide, low = f"turns of {MOTORWAY_RADIUS:g} m radius or more", f"grades of {MOTORWAY_GRADE:g} % or less"
    if not has_low_grades(brief):
        slopes = "it is steeper than a motorway, as was asked for"
    else:
        slopes = f"{low} are kept"
    if _needed(brief) == 0:
        return (f"a motorway has {low}" if has_low_grades(brief) else slopes,)
    lack = "but tighter ones are asked for" if _is_tighter(brief) else _lack_of_room(brief, map_size)
    if lack:
        return (f"a motorway has {wide}, {lack}; {slopes}",)
    return (f"a motorway has {wide}" + (f", and {low}" if has_low_grades(brief) else f"; {slopes}"),)


def _lack_of_room(brief: Brief, map_size: float) -> str:
    """Why there is no room, and what to do; empty where there is."""
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
    """Metres of road that a motorway with these turns has at least; 0 where it has none."""
    said = normal(brief)
    if said.turns and said.turns.hi == 0:
        return 0.0
    turning = [clause for clause in said.clauses if clause.kind not in STRAIGHT]
    straights = sum((c.length.lo or 0) if c.length else 0 for c in said.clauses if c.kind in STRAIGHT)
    sides = sum((side.lo or 0) if side else 0 for side in (said.left, said.right))
    more = max((said.turns.lo or 0) if said.turns else 0, sides, 1) - (total(turning).lo or 0)
    curves = sum(turns_of(clause)[0] * _curve(clause) for clause in turning)
    if more > 0:
        curves += more * _curve(Clause(kind="turn", degrees=said.degrees, radius=said.radius))
    count = (total(turning).lo or 0) + max(more, 0)
    return curves + (count - 1) * BETWEEN + straights + LEADS


def _curve(clause: Clause) -> float:
    """Metres of one turn."""
    degrees = (clause.degrees.lo or 0) if clause.degrees else 0.0
    radius = max(MOTORWAY_RADIUS, (clause.radius.lo or 0) if clause.radius else 0)
    return max(SHORTEST_CURVE, radius * radians(degrees))


def _is_tighter(brief: Brief) -> bool:
    """Is something asked of the turns that no motorway has?"""
    shapes: list[Brief | Clause] = [brief, *_clauses(brief)]
    return any(clause.kind not in OPEN_KINDS | STRAIGHT for clause in _clauses(brief)) or any(
        thing.sharpness == "sharp" or _below(thing) for thing in shapes
    )


def _below(thing: Brief | Clause) -> bool:
    hi = thing.radius.hi if thing.radius else None
    return hi is not None and hi * (1 + LENGTH_SLACK) < MOTORWAY_RADIUS


def _clauses(brief: Brief) -> Iterator[Clause]:
    yield from brief.clauses
    yield from (end for end in (brief.starts, brief.ends) if end)


def _up(metres: float, step: float) -> float:
    return ceil(metres / step) * step
