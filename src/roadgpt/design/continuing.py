"""Carries requirements on to the next part of a route where the words leave that part open."""

from roadgpt.brief.amount import span
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause
from roadgpt.brief.model import Brief, exactly

LANES = ("lanes", "against", "divided", "centre", "motorway", "length")
"""Requirements that leave the shape of a road open."""
GRADES = ("slope", "incline")


def is_one_road(place: JunctionClause) -> bool:
    """Returns whether the roads before and behind a place are one road, whose lanes may change there."""
    return place.kind in LANE_KINDS or (place.kind in RAMPS and place.take == "main")


def leads_straight_on(place: JunctionClause) -> bool:
    """Returns whether the route is required to go straight on at a junction that is no roundabout."""
    return place.take == "straight" and place.kind != "roundabout"


def with_roads_continued(brief: Brief) -> Brief:
    """Returns the requirements for a route, in which a road continues as it was before.

    A motorway stays a motorway past its ramps and where only its lanes change, so that no part is drafted
    with tight bends or steep grades. In such places, other roads keep their slope, and stay without turns, if
    nothing else is required of the next part. Under the same condition, a road without turns also
    stays without turns behind a junction where the route goes straight on.
    """
    roads = list(brief.stretches)
    one_road = [n for n, place in enumerate(brief.junctions) if is_one_road(place)]
    for n in (*one_road, *reversed(one_road)):
        if roads[n].motorway or roads[n + 1].motorway:
            roads[n : n + 2] = [road.model_copy(update={"motorway": True}) for road in roads[n : n + 2]]
    for n, place in enumerate(brief.junctions):
        if is_one_road(place):
            roads[n + 1] = _with_slope_of(roads[n], roads[n + 1])
        if is_one_road(place) or leads_straight_on(place):
            roads[n + 1] = _as_straight_as(roads[n], roads[n + 1])
    return brief.model_copy(update={"stretches": tuple(roads)})


def _with_slope_of(known: Brief, road: Brief) -> Brief:
    is_open = _leaves_open(road, LANES) and not known.clauses
    return road.model_copy(update={"slope": known.slope}) if is_open else road


def _as_straight_as(known: Brief, road: Brief) -> Brief:
    is_straight = known.turns is not None and span(known.turns).hi == 0
    if not is_straight or not _leaves_open(road, (*LANES, *GRADES)):
        return road
    return road.model_copy(update={"turns": exactly(0)})


def _leaves_open(road: Brief, apart: tuple[str, ...]) -> bool:
    """Returns whether a road has no requirements apart from those named."""
    update = {name: Brief.model_fields[name].default for name in apart}
    return road.model_copy(update=update).is_open
