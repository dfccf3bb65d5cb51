"""Finds contradictions and impossible requirements in the junctions of a Brief, and says what to change."""

from typing import TYPE_CHECKING

from roadgpt.brief.amount import Amount, span
from roadgpt.brief.junctions import ARMS, SIZES, JunctionClause, JunctionKind, Way
from roadgpt.brief.words import Range, overlap
from roadgpt.errors import BriefError

if TYPE_CHECKING:
    from roadgpt.brief.model import Brief

POSSIBLE: dict[JunctionKind, tuple[str, ...]] = {
    "t_junction": ("left", "right", "straight"),
    "y_junction": ("left", "right"),
    "crossroads": ("left", "right", "straight"),
}
"""The ways on that a kind of junction has; every way on is possible at the others."""
CIRCULATORY = 10.0  # m, by which the outer diameter of a roundabout exceeds that of its island, about


def check_junction(junction: JunctionClause) -> None:
    """Checks whether a junction can meet its requirements.

    Raises:
        BriefError: It cannot; the message says what to change.
    """
    name, possible = junction.name, ARMS[junction.kind]
    is_ring = junction.kind == "roundabout"
    arms = overlap(possible, span(junction.arms))
    if arms is None or arms.lo > arms.hi:
        raise BriefError(f"a {name} has {possible} arms, not {junction.arms}; change one of them")
    if junction.take is not None and junction.exit is not None:
        raise BriefError(f"at a {name}, a direction and an exit number are given; leave one of them out")
    _check_take(junction, name)
    if not is_ring:
        for field in ("size", "radius", "exit"):
            if getattr(junction, field) is not None:
                raise BriefError(f"a {name} has no {field}, only a roundabout has; leave it out")
    elif junction.exit is not None:
        _check_exit(junction.exit, arms)
    if junction.skew and junction.kind != "crossroads":
        raise BriefError(f"only crossroads are skew, not a {name}; leave it out")
    if junction.size is not None and junction.radius is not None:
        island = span(junction.radius)
        outer = Range(2 * island.lo + CIRCULATORY, 2 * island.hi + CIRCULATORY)
        both = overlap(outer, SIZES[junction.size])
        if both is None or both.lo > both.hi:
            raise BriefError(
                f"a {junction.size} roundabout is {SIZES[junction.size]} m wide; with a radius of "
                f"{junction.radius} m it is not; leave one of them out"
            )


def check_turning_back(brief: "Brief") -> None:
    """Checks that a route ends after it has turned back at a roundabout.

    Raises:
        BriefError: A junction, or requirements for a road, follow.
    """
    backs = [n for n, junction in enumerate(brief.junctions) if junction.take == "back"]
    if backs and (backs[0] < len(brief.junctions) - 1 or not brief.stretches[-1].is_open):
        raise BriefError(
            "a route that turns back at a roundabout ends on the road on which it came; leave out what "
            "follows"
        )


def _check_take(junction: JunctionClause, name: str) -> None:
    take, ways = junction.take, junction.ways
    possible = POSSIBLE.get(junction.kind)
    if take == "back" and junction.kind != "roundabout":
        raise BriefError(f"one cannot turn back at a {name}, only at a roundabout; leave it out")
    if take is not None and possible is not None and take not in (*possible, "back"):
        raise BriefError(f"at a {name} one can go {' or '.join(possible)}, not {take}; change one of them")
    if not ways:
        return
    arms = ARMS[junction.kind]
    needed = Range(arms.lo - 1, arms.hi - 1)
    if len(ways) not in needed or len(set(ways)) != len(ways) or (possible and not {*ways} <= {*possible}):
        raise BriefError(f"a {name} has {needed} different ways on, other than {' and '.join(ways)}")
    if take in ("left", "right", "straight") and take not in ways:
        raise BriefError(f"a {name} with ways on {_said(ways)} has none {take}; change one of them")


def _said(ways: tuple[Way, ...]) -> str:
    return " and ".join(ways)


def _check_exit(number: Amount, arms: Range) -> None:
    exits = span(number)
    if exits.lo > arms.hi or exits.hi < 1:
        raise BriefError(
            f"a roundabout with {arms} arms has no exit {number}; its last exit leads back to where one came "
            "from"
        )
