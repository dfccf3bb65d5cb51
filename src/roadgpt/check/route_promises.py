"""Requires a route to meet its Brief: the junctions in order, and the roads between them.

Junctions are measured by ``check.junction_measures``. Each road between junctions is measured and compared
with its own requirements in the same way as a single road in the rule ``promises``.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from roadgpt.brief.amount import Amount, span
from roadgpt.brief.junction_ranges import SIZES, SKEW, bends_as, is_about
from roadgpt.brief.junction_sentence import TAKES
from roadgpt.brief.junctions import LANE_KINDS, NAMES, RAMPS, JunctionClause
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import outline
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import ROAD
from roadgpt.check.finding import Finding
from roadgpt.check.junction_measures import (
    MeasuredJunction,
    MeasuredLanes,
    is_beside_ramp,
    measured_places,
)
from roadgpt.check.measures import measure
from roadgpt.check.rules.promises import complaints
from roadgpt.network import NetworkRoad, RoadEnd, Route
from roadgpt.network.stretch import joined_roads, without_level_ends
from roadgpt.road import Road

RULE = "promises"
SLACK = 0.15  # ratio, allowed deviation from the radius of an island that is given as one number
ROUNDING = 0.5  # m, allowed deviation from a range of outer diameters


def broken_promises(route: Route, brief: Brief, map_size: float) -> tuple[Finding, ...]:
    """Returns one Finding for each requirement that a route does not meet. If the number of junctions and
    lane changes is wrong, nothing else is compared. On a small map, "motorway" and "sweeping" require less;
    ``map_size`` is the side of the map in metres.
    """
    found = measured_places(route)
    if len(found) != len(brief.junctions):
        text = (
            f"asked for {len(brief.junctions)} junctions and places where lanes change, passes {len(found)}"
        )
        return (Finding(RULE, text),)
    out = []
    for number, (place, asked) in enumerate(zip(found, brief.junctions, strict=True), 1):
        x, y = route.at(place.s)[:2].tolist()
        texts = place_complaints(place, asked)
        out += [
            Finding(RULE, f"junction {number} at s = {place.s:.0f} m: {text}", place.s, x, y)
            for text in texts
        ]
    roads = stretches_of(route)
    moved = [0.0, *map(_moved, found, brief.roads[1:]), 0.0]
    for n, ((start, road), stretch) in enumerate(zip(roads, brief.roads, strict=False)):
        if not stretch.is_open:
            more = moved[n + 1] - moved[n]
            out += _broken(start, road, stretch, (n > 0, n < len(roads) - 1), more, map_size)
    return (*out, *_length(route, brief))


def _moved(place: MeasuredJunction | MeasuredLanes, behind: Brief) -> float:
    """Returns the distance in metres from the end of a road to the place where its required length ends.

    At a lane change the distance is 0 if a length is required of the following road, too.
    """
    if isinstance(place, MeasuredJunction) or (place.kind == "lane_change" and behind.length is not None):
        return 0.0
    return place.behind


def stretches_of(route: Route) -> list[tuple[float, Road]]:
    """Returns the roads of a route outside junctions as pairs (station of the start in metres, road)."""
    found: list[tuple[float, list[NetworkRoad]]] = []
    for start, member in route.roads:
        last = found[-1][1][-1] if found else None
        is_continued = RoadEnd(member.id, "start") in route.network.continued_at
        if last is not None and is_continued and is_beside_ramp(route.network, last, member):
            found[-1][1].append(member)
        else:
            found.append((start, [member]))
    return [(start, joined_roads([member.road for member in own])) for start, own in found]


def _broken(
    start: float, road: Road, asked: Brief, is_level: tuple[bool, bool], more: float, map_size: float
) -> Iterator[Finding]:
    """Yields a Finding for each requirement that a road does not meet.

    ``is_level`` says whether the road was made level at its start and at its end, where it meets junctions;
    grades are measured as if it had not been. The length counts from where lanes end, begin or change, so
    ``more`` metres are added to it.
    """
    yield from _broken_lanes(start, road, asked)
    wanted = outline(asked.as_stretch, map_size)
    found = measure(without_level_ends(road, is_level).centreline(), wanted.widest)
    heights = road.at(np.array([0.0, road.length]))[:, 2]
    found = replace(found, climb=float(heights[1] - heights[0]), length=found.length + more)
    for complaint in complaints(found, wanted):
        s = start if complaint.s is None else start + complaint.s
        x, y = road.at(min(s - start, road.length))[:2].tolist()
        yield Finding(RULE, f"on the road from s = {start:.0f} m: {complaint.sentence}", s, x, y)


def _broken_lanes(start: float, road: Road, asked: Brief) -> Iterator[Finding]:
    """Yields a Finding for each requirement for lanes that a road does not meet."""
    profile = road.profile
    assert profile is not None
    forward, backward = profile.count
    x, y = road.at(0.0)[:2].tolist()
    wrong = []
    if asked.lanes is not None and forward not in span(asked.lanes):
        wrong.append(f"asked for {asked.lanes} lanes, has {forward}")
    if asked.against is not None and backward not in span(asked.against):
        wrong.append(f"asked for {asked.against} oncoming lanes, has {backward}")
    if asked.divided and not profile.median:
        wrong.append("asked for a median, has none")
    if asked.centre is not None and backward and profile.centre_marking != asked.centre:
        wrong.append(f"asked for a {asked.centre} centre line, has a {profile.centre_marking} one")
    for text in wrong:
        yield Finding(RULE, f"on the road from s = {start:.0f} m: {text}", start, x, y)


def place_complaints(found: MeasuredJunction | MeasuredLanes, asked: JunctionClause) -> Iterator[str]:
    """Yields each requirement that a junction or a place where lanes change does not meet, as text."""
    if isinstance(found, MeasuredLanes):
        if found.kind != asked.kind:
            yield f"asked for a {asked.name}, has a {NAMES[found.kind][0]}"
        side = asked.take or asked.side
        if side is not None and found.side != side:
            yield f"asked for the {side} side, is on the {found.side}"
    elif asked.kind in LANE_KINDS:
        yield f"asked for a {asked.name}, has a {found.kinds[0] if found.kinds else 'junction'}"
    else:
        yield from junction_complaints(found, asked)


def _length(route: Route, brief: Brief) -> Iterator[Finding]:
    if brief.length is None:
        return
    allowed = length_range(brief.length)
    if route.length not in allowed:
        quantity = ROAD["length"]
        text = f"asked for {quantity.asked.format(allowed)}, has {quantity.measured.format(route.length)}"
        yield Finding(RULE, text)


def length_range(length: Amount) -> Range:
    """Returns the range of measured lengths in metres that meet a required length."""
    asked = span(length)
    if not length.exact:
        return asked
    slack = ROAD["length"].slack(asked.lo)
    return Range(asked.lo - slack, asked.hi + slack)


def junction_complaints(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    """Yields each requirement that a junction does not meet, as text."""
    is_any = asked.kind == "junction" and not {"roundabout", *RAMPS} & {*found.kinds}
    if not is_any and asked.kind not in found.kinds:
        gaps = ", ".join(f"{gap:.0f}" for gap in found.gaps)
        yield f"asked for a {asked.name}, has arms {gaps} degrees apart"
    if asked.arms is not None and found.arms not in span(asked.arms):
        yield f"asked for {asked.arms} arms, has {found.arms}"
    if asked.ways and sorted(found.ways_on) != sorted(asked.ways):
        yield f"asked for ways to the {' and '.join(asked.ways)}, has {' and '.join(found.ways_on)}"
    for sides, said, own in (
        (asked.only_in, "towards", found.only_in),
        (asked.only_out, "away from", found.only_out),
    ):
        if not {*sides} <= {*own}:
            yield f"asked for a one-way road {said} the junction on the {' and '.join(sides)}, has none there"
    if asked.exit is not None and found.exit not in span(asked.exit):
        yield f"asked for exit {asked.exit}, takes exit {found.exit}"
    if asked.take is not None and not takes(found, asked):
        yield f"asked to {TAKES[asked.take]}, turns {found.turn:.0f} degrees"
    if asked.control is not None and not _is_controlled(found, asked):
        yield f"asked for {asked.control}, has {found.control}"
    if asked.skew and min(found.gaps) >= SKEW:
        yield f"asked for skew crossroads, the least angle is {min(found.gaps):.0f} degrees"
    yield from _angles(found, asked)
    yield from _sizes(found, asked)
    yield from _of_ramp(found, asked)
    if asked.all_way and set(found.all_controls) != {asked.control}:
        yield f"asked for {asked.control} at every arm, has {', '.join(found.all_controls)}"
    give_way = {*found.all_controls} - {"priority"}
    nobody_does = bool(asked.only_out) and not give_way  # all other roads lead away only
    if asked.others_stop and give_way != {"stop"} and not nobody_does:
        yield f"asked for stop signs for the others, has {', '.join(found.all_controls)}"


def _angles(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    if asked.degrees is not None and not is_about(abs(found.turn), asked.degrees):
        yield f"asked for a turn of {asked.degrees} degrees, is {abs(found.turn):.0f} degrees"
    if asked.angle is not None and not is_about(min(found.gaps), asked.angle):
        yield f"asked for roads {asked.angle} degrees apart, the least angle is {min(found.gaps):.0f} degrees"


def _of_ramp(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    if asked.side not in (None, found.ramp_side):
        yield f"asked for a ramp on the {asked.side}, is on the {found.ramp_side}"
    lengths = ("lane", asked.length, found.beside), ("taper", asked.taper, found.taper)
    for name, length, own in lengths:
        if length is not None and own is not None and own not in length_range(length):
            yield f"asked for a {name} of {length} m, has {own:.0f} m"


def takes(found: MeasuredJunction, asked: JunctionClause) -> bool:
    """Returns whether the route leaves a junction in the required direction."""
    take, turn = asked.take, found.turn
    if take in ("ramp", "main"):
        return found.is_ramp is (take == "ramp")
    if take == "back":
        return found.exit == found.arms
    if found.exit == found.arms:
        return False
    if take is not None and take.startswith(("sharp", "slight")):
        side = take.rpartition("_")[2]
        same = [each for each, way in zip(found.ways, found.sides, strict=True) if way == side]
        pick = max if take.startswith("sharp") else min
        return bool(same) and turn == pick(same, key=abs) and bends_as(take, turn)
    if asked.kind == "y_junction" and take in ("left", "right"):
        return turn == (max(found.ways) if take == "left" else min(found.ways))
    return take == found.sides[found.exit - 1]


def _is_controlled(found: MeasuredJunction, asked: JunctionClause) -> bool:
    if asked.control in ("none", "priority") and "roundabout" in found.kinds:
        return found.control == "yield"  # everybody gives way to those on the ring
    return found.control == asked.control


def _sizes(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    if found.outer is None or found.island is None:
        return
    if asked.lanes is not None and found.ring_lanes not in span(asked.lanes):
        yield f"asked for a ring with {asked.lanes} lanes, has {found.ring_lanes}"
    if asked.size is not None:
        size = SIZES[asked.size]
        if found.outer not in Range(size.lo - ROUNDING, size.hi + ROUNDING):
            yield f"asked for a {asked.size} roundabout, {size} m wide, is {found.outer:.1f} m wide"
    if asked.outer is not None:
        wanted = span(asked.outer)
        if found.outer not in Range(wanted.lo - ROUNDING, wanted.hi + ROUNDING):
            yield f"asked for a roundabout {asked.outer} m across, is {found.outer:.1f} m across"
    if asked.radius is not None:
        wanted = span(asked.radius)
        if asked.radius.exact:
            wanted = Range(wanted.lo * (1 - SLACK), wanted.hi * (1 + SLACK))
        if found.island not in wanted:
            yield f"asked for an island of {asked.radius} m radius, has {found.island:.1f} m"
