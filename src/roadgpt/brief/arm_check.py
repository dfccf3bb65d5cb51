"""Finds contradictions in the requirements for the arms of a junction.

The arms are the roads that meet at the junction. The requirements say which arms are one-way, on which sides
roads lead on, and which angles are between the arms.
"""

from itertools import product

from roadgpt.brief.amount import meets, span
from roadgpt.brief.junction_ranges import ARMS, BENDS, SKEW, is_about
from roadgpt.brief.junctions import JunctionClause, JunctionKind
from roadgpt.brief.ranges import Range, overlap
from roadgpt.errors import BriefError

WITH_ONE_WAY_ARMS: tuple[JunctionKind, ...] = ("t_junction", "crossroads")
"""The kinds of junctions at which an arm that the route does not use can be one-way."""
FULL = 360  # degrees
ANGLES: dict[JunctionKind, Range] = {
    "t_junction": Range(55, 90),
    "y_junction": Range(90, 120),
    "crossroads": Range(40, 90),
    "star": Range(40, 65),
}
"""The range of the smallest angle between two arms of a junction, in degrees."""
TURNS: dict[JunctionKind, Range] = {
    "t_junction": Range(55, 125),
    "y_junction": Range(30, 90),
    "crossroads": Range(40, 140),
    "star": Range(30, 140),
}
"""The range of the angle by which a route can turn left or right at a junction, in degrees."""
FORK_GAPS = (87.0, 153.0)  # degrees between neighbouring arms of a fork for which an angle is required


def check_one_way_arms(junction: JunctionClause) -> None:
    """Raises BriefError if the requirements for one-way arms contradict each other or cannot be met."""
    into, out = {*junction.only_in}, {*junction.only_out}
    if not into and not out:
        return
    name, count = junction.name, len(junction.only_in) + len(junction.only_out)
    if junction.kind not in WITH_ONE_WAY_ARMS:
        raise BriefError(f"a {name} with one-way roads on a side is not built; remove in= and out=")
    if len(into | out) != count:
        raise BriefError("a road at a junction is one-way in one direction only; give in= or out= for a side")
    if junction.take in into:
        raise BriefError(
            f"the route goes {junction.take}, where a one-way road comes towards it; change one of them"
        )
    if junction.take in out:
        raise BriefError(
            f"the route goes {junction.take}: that road is one-way if the road behind the junction is, so "
            "write oneway there and remove the side from out="
        )
    if count > ARMS[junction.kind].lo - 2:
        raise BriefError(f"at a {name}, {count} one-way roads leave no way on; ask for fewer")
    if into & {*junction.ways}:
        raise BriefError("a side is a way on and has a one-way road towards the junction; remove one of them")
    if junction.ways and not out < {*junction.ways}:
        raise BriefError(
            "roads away from a junction are ways on, and one more is needed for the route; name all in ways="
        )


def check_angles(junction: JunctionClause) -> None:
    """Raises BriefError if no junction has the angles that are required between its arms."""
    name, kind = junction.name, junction.kind
    if junction.angle is None and junction.degrees is None:
        return
    if kind == "roundabout":
        raise BriefError("angles are not asked of a roundabout; remove deg= and angle=")
    if junction.angle is not None and kind == "junction":
        raise BriefError("the angle between roads is asked of a kind of junction; name one, or remove angle=")
    if not meets(junction.angle, ANGLES.get(kind, Range())):
        raise BriefError(
            f"the smallest angle between roads at a {name} is {ANGLES[kind]} degrees, not {junction.angle}; "
            "change it"
        )
    if junction.degrees is not None and junction.take == "straight":
        raise BriefError("straight on, the route turns by few degrees; remove deg=, or go left or right")
    turns = _turns(junction)
    if not meets(junction.degrees, turns):
        raise BriefError(
            f"at a {name}, the route turns by {turns} degrees, not {junction.degrees}; change it"
        )
    if not _go_together(junction):
        asked = f"deg={junction.degrees}, " if junction.degrees is not None else ""
        asked += f"angle={junction.angle}, " if junction.angle is not None else ""
        rest = "skew" if junction.skew else f"{junction.arms or ARMS[kind]} arms"
        raise BriefError(f"no {name} has {asked}{rest} at once; leave one of them out")


def _turns(junction: JunctionClause) -> Range:
    """Returns the angles in degrees by which the route can turn at the junction in the required direction."""
    kinds = [kind for kind in TURNS if junction.kind in (kind, "junction")]
    found = [TURNS[kind] for kind in kinds if meets(junction.arms, ARMS[kind])] or [TURNS["star"]]
    turns = Range(min(each.lo for each in found), max(each.hi for each in found))
    return overlap(turns, BENDS.get((junction.take or "").partition("_")[0])) or turns


def _go_together(junction: JunctionClause) -> bool:
    """Returns whether some junction has the required angles together with what else is required."""
    if junction.kind == "crossroads":
        turns = range(int(TURNS["crossroads"].lo), int(TURNS["crossroads"].hi) + 1)
        return any(_allows(junction, turn, min(turn, 180 - turn)) for turn in turns)
    if junction.kind == "y_junction":
        gaps = range(int(FORK_GAPS[0]), int(FORK_GAPS[1]) + 1)
        thirds = ((gap, other, FULL - gap - other) for gap, other in product(gaps, gaps))
        return any(_allows(junction, 180 - parts[0], min(parts)) for parts in thirds if max(parts) in gaps)
    if junction.kind == "star":
        return max(span(junction.angle).lo, 0) * max(span(junction.arms).lo, ARMS["star"].lo) <= FULL
    return True


def _allows(junction: JunctionClause, turn: float, least: float) -> bool:
    """Returns whether the route may turn by an angle where the closest roads are ``least`` degrees apart."""
    turns = junction.degrees is None or is_about(turn, junction.degrees)
    is_between = junction.angle is None or is_about(least, junction.angle)
    return turns and is_between and (not junction.skew or least < SKEW)
