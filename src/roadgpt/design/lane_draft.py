"""Chooses the lanes of the roads of a route, within the requirements for them. Requirements go on to the next
part of a route where the words leave that part open."""

from collections.abc import Sequence
from math import inf

from roadgpt.brief.amount import Amount, at_least, between, span
from roadgpt.brief.junction_check import LEAST_BESIDE_RAMP, LEAST_LANE, WIDE_IN_TAPER
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause
from roadgpt.brief.model import Brief, exactly
from roadgpt.brief.ranges import Range, nearest
from roadgpt.brief.words import MOST_LANES, ROAD
from roadgpt.network.crossing import USUALLY_FED
from roadgpt.network.design import (
    ACCELERATION,
    RAMP_TAPER,
    TAPER,
    LanesChangeDesign,
    LanesDesign,
    PlaceDesign,
    RampDesign,
    narrow_part,
)
from roadgpt.network.ring import MOST_LANES as MOST_RING_LANES

LANES = ("lanes", "against", "divided", "centre", "motorway", "length")
"""Requirements that leave the shape of a road open."""
GRADES = ("slope", "incline")
ON_MOTORWAY = 2  # lanes of a carriageway of a motorway, if no number is required
LEAST_TAPER = 10.0  # m
MOST_IN_TAPER = 0.6  # greatest share of the required length of a road that a taper takes
LEAST_BESIDE = 20.0  # m, least length of an acceleration or deceleration lane, if none is required
SHORT_ROAD = 30.0  # m, least length of a road before or behind a ramp
SHORTEST_PART = 12.0  # m, least length of a road before or behind a place where lanes change
SLACK = 1.0  # m by which a length exceeds the least one that is required
CHANGE = (40.0, 80.0)  # m, length of a road in whose middle the car changes lanes, if none is required
WITHIN = 0.97  # share of the greatest length allowed that is taken if no least length is required
CLOSE = 0.5  # share of the tolerance of a required length that drafts may use


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
    nothing else is required of the next part. Under the same condition, a road without turns also stays
    without turns behind a junction where the route goes straight on."""
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
    update = {name: Brief.model_fields[name].default for name in apart}
    return road.model_copy(update=update).is_open


def drawn_ramp(asked: JunctionClause, room: float) -> RampDesign:
    """Returns a merge or an exit that meets its requirements, with traffic on the right.

    ``room`` is the length in metres that is available for the acceleration or deceleration lane with its
    taper. If no length is required, the lane is made to fit, but is at least 20 m long without its taper. If
    no length of the taper is required, it is shorter than usual where the lane would otherwise not fit."""
    assert asked.kind in RAMPS
    wide = LEAST_BESIDE_RAMP + SLACK if asked.length is None else _length(asked.length)
    taper = min(RAMP_TAPER, max((room - wide) / (1 - WIDE_IN_TAPER), LEAST_TAPER))
    if asked.taper is not None:
        taper = _length(asked.taper) / (1 - WIDE_IN_TAPER)
    length = min(ACCELERATION, max(room - taper, LEAST_BESIDE, wide - WIDE_IN_TAPER * taper))
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


def with_side_of_change(places: Sequence[JunctionClause], number: int) -> JunctionClause:
    """Returns what is required of a place. If the side of a lane is open, a lane change beside the place sets
    it: a lane begins on the side to which the car then changes, and ends on the side that the car has left.
    """
    place = places[number]
    before = places[number - 1] if number else None
    behind = places[number + 1] if number + 1 < len(places) else None
    if place.side is not None:
        return place
    if place.kind == "lane_gain" and behind is not None and behind.kind == "lane_change":
        return place.model_copy(update={"side": behind.take})
    if place.kind == "lane_drop" and before is not None and before.kind == "lane_change" and before.take:
        return place.model_copy(update={"side": "left" if before.take == "right" else "right"})
    return place


def drawn_change(asked: JunctionClause, around: Sequence[Brief]) -> LanesChangeDesign:
    """Returns a place where a lane ends, begins or is changed, which meets its requirements. ``around`` are
    the requirements for the roads before and behind the place. If one of these roads has to be short, the
    taper is shorter than usual."""
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
    """Returns the requirements for the roads of a route, with lengths measured between the ends of the roads.

    The Brief measures lengths from where a lane that ends or begins is ``LEAST_WIDTH`` wide. The roads,
    however, meet where the lane's taper ends or begins. A car changes lanes in the middle of the road behind
    the place of a ``lane_change``. If only the road before this place has a required length, the Brief
    measures this length up to the lane change, and the road behind gets a length of 40 to 80 m. ``width`` is
    that of each lane in metres."""
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

    Where nothing is required, a road has one lane in each direction. A motorway is a one-way carriageway
    instead. So is each road between a merge or an exit and the nearest junctions of other kinds. A one-way
    carriageway has one lane on a ramp, and usually two elsewhere.

    If no lanes are required for a road behind a junction, it usually gets the lanes of the road before the
    junction if the route leads straight on. If the route turns, it gets these lanes only if the lanes of both
    directions are required for the road before the junction. Each lane is ``width`` metres wide."""
    roads = _continued(brief)
    forward = _forward(roads, brief.junctions)
    found = []
    for count, road, leads_to_ramp in zip(forward, roads, _on_ramps(brief.junctions), strict=True):
        one_way = (leads_to_ramp or road.motorway) and not road.divided
        backward = 0 if one_way else count if road.divided else 1
        if road.against is not None:
            backward = int(_nearest(road.against, backward, 0))
        found.append(
            LanesDesign(
                forward=count, backward=backward, width=width, centre=road.centre, divided=road.divided
            )
        )
    return found


def main_roads(places: Sequence[JunctionClause]) -> set[int]:
    """Returns the numbers of the roads of a route that a ramp joins or leaves."""
    return {n + (place.kind == "merge") for n, place in enumerate(places) if place.kind in RAMPS}


def _on_ramps(places: Sequence[JunctionClause]) -> list[bool]:
    """Returns for each road of a route whether the route passes a ramp between the crossings around it:
    junctions that are no merge and no exit, where other roads begin."""
    found: list[bool] = []
    roads, has_ramp = 1, False
    for place in places:
        if place.kind in RAMPS or place.kind in LANE_KINDS:
            roads, has_ramp = roads + 1, has_ramp or place.kind in RAMPS
            continue
        found += [has_ramp] * roads
        roads, has_ramp = 1, False
    return found + [has_ramp] * roads


def _continued(brief: Brief) -> list[Brief]:
    """Returns the requirements for the roads, with requirements for lanes where the Brief leaves these open.
    They are taken from the road before if its lanes continue across the junction, or from a neighbouring road
    with so many lanes that some of them would otherwise lead nowhere."""
    roads, places, on_ramps = list(brief.roads), brief.junctions, _on_ramps(brief.junctions)
    for n, place in enumerate(places):
        if is_one_road(place):
            roads[n + 1] = _of_same_road(roads[n], roads[n + 1], place)
        elif leads_straight_on(place) and _may_have_centre(roads[n + 1]) and not on_ramps[n + 1]:
            roads[n + 1] = roads[n + 1].model_copy(update={"centre": roads[n].centre})
    for n, place in reversed(list(enumerate(places))):
        if is_one_road(place):
            roads[n] = _of_same_road(roads[n + 1], roads[n], place)
    for n, place in enumerate(places):
        leads_to = places[n + 1] if n + 1 < len(places) else None
        if _keeps_lanes(place, roads[n]) and (leads_to is None or _can_take(leads_to, roads[n])):
            roads[n + 1] = _with_same_lanes(roads[n], roads[n + 1])
    for n, place in enumerate(places):
        if _leads_on(place) and (n + 1 == len(places) or places[n + 1].kind != "roundabout"):
            roads[n + 1] = _with_lanes_of(roads[n], roads[n + 1])
    for n, place in reversed(list(enumerate(places))):
        if _leads_on(place) and (n == 0 or places[n - 1].kind not in (*RAMPS, *LANE_KINDS, "roundabout")):
            roads[n] = _with_lanes_of(roads[n + 1], roads[n])
    return roads


def _may_have_centre(road: Brief) -> bool:
    """Returns whether the requirements leave the centre line of a road open, and the road can have one."""
    is_one_way = road.against is not None and span(road.against).hi == 0
    return road.centre is None and not (is_one_way or road.divided or road.motorway)


def _of_same_road(known: Brief, road: Brief, place: JunctionClause) -> Brief:
    """Returns the requirements for a part of a road; what is left open is as on another part of it. The
    number of lanes along the road is left open as well if ``place``, which is between the parts, changes it.
    """
    says_against = road.against is not None or road.divided
    keeps_lanes = place.kind in (*RAMPS, "lane_change") and road.lanes is None
    return road.model_copy(
        update={
            "lanes": known.lanes if keeps_lanes else road.lanes,
            "against": road.against if says_against else known.against,
            "divided": road.divided if says_against else known.divided,
            "centre": known.centre if road.centre is None else road.centre,
            "motorway": known.motorway or road.motorway,
        }
    )


def _keeps_lanes(place: JunctionClause, road: Brief) -> bool:
    """Returns whether a road behind a junction keeps the lanes of the road before if it requires none itself.
    It does if the route leads straight on, or if the route turns and ``road``, the road before, requires the
    lanes of both directions. A roundabout must have a ring that may have so many lanes."""
    is_said = road.lanes is not None and road.against is not None and span(road.against).hi > 0
    if place.kind == "roundabout":
        return (place.take == "straight" or is_said) and _can_take(place, road)
    turns = place.take in ("left", "right") and place.kind in ("t_junction", "crossroads", "junction")
    return leads_straight_on(place) or (turns and is_said)


def _can_take(place: JunctionClause, road: Brief) -> bool:
    """Returns whether a road with the lanes of ``road`` may lead to a junction; a ramp is a road of its own,
    and a roundabout needs as many lanes."""
    if place.kind != "roundabout":
        return place.kind not in RAMPS
    is_open = place.lanes is None and place.radius is None and place.outer is None and place.size != "mini"
    return is_open and span(road.lanes).lo <= MOST_RING_LANES


def _with_same_lanes(known: Brief, road: Brief) -> Brief:
    """Returns the requirements for a road. If it requires no lanes, it gets the lanes and the median of
    ``known``, unless it requires a centre line and ``known`` has none. A one-way road gets the lanes of a
    one-way road."""
    if road.against is not None and road.against == known.against and road.lanes is None:
        return road.model_copy(update={"lanes": known.lanes})
    has_lanes = road.lanes is not None or road.against is not None or road.divided or road.motorway
    has_no_centre = known.divided or (known.against is not None and span(known.against).hi == 0)
    if has_lanes or (road.centre is not None and has_no_centre):
        return road
    update = {name: getattr(known, name) for name in ("lanes", "against", "divided")}
    return road.model_copy(update=update)


def _leads_on(place: JunctionClause) -> bool:
    """Returns whether the lanes of the road before a junction lead to those of the road behind it."""
    return place.kind == "y_junction" or leads_straight_on(place)


def _with_lanes_of(known: Brief, road: Brief) -> Brief:
    """Returns the requirements for a road. Where these leave lanes open, the lanes of ``known`` are taken if
    there are more than two."""
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
    """Returns the usual number of lanes of a carriageway before ``places``: one if it is the ramp of a merge.
    Ramps that the route passes on the main road are skipped."""
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
