"""Reads what the lanes of an OpenDRIVE road state along it, and chooses one value where a Road has only one:
the one that holds for the longest part. What is not taken is told in sentences.
"""

from collections.abc import Callable, Iterable, Sequence
from itertools import groupby
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element

from roadgpt.road.opendrive.lanes import Span
from roadgpt.road.opendrive.numbers import number
from roadgpt.road.world import FRICTIONS, SPEEDS

UNITS = {"m/s": 1.0, "km/h": 3.6, "mph": 3600 / 1609.344}  # per m/s
MOST_CHANGES = 3  # that a sentence lists


class MarkedLane(NamedTuple):
    """A lane in one lane section. Its XML element, ``node``, holds what is stated about the lane."""

    span: Span
    node: Element


class Stretch(NamedTuple):
    """A part of the road between two stations in metres, with what is stated there; None if nothing is."""

    start: float
    end: float
    value: Any


def stated(lanes: Iterable[MarkedLane], tag: str, read: Callable[[Element], Any]) -> list[Stretch]:
    """Returns what the records ``tag`` of a lane state, in order along the road. ``read`` reads a record."""
    out: list[Stretch] = []
    for span, lane in lanes:
        nodes = lane.findall(tag)
        starts = [span.section.s + number(node, "sOffset", 0.0) for node in nodes]
        held = [span.start, *(min(max(start, span.start), span.end) for start in starts), span.end]
        out += map(Stretch, held, held[1:], [None, *map(read, nodes)])
    return out


def longest_first(stretches: Iterable[Stretch]) -> list[Any]:
    """Returns the values that are stated, that of the longest part of the road first."""
    lengths: dict[Any, float] = {}
    for start, end, value in stretches:
        if value is not None and end > start:
            lengths[value] = lengths.get(value, 0.0) + end - start
    return sorted(lengths, key=lambda value: -lengths[value])


def speed_limit(
    road: Element, lanes: Sequence[Sequence[MarkedLane]], length: float, remarks: list[str]
) -> float | None:
    """Returns the speed limit of the driven lane in m/s; that of the road where the lane states none. The
    first of ``lanes`` are the driven lane in each lane section, the others all further lanes.
    """

    def read(node: Element | None) -> float | None:
        if node is None or node.get("max") is None:
            return None
        if (unit := node.get("unit", "m/s")) not in UNITS:
            remarks.append(f"a speed limit is in '{unit[:20]}', and is taken as one in m/s")
        is_none = node.get("max") in ("no limit", "undefined")
        return 0.0 if is_none else number(node, "max") / UNITS.get(unit, 1.0)

    def said(limit: float) -> str:
        return f"{limit * 3.6:.4g} km/h" if limit else "0, or of no limit,"

    own, others = (stated(each, "speed", read) for each in lanes)
    types = road.findall("type")
    starts = [0.0, *(min(max(number(node, "s", 0.0), 0.0), length) for node in types), length]
    general = [*map(Stretch, starts, starts[1:], [None, *(read(node.find("speed")) for node in types)])]
    usual = next(iter(longest_first(general)), None)
    filled = [each._replace(value=usual) if each.value is None else each for each in own]
    found = filled if longest_first(own) else general
    return _one("speed limit", found, [*general, *others], said, SPEEDS, remarks)


def friction(lanes: Sequence[Sequence[MarkedLane]], remarks: list[str]) -> float | None:
    """Returns the friction coefficient of the driven lane; see ``speed_limit``."""

    def read(node: Element) -> float | None:
        return number(node, "friction") if "friction" in node.attrib else None

    found, beside = (stated(each, "material", read) for each in lanes)
    return _one("friction", found, beside, "{:g}".format, FRICTIONS, remarks)


def _one(
    what: str,
    found: list[Stretch],
    beside: list[Stretch],
    said: Callable[[float], str],
    limits: tuple[float, float],
    remarks: list[str],
) -> float | None:
    """Returns the value that holds for the longest part of the driven lane, within its limits."""
    for row in (found, beside):
        for n, (s, _, value) in enumerate(row):
            if value is not None and value <= 0:
                remarks.append(f"a {what} of {said(value)} at s = {s:g} m is not used")
                row[n] = row[n]._replace(value=None)
    values = longest_first(found)
    used = min(max(values[0], limits[0]), limits[1]) if values else None
    if used is not None and used != values[0]:
        where = next(each.start for each in found if each.value == values[0])
        remarks.append(f"its {what} of {said(values[0])} at s = {where:g} m is taken as {said(used)}")
    parts = groupby((each for each in found if each.end > each.start), lambda each: each.value)
    firsts = [next(group) for _, group in parts]
    texts = ["none" if each.value is None else said(each.value) for each in firsts]
    steps = [f"to {text} at s = {each.start:g} m" for each, text in zip(firsts, texts, strict=True)][1:]
    if used is not None and steps:
        more = f" and so on ({len(steps)} changes)" if len(steps) > MOST_CHANGES else ""
        changes = f"changes from {texts[0]} {', '.join(steps[:MOST_CHANGES])}{more}"
        remarks.append(f"its {what} {changes}; {said(used)} is used everywhere")
    if further := [value for value in longest_first(beside) if value not in values]:
        listed = " and ".join(map(said, further[:MOST_CHANGES]))
        remarks.append(f"a {what} of {listed} is stated for other lanes, or the whole road, and is not used")
    return used
