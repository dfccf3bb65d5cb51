"""Exchanges left and right in requirements.

Traffic on the left is the mirror image of traffic on the right: a route with traffic on the left meets a
Brief exactly if the mirror image of the route meets the mirrored Brief.
"""

from typing import get_args

from roadgpt.brief.junctions import JunctionClause, Take
from roadgpt.brief.model import OTHER_SIDE, Brief, Clause

OTHER_TAKE: dict[Take, Take] = {
    take: other
    for take in get_args(Take)
    for other in get_args(Take)
    if take.replace("left", "?").replace("right", "left").replace("?", "right") == other
}


def mirrored(brief: Brief) -> Brief:
    """Returns the same requirements with left and right exchanged, and with traffic on the other side.

    The numbers of exits stay, because exits are counted in the direction in which traffic drives around a
    roundabout. ``map`` also stays as it is.
    """
    whole = _with_other_sides(brief)
    return whole.model_copy(
        update={
            "junctions": tuple(map(_junction, brief.junctions)),
            "stretches": tuple(map(_with_other_sides, brief.stretches)),
            "left_hand": not brief.left_hand,
        }
    )


def _with_other_sides(road: Brief) -> Brief:
    """Returns the requirements for a road without junctions, with left and right exchanged."""
    return road.model_copy(
        update={
            "clauses": tuple(map(_clause, road.clauses)),
            "starts": None if road.starts is None else _clause(road.starts),
            "ends": None if road.ends is None else _clause(road.ends),
            "left": road.right,
            "right": road.left,
        }
    )


def _clause(clause: Clause) -> Clause:
    return clause if clause.side is None else clause.model_copy(update={"side": OTHER_SIDE[clause.side]})


def _junction(junction: JunctionClause) -> JunctionClause:
    update: dict[str, object] = {
        name: tuple("straight" if way == "straight" else OTHER_SIDE[way] for way in getattr(junction, name))
        for name in ("ways", "only_in", "only_out")
    }
    update |= {
        "take": None if junction.take is None else OTHER_TAKE[junction.take],
        "side": None if junction.side is None else OTHER_SIDE[junction.side],
    }
    # made anew, because the ways are kept in a fixed order
    return JunctionClause.model_validate({**junction.model_dump(), **update})
