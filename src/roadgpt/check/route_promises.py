"""Requires a route to meet its Brief: the junctions in order, and the roads between them.

Junctions are compared with what ``check.junction_measures`` measures. Each road between junctions is measured
and compared with its own requirements, as a single road is by the rule ``promises``.
"""

from collections.abc import Iterator

from roadgpt.brief.amount import Amount, span
from roadgpt.brief.junctions import SIZES, TAKES, JunctionClause
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import outline
from roadgpt.brief.words import ROAD, Range
from roadgpt.check.finding import Finding
from roadgpt.check.junction_measures import SKEW, MeasuredJunction, measured_junctions
from roadgpt.check.measures import measure
from roadgpt.check.rules.promises import complaints
from roadgpt.network import Route
from roadgpt.road import Road

RULE = "promises"
SLACK = 0.15  # ratio, around the radius of an island that is given as one number
ROUNDING = 0.5  # m, around the outer diameter of a size


def broken_promises(route: Route, brief: Brief) -> tuple[Finding, ...]:
    """Returns one Finding for each requirement that a route does not meet."""
    found = measured_junctions(route)
    if len(found) != len(brief.junctions):
        text = f"asked for {len(brief.junctions)} junctions, passes {len(found)}"
        return (Finding(RULE, text),)
    out = []
    for number, (junction, asked) in enumerate(zip(found, brief.junctions, strict=True), 1):
        x, y = route.at(junction.s)[:2].tolist()
        out += [
            Finding(RULE, f"junction {number} at s = {junction.s:.0f} m: {text}", junction.s, x, y)
            for text in junction_complaints(junction, asked)
        ]
    for (start, road), stretch in zip(stretches_of(route), brief.stretches, strict=False):
        if not stretch.is_open:
            out += _broken(start, road, stretch)
    return (*out, *_length(route, brief))


def stretches_of(route: Route) -> list[tuple[float, Road]]:
    """Returns the roads of a route outside junctions in driving order, each with the station of its start."""
    network = route.network
    return [
        (start, network.road(leg.road).road)
        for start, leg in zip(route.starts, route.legs, strict=False)
        if network.road(leg.road).junction is None and leg.road not in network.roundabout_of
    ]


def _broken(start: float, road: Road, asked: Brief) -> Iterator[Finding]:
    wanted = outline(asked.as_stretch)
    for complaint in complaints(measure(road.centreline(), wanted.widest), wanted):
        s = start if complaint.s is None else start + complaint.s
        x, y = road.at(min(s - start, road.length))[:2].tolist()
        yield Finding(RULE, f"on the road from s = {start:.0f} m: {complaint.sentence}", s, x, y)


def _length(route: Route, brief: Brief) -> Iterator[Finding]:
    if brief.length is None:
        return
    allowed = length_range(brief.length)
    if route.length not in allowed:
        quantity = ROAD["length"]
        text = f"asked for {quantity.asked.format(allowed)}, has {quantity.measured.format(route.length)}"
        yield Finding(RULE, text)


def length_range(length: Amount) -> Range:
    """Returns the lengths in metres that are allowed for a route of which a length is required."""
    asked = span(length)
    if not length.exact:
        return asked
    slack = ROAD["length"].slack(asked.lo)
    return Range(asked.lo - slack, asked.hi + slack)


def junction_complaints(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    """Yields what is wrong with a junction, as text."""
    is_any = asked.kind == "junction" and "roundabout" not in found.kinds
    if not is_any and asked.kind not in found.kinds:
        gaps = ", ".join(f"{gap:.0f}" for gap in found.gaps)
        yield f"asked for a {asked.name}, has arms {gaps} degrees apart"
    if asked.arms is not None and found.arms not in span(asked.arms):
        yield f"asked for {asked.arms} arms, has {found.arms}"
    if asked.ways and sorted(found.sides) != sorted(asked.ways):
        yield f"asked for ways to the {' and '.join(asked.ways)}, has {' and '.join(found.sides)}"
    if asked.exit is not None and found.exit not in span(asked.exit):
        yield f"asked for exit {asked.exit}, takes exit {found.exit}"
    if asked.take is not None and not takes(found, asked):
        yield f"asked to {TAKES[asked.take]}, turns {found.turn:.0f} degrees"
    if asked.control is not None and not _is_controlled(found, asked):
        yield f"asked for {asked.control}, has {found.control}"
    if asked.skew and min(found.gaps) >= SKEW:
        yield f"asked for skew crossroads, the least angle is {min(found.gaps):.0f} degrees"
    yield from _sizes(found, asked)


def takes(found: MeasuredJunction, asked: JunctionClause) -> bool:
    """Returns whether the route leaves a junction in the required direction."""
    take, turn = asked.take, found.turn
    if take == "back":
        return found.exit == found.arms
    if found.exit == found.arms:
        return False
    if take is not None and take.startswith(("sharp", "slight")):
        side = take.rpartition("_")[2]
        same = [each for each, way in zip(found.ways, found.sides, strict=True) if way == side]
        pick = max if take.startswith("sharp") else min
        return bool(same) and turn == pick(same, key=abs)
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
    if asked.size is not None:
        size = SIZES[asked.size]
        if found.outer not in Range(size.lo - ROUNDING, size.hi + ROUNDING):
            yield f"asked for a {asked.size} roundabout, {size} m wide, is {found.outer:.1f} m wide"
    if asked.radius is not None:
        wanted = span(asked.radius)
        if asked.radius.exact:
            wanted = Range(wanted.lo * (1 - SLACK), wanted.hi * (1 + SLACK))
        if found.island not in wanted:
            yield f"asked for an island of {asked.radius} m radius, has {found.island:.1f} m"
