"""Requires a road, a route or a map to meet its Brief: the turns and straights in order and the grades; the
junctions in order and the roads between them; or blocks, junctions, dead ends, signs and distances.

The requirements are compared with what is measured on the finished geometry: see ``check.matching``. Each
road between junctions is measured and compared with its own requirements in the same way as a single road.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.brief.model import Brief, counts_to_change, motorways_continued
from roadgpt.brief.outline import outline
from roadgpt.brief.words import ROAD
from roadgpt.check.finding import Finding, route_of, single_road
from roadgpt.check.matching import complaints, lane_complaints, length_range, map_complaints, place_complaints
from roadgpt.check.measures import (
    MeasuredJunction,
    MeasuredLanes,
    is_beside_ramp,
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


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the requested and the measured value for each requirement that is not met."""
    if brief is None:
        return ()
    size = world.site.map_size
    if (road := single_road(route)) is not None:
        asked = outline(brief, size)
        told = complaints(measure(road.centreline(), asked.widest), asked)
        at = (None if each.s is None else road.at(min(each.s, road.length))[:2].tolist() for each in told)
        return tuple(
            Finding(RULE, each.sentence, each.s, *(place or ())) for each, place in zip(told, at, strict=True)
        )
    if brief.map is None:
        return tuple(_of_route(route_of(route), brief, size))
    passed = [] if (driven := route_of(route)) is None else measured_junctions(driven)
    goes = [each.sides[each.exit - 1] for each in passed]
    wrong = map_complaints(measured_map(network), brief.map, brief.length, goes)
    return tuple(Finding(RULE, each.sentence, None, *(each.place or ())) for each in wrong)


def _of_route(route: "Route | None", brief: Brief, map_size: float) -> Iterator[Finding]:
    """Yields a Finding for each requirement that a route does not meet. If the number of junctions and lane
    changes is wrong, nothing else is compared. On a small map, whose side is ``map_size`` metres, "motorway"
    and "sweeping" require less."""
    found = [] if route is None else measured_places(route)
    if len(found) != len(brief.junctions):
        places = f"{len(brief.junctions)} junctions and places where lanes change"
        yield Finding(RULE, f"asked for {places}, passes {len(found)}")
        return
    if route is not None:
        for number, (place, asked) in enumerate(zip(found, brief.junctions, strict=True), 1):
            x, y = route.at(place.s)[:2].tolist()
            for text in place_complaints(place, asked):
                yield Finding(RULE, f"junction {number} at s = {place.s:.0f} m: {text}", place.s, x, y)
        roads = _stretches(route)
        wanted = motorways_continued(brief) or brief.roads
        moved = [0.0, *(_moved(place, brief, n) for n, place in enumerate(found)), 0.0]
        for n, ((start, road), stretch) in enumerate(zip(roads, wanted, strict=False)):
            if not brief.roads[n].is_open:
                more = moved[n + 1] - moved[n]
                yield from _of_stretch(start, road, stretch, (n > 0, n < len(roads) - 1), more, map_size)
    length = 0.0 if route is None else route.length
    if brief.length is not None and length not in (allowed := length_range(brief.length)):
        quantity = ROAD["length"]
        text = f"asked for {quantity.asked.format(allowed)}, has {quantity.measured.format(length)}"
        yield Finding(RULE, text)


def _moved(place: MeasuredJunction | MeasuredLanes, brief: Brief, number: int) -> float:
    """Returns the distance in metres from the end of a road to the place where its required length ends."""
    if isinstance(place, MeasuredJunction):
        return 0.0
    return place.behind if place.kind != "lane_change" or counts_to_change(brief, number) else 0.0


def _stretches(route: "Route") -> list[tuple[float, Road]]:
    """Returns the roads of a route outside junctions as pairs (station of the start in metres, road)."""
    from roadgpt.network.stretch import joined_roads  # not for single roads

    found: list[tuple[float, list[NetworkRoad]]] = []
    for start, member in route.roads:
        last = found[-1][1][-1] if found else None
        is_continued = RoadEnd(member.id, "start") in route.network.continued_at
        if last is not None and is_continued and is_beside_ramp(route.network, last, member):
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
    found = measure(without_level_ends(road, is_level).centreline(), wanted.widest)
    heights = road.at(np.array([0.0, road.length]))[:, 2]
    found = replace(found, climb=float(heights[1] - heights[0]), length=found.length + more)
    for each in (*lane_complaints(road.profile, asked), *complaints(found, wanted)):
        s = start if each.s is None else start + each.s
        x, y = road.at(min(s - start, road.length))[:2].tolist()
        yield Finding(RULE, f"on the road from s = {start:.0f} m: {each.sentence}", s, x, y)
