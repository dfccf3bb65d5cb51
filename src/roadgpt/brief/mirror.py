"""Exchanges left and right in requirements.

Traffic on the left is the mirror image of traffic on the right: a route with traffic on the left meets a
Brief exactly if the mirror image of the route meets the mirrored Brief.
"""

from typing import get_args

from roadgpt.brief.junctions import JunctionClause, Take
from roadgpt.brief.model import Brief, Clause

OTHER: dict[str | None, str | None] = {
    None: None,
    **{
        take: take.replace("left", "?").replace("right", "left").replace("?", "right")
        for take in get_args(Take)
    },
}
"""Every side, way and take, with its mirror image."""


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
            "starts": road.starts and _clause(road.starts),
            "ends": road.ends and _clause(road.ends),
            "left": road.right,
            "right": road.left,
        }
    )


def _clause(clause: Clause) -> Clause:
    return clause.model_copy(update={"side": OTHER[clause.side]})


def _junction(junction: JunctionClause) -> JunctionClause:
    lists = {
        name: tuple(OTHER[way] for way in getattr(junction, name)) for name in ("ways", "only_in", "only_out")
    }
    sides = {"take": OTHER[junction.take], "side": OTHER[junction.side]}
    # made anew, because the ways are kept in a fixed order
    return JunctionClause.model_validate({**junction.model_dump(), **lists, **sides})
