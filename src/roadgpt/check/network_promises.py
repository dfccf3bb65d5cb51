"""Requires a route or a map to meet its Brief: the junctions in order and the roads between them, or blocks,
junctions, dead ends, signs, distances and the turns of the route.

Junctions and maps are measured by ``check.network_measures``. Each road between junctions is measured and
compared with its own requirements in the same way as a single road in the rule ``promises``."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from roadgpt.brief.junctions import (
    LANE_KINDS,
    NAMES,
    RAMPS,
    SIGNS,
    SIZES,
    SKEW,
    Control,
    JunctionCount,
    MapClause,
    MapJunctionKind,
    bends_as,
    is_about,
)
from roadgpt.brief.model import Amount, Brief, JunctionClause, span
from roadgpt.brief.outline import outline
from roadgpt.brief.ranges import Range
from roadgpt.brief.sentence import TAKES
from roadgpt.brief.words import ROAD
from roadgpt.check.finding import Finding
from roadgpt.check.measures import measure
from roadgpt.check.network_measures import (
    MeasuredJunction,
    MeasuredLanes,
    MeasuredMap,
    MeasuredNode,
    is_beside_ramp,
    measured_junctions,
    measured_map,
    measured_places,
)
from roadgpt.check.rules.promises import complaints
from roadgpt.network import NetworkRoad, RoadEnd, Route
from roadgpt.network.stretch import joined_roads, without_level_ends
from roadgpt.plural import plural
from roadgpt.road import Road

RULE = "promises"
SLACK = 0.15  # ratio, allowed deviation from the radius of an island that is given as one number
ROUNDING = 0.5  # m, allowed deviation from a range of outer diameters
SHARE = 0.1  # ratio by which a distance between junctions may differ from the requested distance
NEVER_USUAL = ("lights", "stop")
"""Signs that a junction has only on request; a roundabout has signs to give way even without a request."""
CORNERS = 4  # corners of a grid; at each, the road may bend without a junction


def broken_promises(route: Route, brief: Brief, map_size: float) -> tuple[Finding, ...]:
    """Returns one Finding for each requirement that a route does not meet. If the number of junctions and
    lane changes is wrong, nothing else is compared. On a small map, whose side is ``map_size`` metres,
    "motorway" and "sweeping" require less."""
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
    if brief.length is not None and route.length not in (allowed := length_range(brief.length)):
        quantity = ROAD["length"]
        text = f"asked for {quantity.asked.format(allowed)}, has {quantity.measured.format(route.length)}"
        out.append(Finding(RULE, text))
    return tuple(out)


def _moved(place: MeasuredJunction | MeasuredLanes, behind: Brief) -> float:
    """Returns the distance in metres from the end of a road to the place where its required length ends: 0 at
    a lane change if a length is required of the following road, too."""
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
    """Yields a Finding for each requirement that a road does not meet. ``is_level`` says whether the road was
    made level at its start and at its end, where it meets junctions; grades are measured as if it had not
    been. The length counts from where lanes end, begin or change, so ``more`` metres are added to it."""
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
    """Yields each requirement that a junction or a place where lanes change does not meet."""
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


def length_range(length: Amount) -> Range:
    """Returns the range of measured lengths in metres that meet a required length."""
    asked = span(length)
    if not length.exact:
        return asked
    slack = ROAD["length"].slack(asked.lo)
    return Range(asked.lo - slack, asked.hi + slack)


def junction_complaints(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    """Yields each requirement that a junction does not meet."""
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
    if asked.degrees is not None and not is_about(abs(found.turn), asked.degrees):
        yield f"asked for a turn of {asked.degrees} degrees, is {abs(found.turn):.0f} degrees"
    if asked.angle is not None and not is_about(min(found.gaps), asked.angle):
        yield f"asked for roads {asked.angle} degrees apart, the least angle is {min(found.gaps):.0f} degrees"
    yield from _sizes(found, asked)
    yield from _of_ramp(found, asked)
    if asked.all_way and set(found.all_controls) != {asked.control}:
        yield f"asked for {asked.control} at every arm, has {', '.join(found.all_controls)}"
    give_way = {*found.all_controls} - {"priority"}
    nobody_does = bool(asked.only_out) and not give_way  # all other roads lead away only
    if asked.others_stop and give_way != {"stop"} and not nobody_does:
        yield f"asked for stop signs for the others, has {', '.join(found.all_controls)}"


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


def broken_map(route: Route, asked: MapClause, length: Amount | None) -> tuple[Finding, ...]:
    """Returns one Finding for each requirement that the map of a route does not meet. ``length`` is the
    required length of all roads outside junctions, in metres."""
    found = measured_map(route.network)
    out = [Finding(RULE, text) for text in _complaints(found, asked)]
    goes = [each.sides[each.exit - 1] for each in measured_junctions(route)]
    if asked.route and goes != [*asked.route]:
        ways = f"{', '.join(asked.route)}, goes {', '.join(goes) or 'nowhere'}"
        out.append(Finding(RULE, f"asked for a route that goes {ways}"))
    if length is not None and found.length not in length_range(length):
        out.append(Finding(RULE, f"asked for {length} m of roads in all, has {found.length:.0f} m"))
    if asked.signed or any(each.control for each in asked.junctions):
        controls = _controls_of_grid if asked.signed else _controls
        return (*out, *(Finding(RULE, text) for text in controls(found, asked)))
    for node in found.nodes:
        if asked.control is not None and not _has_control(node, asked.control):
            x, y = node.place
            has = " and ".join(SIGNS[each] for each in sorted(node.controls))
            text = f"asked for {SIGNS[asked.control]} at all junctions, near ({x:.0f}, {y:.0f}): {has}"
            out.append(Finding(RULE, text, None, x, y))
    return tuple(out)


def _complaints(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    if found.parts > 1:
        yield f"asked for one map, has {found.parts} parts that no road joins"
    yield from _kinds(found, asked) if asked.junctions else _grid(found, asked)
    if asked.blocks is not None and found.blocks not in span(asked.blocks):
        yield f"asked for {asked.blocks} enclosed blocks, has {found.blocks}"
    if asked.dead_ends is not None and found.ends not in span(asked.dead_ends):
        yield f"asked for {asked.dead_ends} dead ends, has {found.ends}"
    if asked.length is not None:
        allowed = _allowed(asked.length)
        wrong = [each for each in found.distances if each not in allowed]
        if wrong:
            worst = max(wrong, key=lambda each: max(allowed.lo - each, each - allowed.hi))
            yield f"asked for {asked.length} m between junctions, two are {worst:.0f} m apart"


def _grid(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    columns, rows = span(asked.columns), span(asked.rows)
    blocks = Range(max(columns.lo, 1) * max(rows.lo, 1), columns.hi * rows.hi)
    if found.blocks not in blocks:
        yield f"asked for {asked.columns} by {asked.rows} blocks, has {found.blocks}"
    low, high = ((side + 1) * (other + 1) for side, other in ((columns.lo, rows.lo), (columns.hi, rows.hi)))
    if math.isfinite(low) and len(found.nodes) not in Range(low - CORNERS, high):
        count = plural(len(found.nodes), "junction")
        wanted = f"{low - CORNERS:g} to {high:g}"
        yield f"a grid of {asked.columns} by {asked.rows} blocks has {wanted} junctions, not {count}"


def _kinds(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    total = _in_all(asked.junctions)
    if len(found.nodes) not in total:
        yield f"asked for {total} junctions in all, has {len(found.nodes)}"
    free = sum(span(each.count).hi for each in asked.junctions if each.kind == "junction")
    named = [each for each in asked.junctions if each.kind != "junction"]
    for kind in dict.fromkeys(each.kind for each in named):
        own = _in_all(each for each in named if each.kind == kind)
        allowed = Range(own.lo, own.hi + free)
        number = sum(kind in node.kinds for node in found.nodes)
        if number not in allowed:
            yield f"asked for {allowed} of the kind {NAMES[kind][0]}, has {number}"


def _in_all(asked: Iterable[JunctionCount]) -> Range:
    counts = [span(each.count) for each in asked]
    return Range(sum(each.lo for each in counts), sum(each.hi for each in counts))


def _controls(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    wanted = [asked.control_of(each) for each in asked.junctions]
    for control in dict.fromkeys(each for each in wanted if each is not None):
        allowed = _in_all(each for each in asked.junctions if asked.control_of(each) == control)
        number = sum(_has_control(node, control) for node in found.nodes)
        if number < allowed.lo or (control in NEVER_USUAL and number > allowed.hi):
            yield f"asked for {SIGNS[control]} at {allowed} junctions, has {number}"
    yield from _kinds_with_signs(found, asked, asked.junctions)


def _controls_of_grid(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    """Checks the signs of a grid some of whose junctions have their own; all others have that of the grid, or
    none."""
    left = len(found.nodes)
    for control in dict.fromkeys(each.control for each in asked.signed if each.control is not None):
        allowed = _in_all(each for each in asked.signed if each.control == control)
        number = sum(_has_control(node, control) for node in found.nodes)
        left -= number
        if number not in allowed:
            yield f"asked for {SIGNS[control]} at {allowed} of the junctions of the grid, has {number}"
    yield from _kinds_with_signs(found, asked, asked.signed)
    usual = asked.control or "none"
    number = sum(_has_control(node, usual) for node in found.nodes)
    if number != left:
        yield f"asked for {SIGNS[usual]} at the {left} other junctions of the grid, has {number}"


def _kinds_with_signs(found: MeasuredMap, asked: MapClause, kinds: Sequence[JunctionCount]) -> Iterator[str]:
    for each in kinds:
        held = asked.control_of(each)
        if held is not None:
            number = sum(_is_of(node, each.kind) and _has_control(node, held) for node in found.nodes)
            if number < span(each.count).lo:
                kind = NAMES[each.kind][0]
                yield f"asked for {SIGNS[held]} at {each.count} of the kind {kind}, has {number}"


def _is_of(node: MeasuredNode, kind: MapJunctionKind) -> bool:
    return "roundabout" not in node.kinds if kind == "junction" else kind in node.kinds


def _allowed(length: Amount) -> Range:
    asked = span(length)
    slack = max(ROAD["length"].slack(asked.lo), SHARE * asked.lo) if asked.lo > 0 else 0.0
    return Range(asked.lo - slack, asked.hi + (slack or SHARE * asked.hi))


def _has_control(node: MeasuredNode, control: Control) -> bool:
    """Returns whether a junction has the requested signs: lights and "none" at all arms, others at one at
    least."""
    if control in ("none", "priority", "yield") and "roundabout" in node.kinds:
        return node.controls == {"yield"}  # everybody gives way to those on the ring
    if control in ("lights", "none"):
        return node.controls == {control}
    return ("yield" if control == "priority" else control) in node.controls
