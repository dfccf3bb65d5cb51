"""Finds the parts of a road where the description asks for a crest, a dip or a hump.

In these parts the rule ``too_abrupt`` allows vertical accelerations of up to 1 g.
"""

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import BUMPS
from roadgpt.brief.outline import outline
from roadgpt.check.measures import measure
from roadgpt.road import Road

CURVE = 30.0  # m by which a parabola may reach from its straight into the turns at its ends


def asks_for_bumps(brief: Brief | None) -> bool:
    """Returns whether the description asks for a crest, a dip or a hump anywhere."""
    if brief is None:
        return False
    return any(clause.kind in BUMPS for clause in (*brief.clauses, brief.starts, brief.ends) if clause)


def bumps_asked(road: Road, brief: Brief | None) -> list[tuple[float, float]]:
    """Returns the start and end stations, in metres, of the parts of a road where a crest, a dip or a hump is
    requested.

    A part reaches from one turn to the next, or to an end of the road, and 30 m into the turns beside it. If
    the description does not fix the number of turns before a crest, dip or hump, all parts are returned.
    """
    if brief is None or not asks_for_bumps(brief):
        return []
    found = measure(road.centreline())
    begins = [0.0, *(turn.end - CURVE for turn in found.turns)]
    ends = [*(turn.start + CURVE for turn in found.turns), road.length]
    gaps = list(zip(begins, ends, strict=True))
    wanted: set[int] = set()
    if brief.starts and brief.starts.kind in BUMPS:
        wanted.add(0)
    if brief.ends and brief.ends.kind in BUMPS:
        wanted.add(len(gaps) - 1)
    for index, clause in enumerate(brief.clauses):
        if clause.kind in BUMPS:
            number = _turns_before(brief, index)
            wanted |= set(range(len(gaps))) if number is None else {min(number, len(gaps) - 1)}
    return [gaps[number] for number in sorted(wanted)]


def _turns_before(brief: Brief, index: int) -> int | None:
    """Returns the number of turns before the clause at ``index``; None if the Brief leaves it open."""
    if not outline(brief).names_all_turns:
        return None
    before = outline(brief.model_copy(update={"clauses": brief.clauses[:index]})).groups
    counts = [(group.lo, group.hi) for group in before if group.feature.kind == "turn"]
    return sum(lo for lo, _ in counts) if all(lo == hi for lo, hi in counts) else None
