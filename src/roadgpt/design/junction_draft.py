"""Draws what a route passes (junctions, ramps, places where lanes change) and the lanes of its roads, within
the requirements for them. Requirements go on to the next part of a route where the words leave that part
open."""

from collections.abc import Collection, Sequence
from itertools import pairwise
from math import ceil, inf, pi
from typing import Literal, cast

import numpy as np

from roadgpt.brief.amount import Amount, at_least, between, exactly, span
from roadgpt.brief.junction_check import (
    ANGLES,
    FORK_GAPS,
    LEAST_BESIDE_RAMP,
    LEAST_LANE,
    MOST_ARMS_OF_MINI,
    TURN_LENGTHS,
    WIDE_IN_TAPER,
)
from roadgpt.brief.junctions import (
    ARMS,
    LANE_KINDS,
    RAMPS,
    RINGS,
    SIDE,
    SIZES,
    JunctionClause,
    bends_as,
    is_about,
    side_of,
)
from roadgpt.brief.model import (
    LEAST_BEFORE_CHANGE,
    Brief,
    counts_to_change,
    is_one_road,
    motorways_continued,
    rest_of_route,
)
from roadgpt.brief.ranges import Range, nearest, overlap
from roadgpt.brief.words import MOST_LANES, ROAD
from roadgpt.language.names import JunctionKind, PlainKind
from roadgpt.language.table import ROADS
from roadgpt.network.building import BETWEEN, MOUTH, TURN_TAPER, USUALLY_FED, ring_width, smallest_radius
from roadgpt.network.building import MOST_LANES as MOST_RING_LANES
from roadgpt.network.growing import BEFORE_TURN_LANES, controls_of
from roadgpt.road.design import (
    ACCELERATION,
    ASTERN,
    RAMP_TAPER,
    TAPER,
    ArmDesign,
    JunctionDesign,
    LanesChangeDesign,
    LanesDesign,
    PlaceDesign,
    RampDesign,
    narrow_part,
)

LANES = ("lanes", "against", "divided", "centre", "motorway", "length")
"""Requirements that leave the shape of a road open."""
GRADES = ("slope", "incline")
KEEPS_LANES = ("lane_change", "crosswalk", "bus_bay")
ON_MOTORWAY = 2  # lanes of a carriageway of a motorway, if no number is required
LEAST_TAPER = 10.0  # m
MOST_IN_TAPER = 0.6  # greatest share of the required length of a road that a taper takes
LEAST_BESIDE = 20.0  # m, least length of an acceleration or deceleration lane, if none is required
SHORT_ROAD = 30.0  # m, least length of a road before or behind a ramp
SHORTEST_PART = LEAST_BEFORE_CHANGE
TURN_LENGTH = 30.0  # m, length of a turn lane that is wider than 0.9 of its width, if none is required
SLACK = 1.0  # m by which a length exceeds the least one that is required
CHANGE = (40.0, 80.0)  # m, length of a road in whose middle the car changes lanes, if none is required
WITHIN = 0.97  # share of the greatest length allowed that is taken if no least length is required
CLOSE = 0.5  # share of the tolerance of a required length that drafts may use


def leads_straight_on(place: JunctionClause) -> bool:
    """Returns whether the route is required to go straight on at a junction that is no roundabout."""
    return place.take == "straight" and place.kind != "roundabout"


def with_roads_continued(brief: Brief) -> Brief:
    """Returns the requirements for a route, in which a road continues as it was before.

    A motorway stays a motorway past its ramps and where only its lanes change, so that no part is drafted
    with tight bends or steep grades. In such places, other roads keep their slope, and stay without turns, if
    nothing else is required of the next part. Under the same condition, a road without turns also stays
    without turns behind a junction where the route goes straight on."""
    roads = motorways_continued(brief)
    one_road = [n for n, place in enumerate(brief.junctions) if is_one_road(place)]
    for n in (*one_road, *reversed(one_road)):
        if speed := roads[n].speed or roads[n + 1].speed:
            pair = roads[n : n + 2]
            roads[n : n + 2] = [each.model_copy(update={"speed": each.speed or speed}) for each in pair]
    for n, place in enumerate(brief.junctions):
        if is_one_road(place) and _leaves_open(roads[n + 1], LANES) and not roads[n].clauses:
            roads[n + 1] = roads[n + 1].model_copy(update={"slope": roads[n].slope})
        if is_one_road(place) or leads_straight_on(place):
            is_straight = roads[n].turns is not None and span(roads[n].turns).hi == 0
            if is_straight and _leaves_open(roads[n + 1], (*LANES, *GRADES)):
                roads[n + 1] = roads[n + 1].model_copy(update={"turns": exactly(0)})
    return brief.model_copy(update={"stretches": tuple(roads)})


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


def drawn_turn_length(asked: JunctionClause, road: Brief, width: float) -> float:
    """Returns the length in metres of turn lanes without their taper that meets the requirements, on a road
    of arrival with lanes of a width in metres. Usual turn lanes are shorter where the road is short."""
    taper = TURN_TAPER * width
    if asked.turn_length is not None:
        wide = _length(asked.turn_length)
    else:
        room = span(road.length).hi - BEFORE_TURN_LANES - (1 - WIDE_IN_TAPER) * taper
        wide = max(min(TURN_LENGTH, room - SLACK), TURN_LENGTHS.lo + SLACK)
    return round(max(wide - WIDE_IN_TAPER * taper, LEAST_TAPER), 1)


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
        {"after": 1, "kind": asked.kind, "side": side, "length": round(length, 1), "island": asked.island}
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
    measures this length up to the lane change, and the road behind gets a length of 40 to 80 m. Where lane
    changes have required distances, all these roads get the lengths that place the changes so. ``width`` is
    that of each lane in metres."""
    roads = list(brief.roads)
    for n, place in enumerate(places):
        if not isinstance(place, LanesChangeDesign):
            continue
        before = brief.roads[n].length
        if place.kind != "lane_change":
            more = narrow_part(place.length, width) * (1 if place.kind == "lane_drop" else -1)
            roads[n], roads[n + 1] = _longer(roads[n], more), _longer(roads[n + 1], -more)
            continue
        distances = _distances(brief, n)
        is_placed = n > 0 and places[n - 1].kind == "lane_change" and bool(_distances(brief, n - 1))
        if is_placed or not (distances or (before is not None and counts_to_change(brief, n))):
            continue
        rest = 2 * rest_of_route(brief, n)
        lengths = [rest] if rest else _lengths_of_changes(brief.roads[n : n + 2], distances)
        roads[n] = _longer(roads[n], -lengths[0] / 2)
        for k, own in enumerate(lengths, n + 1):
            roads[k] = roads[k].model_copy(update={"length": between(own - SLACK, own + SLACK)})
    return roads


def _distances(brief: Brief, number: int) -> list[float]:
    """Returns the required distances in metres from a lane change, place ``number``, to the next ones."""
    asked = _length_of(brief.roads[number + 1])
    following = brief.junctions[number + 1 : number + 2]
    is_next = any(place.kind == "lane_change" for place in following) and not brief.roads[number + 2].clauses
    if asked is None or not (is_next and counts_to_change(brief, number + 1)):
        return []
    return [_length(asked), *_distances(brief, number + 1)]


def _length_of(road: Brief) -> Amount | None:
    """Returns the required length of a road, or of the one straight of which it consists."""
    is_straight = len(road.clauses) == 1 and road.clauses[0].kind == "straight"
    return road.clauses[0].length if road.length is None and is_straight else road.length


def _lengths_of_changes(around: Sequence[Brief], distances: Sequence[float]) -> list[float]:
    """Returns the lengths in metres of the roads behind lane changes, in whose middles the changes lie.
    ``around`` are the requirements for the roads before and behind the first change, and ``distances`` those
    from each change to the next."""
    before, own = around[0].length, _length_of(around[1])
    if not distances:
        return [min(max(span(before).lo, CHANGE[0]), CHANGE[1]) if own is None else _length(own)]
    least = min(CHANGE[0], *distances)
    low, high = least, inf if before is None else max(2 * (span(before).lo - SHORTEST_PART), least)
    rest, sign = 0.0, 1
    for distance in distances:  # each road has the length rest + sign * first
        rest, sign = 2 * distance - rest, -sign
        low, high = (max(low, least - rest), high) if sign > 0 else (low, min(high, rest - least))
    lengths = [distances[0] if around[1].clauses else max(min(distances[0], high), low)]
    for distance in distances:
        lengths.append(2 * distance - lengths[-1])
    return lengths


def _longer(road: Brief, more: float) -> Brief:
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
    return road.centre is None and not (_is_one_way(road) or road.divided or road.motorway)


def _is_one_way(road: Brief) -> bool:
    return road.against is not None and span(road.against).hi == 0


def _of_same_road(known: Brief, road: Brief, place: JunctionClause) -> Brief:
    """Returns the requirements for a part of a road; what is left open is as on another part of it. The
    number of lanes along the road is left open as well if ``place``, which is between the parts, changes it.
    """
    says_against = road.against is not None or road.divided
    keeps_lanes = place.kind in (*RAMPS, *KEEPS_LANES) and road.lanes is None
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
    if has_lanes or (road.centre is not None and (known.divided or _is_one_way(known))):
        return road
    update = {name: getattr(known, name) for name in ("lanes", "against", "divided")}
    return road.model_copy(update=update)


def _leads_on(place: JunctionClause) -> bool:
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
    if place.kind in KEEPS_LANES or (place.kind in RAMPS and place.take == "main"):
        return before
    if place.kind == "merge":
        return _where_ramps_are(places[n:])
    if place.kind == "diverge":
        return 1
    return _first(roads[n:], places[n:]) if roads[n].lanes is None else before


def _nearest(asked: Amount, usual: int, least: int) -> float:
    return nearest(usual, span(asked), Range(least, MOST_LANES))


Rng = np.random.Generator
ANY: tuple[PlainKind, ...] = ("t_junction", "t_junction", "crossroads", "y_junction", "star")
"""The kinds from which a junction is drawn if none is required. T-junctions are twice as frequent."""

KERBS = (8.0, 14.0)  # m, radius of kerbs between neighbouring arms
TIGHT_KERB = 6.0  # m, where there is little room
STUBS = (20.0, 35.0)  # m, length of the arms on which the route does not go on
SHORT_STUB = 17.0  # m, where there is little room
STRAIGHT = 14.0  # degrees, greatest deviation of an arm that leads straight on
CLEAR = 40.0  # degrees, least turn of an arm to the left or right
SLIGHTEST = SIDE + 3  # degrees, least turn of such an arm where angles are required
ACROSS = 9.0  # degrees, greatest deviation of other arms of T-junctions and crossroads from 90 degrees
SLANTS = (48.0, 62.0)  # degrees, between two neighbouring arms of skew crossroads
FORK = (95.0, 145.0)  # degrees, between neighbouring arms of a Y-junction
MANY_ARMS = 5  # besides the arm of arrival; with so many, several arms may lead to the same side
STAR = 50.0  # degrees, least gap of a star junction
NARROW_STAR = 38.0  # degrees, least gap of a star junction where angles are required
EVEN = 3.0  # concentration of a Dirichlet distribution of the gaps; the larger, the more alike they are
USUALLY_MOST = 5.0  # arms of a roundabout at most, if no number is required
RING_GAP = 55.0  # degrees, least gap of a roundabout
ISLANDS = (12.0, 20.0)  # m, radius of the central island where no size is required
ROUNDS = 200  # draws of the arms of one junction


def drawn_junction(
    asked: JunctionClause, rng: Rng, haste: float, others: Collection[JunctionKind] = ()
) -> JunctionDesign | None:
    """Returns a random junction that meets its requirements; None if 200 draws found none. The larger
    ``haste``, from 0 to 1, the smaller the junction. If no kind is required, the kinds in ``others`` are
    avoided, provided that a T-junction or crossroads remains possible."""
    for _ in range(ROUNDS):
        kind = _kind(asked, rng, others)
        clause = asked.model_copy(update={"kind": kind})
        angles = [round(angle, 1) for angle in _angles(clause, rng)]
        taken = _taken(clause, angles, rng) if _has_ways(clause, angles) else None
        if taken is None:
            continue
        one_way = _one_way(clause, angles)
        if taken < len(angles) and one_way[taken]:
            continue
        least, most = STUBS[0] - haste * (STUBS[0] - SHORT_STUB), STUBS[1] - haste * (STUBS[1] - STUBS[0])
        arms = tuple(
            ArmDesign(
                angle=angle,
                # one-way arms are long, so that there is room for an arrow
                length=None
                if n == taken
                else round(most if one_way[n] else float(rng.uniform(least, most)), 1),
                control=clause.control if clause.all_way else None,
                one_way=one_way[n],
            )
            for n, angle in enumerate(angles)
        )
        radius = ceil(10 * _radius(clause, angles, rng, haste)) / 10
        if kind in RINGS and radius < smallest_radius(np.radians([-180.0, *angles]).tolist()):
            continue
        kerb = float(rng.uniform(*KERBS))
        drawn = JunctionDesign(
            after=1,  # whoever places the junction sets the number of segments before it
            kind=kind,
            take=taken + 1,
            control=clause.control or "none",
            kerb=round(kerb + haste * (TIGHT_KERB - kerb), 1),
            radius=radius,
            ring_lanes=_ring_lanes(clause),
            crosswalk=clause.crosswalk,
            turn_lanes=clause.turn_lanes,
            arms=arms,
        )
        return _with_stops(drawn) if clause.others_stop else drawn
    return None


def _with_stops(junction: JunctionDesign) -> JunctionDesign:
    arms = list(junction.all_arms)
    for n, control in enumerate(controls_of(junction)[1:]):
        if control == "yield":
            arms[n] = arms[n].model_copy(update={"control": "stop"})
    return junction.model_copy(update={"arms": tuple(arms)})


def _kind(asked: JunctionClause, rng: Rng, others: Collection[JunctionKind]) -> PlainKind:
    if asked.kind != "junction":
        return cast(PlainKind, asked.kind)
    arms = span(asked.arms)
    is_bent = asked.take in ("sharp_left", "sharp_right", "slight_left", "slight_right")
    fit = [kind for kind in ANY if not is_bent or kind in ("y_junction", "star")]
    kinds = [kind for kind in fit if arms.lo <= ARMS[kind].hi and arms.hi >= ARMS[kind].lo]
    if asked.ways:  # at crossroads, the roads that are not named would be one-way
        number = 1 + len({*asked.ways, *asked.only_in, *asked.only_out})
        kinds = [kind for kind in kinds if ARMS[kind].lo <= number <= ARMS[kind].hi] or kinds
    new = [kind for kind in kinds if kind not in others]
    kinds = new if {"t_junction", "crossroads"} & {*new} else kinds
    return kinds[int(rng.integers(len(kinds)))]


def _angles(clause: JunctionClause, rng: Rng) -> list[float]:
    if (across := _across(clause, rng)) is not None:
        angles = [across - 180, 0.0, across]
        left_out = _missing_arm(clause, rng) if clause.kind == "t_junction" else None
        return [angle for n, angle in enumerate(angles) if n != left_out]
    if clause.kind == "t_junction":
        missing = _missing_arm(clause, rng)
        usual = [angle for n, angle in enumerate((-90.0, 0.0, 90.0)) if n != missing]
        return [_near(angle, STRAIGHT if angle == 0 else ACROSS, rng) for angle in usual]
    if clause.kind == "crossroads":
        if clause.skew:
            slant = float(rng.uniform(*SLANTS)) * (1 if rng.random() < 0.5 else -1)
            return sorted([slant - 180 if slant > 0 else slant, 0.0, slant if slant > 0 else slant + 180])
        across = float(rng.uniform(90 - ACROSS, 90 + ACROSS))
        return [across - 180, _near(0.0, ACROSS / 2, rng), across]
    if clause.kind == "y_junction":
        gaps = FORK if clause.degrees is None and clause.angle is None else FORK_GAPS
        left, right = (float(gap) for gap in rng.uniform(*gaps, size=2))
        while not gaps[0] <= 360 - left - right <= gaps[1]:
            left, right = (float(gap) for gap in rng.uniform(*gaps, size=2))
        return [-180 + right, 180 - left]
    return _around(clause, rng)


def _missing_arm(clause: JunctionClause, rng: Rng) -> int:
    """Returns which of the ways to the right, straight on and to the left a T-junction does not have. "At the
    T-junction turn left" usually means that the road ends there; a priority road goes on."""
    drawn = int(rng.integers(3))
    ends = clause.take in ("left", "right") and not clause.ways and clause.control != "priority"
    return 1 if ends and not (clause.only_in or clause.only_out or clause.turn_lanes) else drawn


def _across(clause: JunctionClause, rng: Rng) -> float | None:
    """Returns the angle in degrees by which a road leads to the left from a T-junction or from crossroads at
    which an angle is required; None at others."""
    if clause.kind not in ("t_junction", "crossroads") or (clause.degrees or clause.angle) is None:
        return None
    asked = span(clause.degrees or clause.angle)
    low, high = ANGLES[clause.kind].lo, 180 - ANGLES[clause.kind].lo
    drawn = float(rng.uniform(max(asked.lo, low), max(asked.lo, low, min(asked.hi, high))))
    side = (clause.take or "").rpartition("_")[2]
    leaves = clause.degrees is not None or "straight" in clause.ways  # it turns by the angle, not by the rest
    is_left = side == "left" if leaves and side else rng.random() < 0.5
    return drawn if is_left else 180 - drawn


def _near(angle: float, most: float, rng: Rng) -> float:
    return angle + float(rng.uniform(-most, most))


def _around(clause: JunctionClause, rng: Rng) -> list[float]:
    possible = Range(ARMS[clause.kind].lo, MOST_ARMS_OF_MINI) if clause.size == "mini" else ARMS[clause.kind]
    counts = overlap(possible, span(clause.arms)) or possible
    asked = span(clause.exit)
    if clause.take == "back" and clause.exit is not None:
        counts, asked = overlap(counts, asked) or counts, Range()
    fewest = max(counts.lo, min(asked.lo + 1, counts.hi))  # the last exit would lead back
    if clause.kind == "roundabout" and clause.arms is None and clause.take is not None:
        fewest = max(fewest, 4.0 if clause.take == "straight" else 3.0)
    most = counts.hi
    if clause.kind == "roundabout" and clause.arms is None:
        most = max(USUALLY_MOST, fewest)
    count = int(rng.integers(int(fewest), int(most) + 1))
    if clause.arms is None and clause.kind == "roundabout" and int(fewest) <= 4:
        count = 4 if rng.random() < 0.6 else count
    if count == 4 and clause.kind == "roundabout":
        return [_near(angle, ACROSS, rng) for angle in (-90.0, 0.0, 90.0)]
    least = STAR if clause.kind == "star" else RING_GAP
    if clause.kind == "star" and (clause.degrees or clause.angle) is not None:
        least = NARROW_STAR
    gaps = least + (360 - count * least) * rng.dirichlet(np.full(count, EVEN))
    return [-180 + float(angle) for angle in np.cumsum(gaps)[:-1]]


def _has_ways(clause: JunctionClause, angles: Sequence[float]) -> bool:
    least = min(b - a for a, b in pairwise([-180.0, *angles, 180.0]))
    has_angle = clause.angle is None or is_about(least, clause.angle)
    unclear = [angle for angle in angles if STRAIGHT < abs(angle) < _clear(clause)]
    is_clear = clause.kind in ("roundabout", "star", "y_junction") or not unclear
    sides = [side_of(angle) for angle in angles]
    asked = (*clause.only_in, *clause.only_out, *clause.turn_lanes)
    if clause.ways and clause.kind != "crossroads":
        has_ways = sorted([*clause.ways, *clause.only_in]) == sorted(sides)
    else:
        has_ways = {*clause.ways, *asked} <= {*sides}
    return least >= ASTERN + 1 and is_clear and has_ways and has_angle


def _clear(clause: JunctionClause) -> float:
    return CLEAR if clause.degrees is None and clause.angle is None else SLIGHTEST


def _one_way(clause: JunctionClause, angles: Sequence[float]) -> list[Literal["in", "out"] | None]:
    """Returns for each arm whether its traffic only drives to the junction, or only away from it. Where the
    ways on of crossroads are required, traffic only arrives on the other arms."""
    is_listed = clause.ways and clause.kind == "crossroads"
    into = {"left", "right", "straight"} - {*clause.ways} if is_listed else {*clause.only_in}
    sides = [side_of(angle) for angle in angles]
    return ["in" if side in into else "out" if side in clause.only_out else None for side in sides]


def _taken(clause: JunctionClause, angles: Sequence[float], rng: Rng) -> int | None:
    count = len(angles)
    exits = span(clause.exit)
    if clause.take == "back":
        return count if clause.exit is None or count + 1 in exits else None
    allowed = [n for n in range(count) if n + 1 in exits]
    if clause.exit is not None and not allowed:
        return count if count + 1 in exits else None
    if clause.take is None:
        one_way = _one_way(clause, angles)
        allowed = [n for n in allowed if one_way[n] is None and _turns(clause, angles[n])]
        return allowed[int(rng.integers(len(allowed)))] if allowed else None
    taken = _towards(clause, angles)
    return taken if taken in allowed and _turns(clause, angles[taken]) else None


def _turns(clause: JunctionClause, angle: float) -> bool:
    return clause.degrees is None or is_about(abs(angle), clause.degrees)


def _towards(clause: JunctionClause, angles: Sequence[float]) -> int | None:
    take = clause.take
    if clause.kind == "y_junction":
        side = (take or "").removeprefix("slight_")
        found = {"left": len(angles) - 1, "right": 0}.get(side)
        return found if found is not None and bends_as(take, angles[found]) else None
    sides = [side_of(angle) for angle in angles]
    lefts = [n for n, angle in enumerate(angles) if angle > _clear(clause)]
    rights = [n for n, angle in enumerate(angles) if angle < -_clear(clause)]
    if take == "straight":
        ahead = [n for n, angle in enumerate(angles) if abs(angle) <= STRAIGHT]
        return ahead[0] if len(ahead) == 1 else None
    if take in ("left", "right") and clause.degrees is not None:
        same = [n for n, angle in enumerate(angles) if sides[n] == take and _turns(clause, angle)]
        return same[0] if same else None
    if take in ("left", "right"):
        same = lefts if take == "left" else rights
        if len(angles) >= MANY_ARMS:
            return min(same, key=lambda n: abs(abs(angles[n]) - 90), default=None)
        return same[0] if len(same) == 1 and sides.count(take) == 1 else None
    same = sorted(lefts if take in ("sharp_left", "slight_left") else rights, key=lambda n: abs(angles[n]))
    same = [n for n in same if bends_as(take, angles[n])]
    return (same[-1] if take in ("sharp_left", "sharp_right") else same[0]) if same else None


def _radius(clause: JunctionClause, angles: Sequence[float], rng: Rng, haste: float) -> float:
    if clause.kind not in RINGS:
        return ISLANDS[0]
    allowed = span(clause.radius)
    if clause.outer is not None:
        allowed = _island(span(clause.outer), _ring_lanes(clause))
    elif clause.size is not None:
        outer = SIZES[clause.size].drawn_in(0.5, 0.1)
        allowed = overlap(allowed, _island(outer, _ring_lanes(clause))) or allowed
    elif clause.radius is None:
        across = ROADS["junctions"][clause.kind].get("across")
        allowed = _island(Range(*across), 1) if across else Range(*ISLANDS)
    gaps = [b - a for a, b in pairwise([-180.0, *angles, 180.0])]
    usual = (2 * MOUTH + BETWEEN) / (min(gaps) * pi / 180)
    low, high = max(allowed.lo, 3.0), min(allowed.hi, max(allowed.lo, 3.0) * 1.5 + 5)
    drawn = low + (high - low) * float(rng.random()) * (1 - haste)
    is_free = clause.radius is None and clause.outer is None
    return min(max(drawn, min(usual, high)), high) if is_free else drawn


def _ring_lanes(clause: JunctionClause) -> int:
    return 1 if clause.kind != "roundabout" or span(clause.lanes).lo <= 1 else MOST_RING_LANES


def _island(outer: Range, lanes: int) -> Range:
    low, high = (each / 2 - ring_width(each / 2 - 5.0, lanes) for each in (outer.lo, outer.hi))
    return Range(low, high)
