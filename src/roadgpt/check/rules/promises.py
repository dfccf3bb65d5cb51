"""Requires a road, a route or a map to meet its Brief: the turns and straights in order and the grades; the
junctions in order and the roads between them; or blocks, junctions, dead ends, signs and distances.

The requirements are compared with what is measured on the finished geometry: see ``check.matching``. Each
road between junctions is measured and compared with its own requirements in the same way as a single road."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.brief.junctions import LANE_KINDS
from roadgpt.brief.model import Brief, counts_to_change, motorways_continued
from roadgpt.brief.outline import outline
from roadgpt.brief.words import ROAD, heading_from
from roadgpt.check.finding import Finding, route_of, single_road
from roadgpt.check.matching import (
    complaints,
    lane_complaints,
    length_range,
    map_complaints,
    place_complaints,
    speed_complaints,
)
from roadgpt.check.measures import (
    MeasuredJunction,
    MeasuredLanes,
    is_beside_place,
    measure,
    measured_junctions,
    measured_map,
    measured_places,
)
from roadgpt.network import Network, NetworkRoad, RoadEnd
from roadgpt.road import Road, World

if TYPE_CHECKING:
    from roadgpt.network import Route

RULE = "promises"
COMPASS_SLACK = 22.5  # degrees: half of the angle between two of the eight points


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the requested and the measured value for each requirement that is not met."""
    if brief is None:
        return ()
    size = world.site.map_size
    start = tuple(_of_start(route, brief))
    if (road := single_road(route)) is not None:
        asked = outline(brief, size)
        told = complaints(measure(road.centreline(), asked.widest), asked)
        told += speed_complaints(road, asked.speed) if asked.speed else ()
        at = (None if each.s is None else road.at(min(each.s, road.length))[:2].tolist() for each in told)
        pairs = zip(told, at, strict=True)
        return (*start, *(Finding(RULE, each.sentence, each.s, *(place or ())) for each, place in pairs))
    if brief.map is None:
        return (*start, *_of_route(route_of(route), brief, size))
    passed = [] if (driven := route_of(route)) is None else measured_junctions(driven)
    goes = [each.sides[each.exit - 1] for each in passed]
    wrong = map_complaints(measured_map(network), brief.map, brief.length, goes)
    return tuple(Finding(RULE, each.sentence, None, *(each.place or ())) for each in wrong)


def _of_start(route: Road | None, brief: Brief) -> Iterator[Finding]:
    if brief.comes_from is None or route is None:
        return
    wanted, heading = heading_from(brief.comes_from), float(np.degrees(route.heading(0.0))) % 360
    if abs((heading - wanted + 180) % 360 - 180) > COMPASS_SLACK:
        text = (
            f"asked to come from the {brief.comes_from}, a heading of {wanted:g} degrees, has {heading:.0f}"
        )
        yield Finding(RULE, text, 0.0, *route.at(0.0)[:2].tolist())


def _of_route(route: "Route | None", brief: Brief, map_size: float) -> Iterator[Finding]:
    """Yields a Finding for each requirement that a route does not meet. If the number of junctions and lane
    changes is wrong, nothing else is compared. On a small map, whose side is ``map_size`` metres, "motorway"
    and "sweeping" require less."""
    wide = [] if route is None else _starts_of_turn_lanes(route, brief)
    passed = [] if route is None else measured_places(route)
    found = [each for each in passed if isinstance(each, MeasuredJunction) or each.s not in wide]
    if len(found) != len(brief.junctions):
        places = f"{len(brief.junctions)} junctions and places where lanes change"
        yield Finding(RULE, f"asked for {places}, passes {len(found)}")
        return
    if route is not None:
        for number, (place, asked) in enumerate(zip(found, brief.junctions, strict=True), 1):
            x, y = route.at(place.s)[:2].tolist()
            for text in place_complaints(place, asked):
                yield Finding(RULE, f"junction {number} at s = {place.s:.0f} m: {text}", place.s, x, y)
        roads = _stretches(route, wide)
        wanted = motorways_continued(brief) or brief.roads
        moved = [0.0, *(_moved(place, brief, n) for n, place in enumerate(found)), 0.0]
        for n, ((start, road), stretch) in enumerate(zip(roads, wanted, strict=False)):
            if not brief.roads[n].is_open:
                more = moved[n + 1] - moved[n]
                yield from _of_stretch(start, road, stretch, (n > 0, n < len(roads) - 1), more, map_size)
    length = 0.0 if route is None else route.length
    if length not in (allowed := length_range(brief.length)):
        quantity = ROAD["length"]
        text = f"asked for {quantity.asked.format(allowed)}, has {quantity.measured.format(length)}"
        yield Finding(RULE, text)


def _moved(place: MeasuredJunction | MeasuredLanes, brief: Brief, number: int) -> float:
    """Returns the distance in metres from the end of a road to the place where its required length ends."""
    if isinstance(place, MeasuredJunction):
        return 0.0
    return place.behind if place.kind != "lane_change" or counts_to_change(brief, number) else 0.0


def _starts_of_turn_lanes(route: "Route", brief: Brief) -> list[float]:
    """Returns the stations in metres at which those roads begin that end at required turn lanes."""
    asked = (each for each in brief.junctions if each.kind not in LANE_KINDS)
    pairs = zip(route.passages, asked, strict=False)
    wide = {passage.arrival.road for passage, clause in pairs if clause.turn_lanes}
    return [start for start, member in route.roads if member.id in wide]


def _stretches(route: "Route", wide: Sequence[float]) -> list[tuple[float, Road]]:
    """Returns the roads of a route outside junctions as pairs (station of the start in metres, road). Those
    that begin at a station in ``wide`` are parts of the road before."""
    from roadgpt.network.stretch import joined_roads  # not for single roads

    found: list[tuple[float, list[NetworkRoad]]] = []
    for start, member in route.roads:
        last = found[-1][1][-1] if found else None
        is_continued = RoadEnd(member.id, "start") in route.network.continued_at
        is_part = last is not None and (start in wide or is_beside_place(route.network, last, member))
        if is_continued and is_part:
            found[-1][1].append(member)
        else:
            found.append((start, [member]))
    return [(start, joined_roads([member.road for member in own])) for start, own in found]


def _of_stretch(
    start: float, road: Road, asked: Brief, is_level: tuple[bool, bool], more: float, map_size: float
) -> Iterator[Finding]:
    """Yields a Finding for each requirement that a road does not meet. ``is_level`` says whether the road was
    made level at its start and at its end, where it meets junctions; grades are measured as if it had not
    been. The length counts from where lanes end, begin or change, so ``more`` metres are added to it."""
    from roadgpt.network.stretch import without_level_ends

    assert road.profile is not None
    wanted = outline(asked.as_stretch, map_size)
    unended = without_level_ends(road, is_level)
    found = measure(unended.centreline(), wanted.widest)
    heights = road.at(np.array([0.0, road.length]))[:, 2]
    found = replace(found, climb=float(heights[1] - heights[0]), length=found.length + more)
    fast = speed_complaints(unended, wanted.speed) if wanted.speed else ()
    for each in (*lane_complaints(road.profile, asked), *complaints(found, wanted), *fast):
        s = start if each.s is None else start + each.s
        x, y = road.at(min(s - start, road.length))[:2].tolist()
        yield Finding(RULE, f"on the road from s = {start:.0f} m: {each.sentence}", s, x, y)
