"""Chooses the lanes of the roads of a route, within what is required of them."""

from collections.abc import Sequence
from math import inf

from roadgpt.brief.amount import Amount, at_least, between, span
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause
from roadgpt.brief.lane_sequence import LEAST_LANE, WIDE_IN_TAPER
from roadgpt.brief.model import Brief
from roadgpt.brief.words import MOST_LANES, ROAD, Range, nearest
from roadgpt.network.crossing_lanes import USUALLY_FED
from roadgpt.network.design import PlaceDesign
from roadgpt.network.lane_design import (
    ACCELERATION,
    RAMP_TAPER,
    TAPER,
    LanesChangeDesign,
    LanesDesign,
    RampDesign,
    narrow_part,
)

ON_MOTORWAY = 2  # lanes of a carriageway whose number of lanes is not said
LEAST_TAPER = 10.0  # m
MOST_IN_TAPER = 0.6  # of the required length of a road at whose ends lanes end or begin
LEAST_BESIDE = 20.0  # m, of a lane for acceleration or deceleration whose length is not said
SHORT_ROAD = 30.0  # m, of a road before or behind a ramp
SHORTEST_PART = 12.0  # m, of a road before or behind a place where lanes change
USUAL_ROAD = 90.0  # m, of a road whose length is not said
DIAGONAL = 1.25  # times the side of the map, that a straight route can be long
EDGES = 40.0  # m, kept free at the edges of the map
STEP = 50.0  # m, to which the side of the map is rounded up
SLACK = 1.0  # m more than the least length that is required
CHANGE = (40.0, 80.0)  # m, of a road in whose middle the lane is changed, if its length is not said
WITHIN = 0.97  # of the greatest length that is allowed, for lengths without a least one
CLOSE = 0.5  # of the slack of a required length, within which roads are drafted


def drawn_ramp(asked: JunctionClause, room: float) -> RampDesign:
    """Returns a merge or an exit that meets its requirements, with traffic on the right.

    Args:
        asked: the requirements.
        room: greatest length in metres of its additional lane with the taper, if no length is required.
    """
    assert asked.kind in RAMPS
    taper = RAMP_TAPER if asked.taper is None else _length(asked.taper) / (1 - WIDE_IN_TAPER)
    length = min(ACCELERATION, max(room - taper, LEAST_BESIDE))
    if asked.length is not None:
        length = max(_length(asked.length) - WIDE_IN_TAPER * taper, LEAST_LANE)
    return RampDesign(
        after=1,
        kind="merge" if asked.kind == "merge" else "diverge",
        take="main" if asked.take == "main" else "ramp",
        length=round(length, 1),
        taper=round(taper, 1),
        side="left" if asked.side == "left" else None,
    )


def drawn_change(asked: JunctionClause, around: Sequence[Brief]) -> LanesChangeDesign:
    """Returns a place where lanes change that meets its requirements.

    Args:
        asked: the requirements.
        around: those for the roads before and behind it; a short road has no room for the usual taper.
    """
    side = asked.take or asked.side or "right"
    room = MOST_IN_TAPER * min(span(road.length).hi for road in around)
    length = max(min(TAPER, room), LEAST_TAPER) if asked.length is None else _length(asked.length)
    return LanesChangeDesign.model_validate(
        {"after": 1, "kind": asked.kind, "side": side, "length": round(length, 1)}
    )


def _length(asked: Amount) -> float:
    low, high = span(asked).lo, span(asked).hi
    if asked.exact:
        return low
    return WITHIN * high if low <= 0 else min(low + SLACK, high)


def counted_from_lanes(brief: Brief, places: Sequence[PlaceDesign], width: float) -> list[Brief]:
    """Returns the requirements for the roads of a route, with the lengths that the roads themselves need.

    Required lengths count from where a lane ends or begins, which is where it is ``LEAST_WIDTH`` wide, while
    roads meet where its taper ends or begins. The lane is changed in the middle of the road behind such a
    place, so this road gets a length if only that of the road before it is required.

    Args:
        brief: the requirements.
        places: what the route passes.
        width: width in metres of each lane.
    """
    roads = list(brief.roads)
    for n, place in enumerate(places):
        if not isinstance(place, LanesChangeDesign):
            continue
        before, behind = (road.length for road in brief.roads[n : n + 2])
        if place.kind != "lane_change":
            more = narrow_part(place.length, width) * (1 if place.kind == "lane_drop" else -1)
            roads[n], roads[n + 1] = _longer(roads[n], more), _longer(roads[n + 1], -more)
        elif before is not None and behind is None:
            least, most = CHANGE
            own = min(max(span(before).lo, least), most)
            roads[n] = _longer(roads[n], -own / 2)
            roads[n + 1] = roads[n + 1].model_copy(update={"length": between(own - SLACK, own + SLACK)})
    return roads


def _longer(road: Brief, more: float) -> Brief:
    """Returns the requirements for a road; if its length is required, it is ``more`` metres longer."""
    if road.length is None:
        return road
    low, high = span(road.length).lo, span(road.length).hi
    if road.length.exact:
        slack = CLOSE * ROAD["length"].slack(low)
        low, high = low - slack, high + slack
    low = max(low + more, SHORTEST_PART)
    length = at_least(low) if high == inf else between(low, max(high + more, low + SLACK))
    return road.model_copy(update={"length": length})


def lanes_of_roads(brief: Brief, width: float) -> list[LanesDesign]:
    """Returns the lanes of each road of a route, before, between and behind its junctions.

    Where nothing is required, a road has one lane in each direction, and what a ramp joins or leaves is one
    carriageway of a motorway. A road that leads on straight across a junction has as many as before it; so
    has one behind a turn if the lanes of both directions are required before it.

    Args:
        brief: the requirements.
        width: width in metres of each lane.
    """
    roads = _continued(brief)
    forward = _forward(roads, brief.junctions)
    has_ramps = any(junction.kind in RAMPS for junction in brief.junctions)
    found = []
    for count, road in zip(forward, roads, strict=True):
        one_way = (has_ramps or road.motorway) and not road.divided
        backward = 0 if one_way else count if road.divided else 1
        if road.against is not None:
            backward = int(_nearest(road.against, backward, 0))
        found.append(
            LanesDesign(
                forward=count, backward=backward, width=width, centre=road.centre, divided=road.divided
            )
        )
    return found


def _continued(brief: Brief) -> list[Brief]:
    """Returns the requirements for the roads. Where those for lanes are left open, they are those of the road
    before if that keeps its lanes across the junction; and those of a road that continues it, if that has so
    many lanes that fewer would lead nowhere.
    """
    roads, places = list(brief.roads), brief.junctions
    for n, place in enumerate(places):
        if _is_one_road(place):
            roads[n + 1] = _of_same_road(roads[n], roads[n + 1])
    for n, place in reversed(list(enumerate(places))):
        if _is_one_road(place):
            roads[n] = _of_same_road(roads[n + 1], roads[n])
    for n, place in enumerate(places):
        following = places[n + 1].kind if n + 1 < len(places) else None
        if _keeps_lanes(place, roads[n]) and following not in (*RAMPS, "roundabout"):
            roads[n + 1] = _with_same_lanes(roads[n], roads[n + 1])
    for n, place in enumerate(places):
        if _leads_on(place) and (n + 1 == len(places) or places[n + 1].kind != "roundabout"):
            roads[n + 1] = _with_lanes_of(roads[n], roads[n + 1])
    for n, place in reversed(list(enumerate(places))):
        if _leads_on(place) and (n == 0 or places[n - 1].kind not in (*RAMPS, *LANE_KINDS, "roundabout")):
            roads[n] = _with_lanes_of(roads[n + 1], roads[n])
    return roads


def _is_one_road(place: JunctionClause) -> bool:
    """Returns whether the roads before and behind a place are the same road, with other lanes at most."""
    return place.kind in LANE_KINDS or (place.kind in RAMPS and place.take == "main")


def _of_same_road(known: Brief, road: Brief) -> Brief:
    """Returns the requirements for a part of a road; what is left open is as on another part of it."""
    says_against = road.against is not None or road.divided
    return road.model_copy(
        update={
            "against": road.against if says_against else known.against,
            "divided": road.divided if says_against else known.divided,
            "centre": known.centre if road.centre is None else road.centre,
            "motorway": known.motorway or road.motorway,
        }
    )


def _leads_straight_on(place: JunctionClause) -> bool:
    return place.take == "straight" and place.kind != "roundabout"


def _keeps_lanes(place: JunctionClause, road: Brief) -> bool:
    """Returns whether a road behind a junction of which nothing is required has the lanes of the road before.

    One that leads straight on has; one behind a turn only if the lanes of both directions are required.
    """
    is_said = road.lanes is not None and road.against is not None and span(road.against).hi > 0
    turns = place.take in ("left", "right") and place.kind in ("t_junction", "crossroads", "junction")
    return _leads_straight_on(place) or (turns and is_said)


def _with_same_lanes(known: Brief, road: Brief) -> Brief:
    """Returns the requirements for a road, with the lanes and the median of another one if nothing is
    required of its own, and if they leave room for the centre line that is required.
    """
    has_lanes = road.lanes is not None or road.against is not None or road.divided or road.motorway
    has_no_centre = known.divided or (known.against is not None and span(known.against).hi == 0)
    if has_lanes or (road.centre is not None and has_no_centre):
        return road
    update = {name: getattr(known, name) for name in ("lanes", "against", "divided")}
    return road.model_copy(update=update)


def _leads_on(place: JunctionClause) -> bool:
    """Returns whether the lanes of the road before a junction lead to those of the road behind it."""
    return place.kind == "y_junction" or _leads_straight_on(place)


def _with_lanes_of(known: Brief, road: Brief) -> Brief:
    """Returns the requirements for a road, with those for lanes of another one where they are left open."""
    against = known.lanes if known.divided and known.against is None else known.against
    update = {
        name: amount
        for name, amount in (("lanes", known.lanes), ("against", against))
        if getattr(road, name) is None and amount is not None and span(amount).lo > USUALLY_FED
    }
    return road.model_copy(update=update)


def _forward(roads: Sequence[Brief], places: Sequence[JunctionClause]) -> list[int]:
    """Returns the number of lanes in the direction of the route on each road."""
    found: list[int] = []
    for n, road in enumerate(roads):
        before = places[n - 1] if n else None
        usual = _behind(before, found[-1], roads, n, places) if before else _first(roads, places)
        found.append(int(_nearest(road.lanes, usual, 1)) if road.lanes is not None else usual)
    return found


def _first(roads: Sequence[Brief], places: Sequence[JunctionClause]) -> int:
    """Returns the number of lanes of the first road, if it is not said: what the next places need."""
    more = 0
    for n, (place, road) in enumerate(zip(places, roads[1:], strict=False)):
        if place.kind in RAMPS:
            return max(_where_ramps_are(places[n:]), 1 + more)
        if place.kind == "lane_change":
            return max(2, 1 + more)
        if place.kind not in ("lane_drop", "lane_gain"):
            break
        more += 1 if place.kind == "lane_drop" else -1
        if road.lanes is not None:
            return max(1, int(_nearest(road.lanes, 1, 1)) + more)
    return max(1, 1 + more)


def _where_ramps_are(places: Sequence[JunctionClause]) -> int:
    """Returns the usual number of lanes of a carriageway: one if it is the ramp of the next merge, or of one
    that comes after ramps which the route passes on the main road.
    """
    for place in places:
        if place.kind not in RAMPS or place.take != "main":
            return 1 if place.kind == "merge" else ON_MOTORWAY
    return ON_MOTORWAY


def _behind(
    place: JunctionClause, before: int, roads: Sequence[Brief], n: int, places: Sequence[JunctionClause]
) -> int:
    if place.kind == "lane_drop":
        return max(before - 1, 1)
    if place.kind == "lane_gain":
        return min(before + 1, MOST_LANES)
    if place.kind == "lane_change" or (place.kind in RAMPS and place.take == "main"):
        return before
    if place.kind == "merge":
        return _where_ramps_are(places[n:])
    if place.kind == "diverge":
        return 1
    return _first(roads[n:], places[n:]) if roads[n].lanes is None else before


def _nearest(asked: Amount, usual: int, least: int) -> float:
    """Returns the number that is allowed and nearest to the usual one."""
    return nearest(usual, span(asked), Range(least, MOST_LANES))
