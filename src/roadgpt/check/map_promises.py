"""Checks whether a map of roads meets its description: blocks or junctions, dead ends, signs, distances, and
the turns of the route.

Everything is measured on the finished network, by ``check.map_measures`` and ``check.junction_measures``.
"""

import math
from collections.abc import Iterable, Iterator, Sequence

from roadgpt.brief.amount import Amount, span
from roadgpt.brief.junctions import NAMES, SIGNS, Control, JunctionCount, MapClause, MapJunctionKind
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import ROAD
from roadgpt.check.finding import Finding
from roadgpt.check.junction_measures import measured_junctions
from roadgpt.check.map_measures import MeasuredMap, MeasuredNode, measured_map
from roadgpt.check.route_promises import length_range
from roadgpt.network import Route
from roadgpt.plural import plural

RULE = "promises"
SHARE = 0.1  # ratio by which a distance between junctions may differ from the requested distance
NEVER_USUAL = ("lights", "stop")
"""Signs that a junction has only on request; a roundabout has signs to give way even without a request."""
CORNERS = 4  # corners of a grid; at each, the road may bend without a junction


def broken_map(route: Route, asked: MapClause, length: Amount | None) -> tuple[Finding, ...]:
    """Returns one Finding for each requirement that the map of a route does not meet. ``length`` is the
    required length of all roads outside junctions, in metres.
    """
    found = measured_map(route.network)
    out = [Finding(RULE, text) for text in (*_complaints(found, asked), *_route(route, asked))]
    if length is not None and found.length not in length_range(length):
        out.append(Finding(RULE, f"asked for {length} m of roads in all, has {found.length:.0f} m"))
    if asked.signed or any(each.control for each in asked.junctions):
        controls = _controls_of_grid if asked.signed else _controls
        return (*out, *(Finding(RULE, text) for text in controls(found, asked)))
    for node in found.nodes:
        if asked.control is not None and not _is_controlled(node, asked.control):
            x, y = node.place
            has = " and ".join(SIGNS[each] for each in sorted(node.controls))
            text = f"asked for {SIGNS[asked.control]} at all junctions, near ({x:.0f}, {y:.0f}): {has}"
            out.append(Finding(RULE, text, None, x, y))
    return tuple(out)


def _route(route: Route, asked: MapClause) -> Iterator[str]:
    """Yields a text if the route does not turn as asked."""
    goes = [each.sides[each.exit - 1] for each in measured_junctions(route)]
    if asked.route and goes != [*asked.route]:
        yield f"asked for a route that goes {', '.join(asked.route)}, goes {', '.join(goes) or 'nowhere'}"


def _complaints(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    """Yields what is wrong with a map, as text."""
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
    """Yields what is wrong with the number of blocks and junctions of a grid."""
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
    """Yields what is wrong with the kinds of the junctions of a map."""
    total = _in_all(asked.junctions)
    if len(found.nodes) not in total:
        yield f"asked for {total} junctions in all, has {len(found.nodes)}"
    free = sum(span(each.count).hi for each in asked.junctions if each.kind == "junction")
    named = [each for each in asked.junctions if each.kind != "junction"]
    for kind in dict.fromkeys(each.kind for each in named):
        own = _in_all(each for each in named if each.kind == kind)
        allowed = Range(own.lo, own.hi + free)
        if found.number(kind) not in allowed:
            yield f"asked for {allowed} of the kind {NAMES[kind][0]}, has {found.number(kind)}"


def _in_all(asked: Iterable[JunctionCount]) -> Range:
    """Returns how many junctions there may be of some kinds together."""
    counts = [span(each.count) for each in asked]
    return Range(sum(each.lo for each in counts), sum(each.hi for each in counts))


def _controls(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    """Yields what is wrong with the signs of a map some of whose kinds of junctions have their own."""
    wanted = [asked.control_of(each) for each in asked.junctions]
    for control in dict.fromkeys(each for each in wanted if each is not None):
        allowed = _in_all(each for each in asked.junctions if asked.control_of(each) == control)
        number = sum(_is_controlled(node, control) for node in found.nodes)
        if number < allowed.lo or (control in NEVER_USUAL and number > allowed.hi):
            yield f"asked for {SIGNS[control]} at {allowed} junctions, has {number}"
    yield from _kinds_with_signs(found, asked, asked.junctions)


def _controls_of_grid(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    """Yields what is wrong with the signs of a grid some of whose junctions have their own; all others have
    that of the grid, or none.
    """
    left = len(found.nodes)
    for control in dict.fromkeys(each.control for each in asked.signed if each.control is not None):
        allowed = _in_all(each for each in asked.signed if each.control == control)
        number = sum(_is_controlled(node, control) for node in found.nodes)
        left -= number
        if number not in allowed:
            yield f"asked for {SIGNS[control]} at {allowed} of the junctions of the grid, has {number}"
    yield from _kinds_with_signs(found, asked, asked.signed)
    usual = asked.control or "none"
    number = sum(_is_controlled(node, usual) for node in found.nodes)
    if number != left:
        yield f"asked for {SIGNS[usual]} at the {left} other junctions of the grid, has {number}"


def _kinds_with_signs(found: MeasuredMap, asked: MapClause, kinds: Sequence[JunctionCount]) -> Iterator[str]:
    """Yields a text for each of some kinds of which too few junctions have the signs that are asked for."""
    for each in kinds:
        held = asked.control_of(each)
        if held is not None:
            number = sum(_is_of(node, each.kind) and _is_controlled(node, held) for node in found.nodes)
            if number < span(each.count).lo:
                kind = NAMES[each.kind][0]
                yield f"asked for {SIGNS[held]} at {each.count} of the kind {kind}, has {number}"


def _is_of(node: MeasuredNode, kind: MapJunctionKind) -> bool:
    """Returns whether a junction is of a kind; "junction" is any kind but a roundabout."""
    return "roundabout" not in node.kinds if kind == "junction" else kind in node.kinds


def _allowed(length: Amount) -> Range:
    """Returns the distances in metres that are allowed between junctions."""
    asked = span(length)
    slack = max(ROAD["length"].slack(asked.lo), SHARE * asked.lo) if asked.lo > 0 else 0.0
    return Range(asked.lo - slack, asked.hi + (slack or SHARE * asked.hi))


def _is_controlled(node: MeasuredNode, control: Control) -> bool:
    """Returns whether a junction has the requested signs: lights and "none" at all arms, others at one at
    least.
    """
    if control in ("none", "priority", "yield") and "roundabout" in node.kinds:
        return node.controls == {"yield"}  # everybody gives way to those on the ring
    if control in ("lights", "none"):
        return node.controls == {control}
    return ("yield" if control == "priority" else control) in node.controls
