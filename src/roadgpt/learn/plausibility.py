"""Checks whether a randomly generated Brief makes sense: no contradictions, nothing too large for a map."""

from math import inf

from roadgpt.brief.model import Amount, Brief, Clause

MOST_TURNS = 12
SMALLEST_RADIUS = 15.0  # metres
STEEPEST = 15.0  # percent
STRAIGHT_KINDS = frozenset({"straight", "crest", "dip"})
TURNS_OF = {"s_bend": 2, "chicane": 2, "slalom": 4, "serpentine": 4, "zigzag": 4, "winding": 3}


def makes_sense(brief: Brief) -> bool:
    """Returns True if a road can satisfy the Brief, as far as simple rules can tell."""
    says_something = bool(brief.clauses or _wishes_anything(brief)) and not _shapes_no_turn(brief)
    return says_something and not contradiction(brief) and not impossibility(brief)


def _shapes_no_turn(brief: Brief) -> bool:
    """True if something is said about turns although there are none."""
    straight = bool(brief.clauses) and all(clause.kind in STRAIGHT_KINDS for clause in brief.clauses)
    none = straight or bool(brief.turns and brief.turns.hi == 0)
    said = (brief.sharpness, brief.degrees, brief.radius, brief.alternating, brief.left, brief.right)
    return none and any(said)


def _wishes_anything(brief: Brief) -> bool:
    return any(value for name, value in brief if name not in ("words", "unused", "confidence", "clauses"))


def contradiction(brief: Brief) -> bool:
    """Returns True if the Brief contradicts itself."""
    whole = _way(brief.slope)
    for clause in _all_clauses(brief):
        way = _way(clause.slope)
        if whole and way and way != whole:
            return True
        if whole == "flat" and clause.kind in ("crest", "dip"):
            return True
        if brief.left and brief.left.hi == 0 and clause.side == "left":
            return True
        if brief.right and brief.right.hi == 0 and clause.side == "right":
            return True
        if _clause_contradicts(clause):
            return True
    return _counts_contradict(brief) or (whole == "flat" and bool(brief.climb or brief.hills))


def _clause_contradicts(clause: Clause) -> bool:
    if clause.kind in STRAIGHT_KINDS and (clause.side or clause.sharpness or clause.degrees or clause.radius):
        return True
    if clause.kind == "hairpin" and clause.degrees and _top(clause.degrees) < 100:
        return True
    if clause.kind in ("hairpin", "chicane", "slalom") and clause.sharpness in ("gentle", "sweeping"):
        return True
    if clause.kind not in STRAIGHT_KINDS and clause.size:
        return True
    if clause.slope == "flat" and clause.incline:
        return True
    return clause.alternating and clause.count.hi == 1 and clause.count.lo == 1


def _counts_contradict(brief: Brief) -> bool:
    turning = [clause for clause in brief.clauses if clause.kind not in STRAIGHT_KINDS]
    wanted = brief.turns
    sides = sum(amount.lo or 0 for amount in (brief.left, brief.right) if amount)
    least = sum(clause.count.lo or 0 for clause in turning)
    if wanted and (wanted.hi is not None) and (least > wanted.hi or sides > wanted.hi):
        return True
    if turning and wanted and any(clause.kind in TURNS_OF for clause in turning):
        return False
    most = sum(inf if clause.count.hi is None else clause.count.hi for clause in turning)
    if turning and wanted and wanted.lo and most < wanted.lo:
        return True
    return bool(turning) and sides > most and not any(clause.kind in TURNS_OF for clause in turning)


def impossibility(brief: Brief) -> bool:
    """Returns True if the road is too large for a map of 250 m, or needs a length, grade or radius that no
    road may have.
    """
    turns = sum(clause.count.lo or 0 for clause in brief.clauses if clause.kind not in STRAIGHT_KINDS)
    if max(turns, brief.turns.lo or 0 if brief.turns else 0) > MOST_TURNS:
        return True
    if brief.length and (_bottom(brief.length) > 1500 or _top(brief.length) < 20):
        return True
    if (
        sum(_bottom(clause.length) * (clause.count.lo or 1) for clause in brief.clauses if clause.length)
        > 900
    ):
        return True
    things: list[Brief | Clause] = [brief, *_all_clauses(brief)]
    grades = [thing.incline for thing in things] + [brief.steepest]
    if any(grade and _bottom(grade) > STEEPEST for grade in grades):
        return True
    radii = [thing.radius for thing in things]
    return any(radius and _top(radius) < SMALLEST_RADIUS for radius in radii)


def _all_clauses(brief: Brief) -> list[Clause]:
    return [*brief.clauses, *(clause for clause in (brief.starts, brief.ends) if clause)]


def _way(slope: str | None) -> str | None:
    """Returns up, down or flat; None for nearly flat."""
    if slope is None or slope == "nearly_flat":
        return None
    return slope.split("_")[-1]


def _bottom(amount: Amount) -> float:
    return amount.lo if amount.lo is not None else 0.0


def _top(amount: Amount) -> float:
    return amount.hi if amount.hi is not None else inf
