"""Finds the criteria that a description mentions, about which raters are asked: turns, incline, order."""

from roadgpt.brief.model import Amount, Brief, Clause

STRAIGHTS = frozenset({"straight", "crest", "dip"})
HAVE_NO_NUMBER = frozenset({"serpentine", "zigzag", "slalom", "winding"})
RISES = frozenset({"crest", "dip"})


def criteria_of(brief: Brief | None) -> tuple[str, ...]:
    """Returns the criteria that a description mentions.

    It is empty for a general description such as "a road", which is rated only as a whole, as in the thesis.
    """
    if brief is None:
        return ()
    clauses = [*brief.clauses, *filter(None, (brief.starts, brief.ends))]
    counts = any(map(_is_a_number, (brief.turns, brief.left, brief.right))) or any(
        map(_has_a_number, clauses)
    )
    rises = bool(brief.slope or brief.incline or brief.steepest or brief.climb or brief.hills) or any(
        clause.slope or clause.incline or clause.kind in RISES for clause in clauses
    )
    return (
        *(["turns"] if counts else []),
        *(["incline"] if rises else []),
        *(["order"] if len(clauses) > 1 else []),
    )


def _is_a_number(turns: Amount | None) -> bool:
    """Returns whether an amount says more than that there is a turn, as on any road."""
    return turns is not None and (turns.lo, turns.hi) != (1, None)


def _has_a_number(clause: Clause) -> bool:
    """Returns whether a clause says how many turns there are."""
    if clause.kind in STRAIGHTS:
        return False
    return clause.kind not in HAVE_NO_NUMBER or clause.count.lo != 1 or clause.count.hi != 1
