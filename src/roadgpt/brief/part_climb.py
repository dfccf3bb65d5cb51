"""Heights of single turns and straights: the lengths and grades that follow from a climb in metres, the
contradictions between these numbers, and the slopes of crests and dips.
"""

from collections.abc import Mapping
from math import inf

from roadgpt.brief.model import Amount, Clause, Kind, Slope, span
from roadgpt.brief.normal import BUMPS, SHAPED, STRAIGHT
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import KINDS, LEAST_GRADE, LENGTH_SLACK, PART_CLIMB_SLACK, PERCENT_SLACK, STEEPEST
from roadgpt.errors import BriefError

USUALLY_STEEPEST = 12.0  # percent, of a part whose height is given and whose length and grade are open
BUMP_SLOPES: Mapping[Kind, tuple[Slope, Slope]] = {"crest": ("up", "down"), "dip": ("down", "up")}
STRAIGHT_ON = Clause(kind="straight")
TOGETHER = frozenset({"s_bend", "chicane"}) | (SHAPED - {"turn"}) | {"slalom"}
"""The kinds that consist of several turns; the turns share the height of the clause."""


def climb_of_each(clause: Clause) -> Amount | None:
    """Returns how many metres each single turn or straight of a clause rises or falls; None if the clause
    asks for no height. The turns of an S-bend share its height equally.
    """
    if clause.climb is None or clause.kind in STRAIGHT or clause.kind not in TOGETHER:
        return clause.climb
    turns = KINDS[clause.kind].turns
    share = turns.lo if turns else 1.0
    if clause.kind not in ("s_bend", "chicane"):
        share = max(share, span(clause.count).lo)
    return clause.climb.times(1 / share)


def slopes_of_bump(clause: Clause) -> list[Clause]:
    """Returns the two slopes of a crest or a dip: each has the whole height, and half of the length."""
    length = clause.length and clause.length.times(0.5)
    return [clause.model_copy(update={"slope": way, "length": length}) for way in BUMP_SLOPES[clause.kind]]


def without_joints(clauses: tuple[Clause, ...]) -> list[Clause]:
    """Leaves out each crest between a climbing and a falling straight, and each dip between a falling and a
    climbing straight: such a crest or dip is only the place where the straights meet. A crest or dip with
    requirements of its own stays.
    """
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
    whose radius is given; the angle and the radius then determine the length.
    """
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


def check_climb(clause: Clause, steepest: float) -> None:
    """Raises BriefError if the height that is asked of a clause in normal form contradicts its slope, length
    or grade, or needs a grade above ``steepest`` percent.
    """
    if clause.climb is None:
        return
    noun, height = KINDS[clause.kind].names[0], span(clause.climb)
    if (clause.climb.lo or 0) < 0 or height.hi <= 0:
        raise BriefError(
            f"a {noun} cannot rise or fall by {clause.climb} m; ask for more than 0 m, up or down"
        )
    if clause.slope in ("flat", "nearly_flat"):
        raise BriefError(f"a level {noun} cannot rise or fall by {clause.climb} m; leave out one of the two")
    slope = slopes_of_bump(clause)[0] if clause.kind in BUMPS else clause
    length, grade = span(slope.length), span(clause.incline)
    longest, least = length.hi * (1 + LENGTH_SLACK), height.lo * (1 - PART_CLIMB_SLACK)
    if least > longest * steepest / 100:
        raise BriefError(
            f"a {noun} of {clause.length} m cannot rise or fall by {clause.climb} m at {steepest:g} percent"
            " or less; ask for a longer one or for less height"
        )
    shortest, most = length.lo * (1 - LENGTH_SLACK), height.hi * (1 + PART_CLIMB_SLACK)
    too_steep = shortest > -inf and shortest * (grade.lo - PERCENT_SLACK) / 100 > most
    too_gentle = longest < inf and longest * (grade.hi + PERCENT_SLACK) / 100 < least
    if clause.incline and (too_steep or too_gentle):
        raise BriefError(
            f"{clause.length} m at {clause.incline} percent do not make {clause.climb} m of height;"
            " leave out one of the three"
        )
