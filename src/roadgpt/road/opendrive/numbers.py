"""Reads numbers and cubic polynomials from the attributes of OpenDRIVE elements."""

import math
import re
from collections.abc import Iterable

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.road.opendrive.tree import Node

NUMBER = re.compile(r"\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*")
LARGEST = 1e12  # of any number; beyond it, sums are no longer exact to a metre

Cubic = tuple[float, float, float, float]


def number(node: Node, name: str, missing: float | None = None) -> float:
    """Returns an attribute of an element as a finite number.

    Args:
        node: The element that has the attribute.
        name: Name of the attribute.
        missing: Value to return if the attribute is missing; None if the attribute is required.

    Raises:
        UsageError: The attribute is missing, not a number, not finite, or has an absolute value above 1e12.
    """
    text = node.attributes.get(name)
    if text is None:
        if missing is None:
            raise UsageError(f"a <{node.tag}> has no {name}; add it")
        return missing
    if not NUMBER.fullmatch(text) or len(text) > 400:
        raise UsageError(f"in a <{node.tag}>, {name} is '{text[:40]}', which is not a number; correct it")
    value = float(text)
    if not math.isfinite(value) or abs(value) > LARGEST:
        raise UsageError(f"in a <{node.tag}>, {name} is {text[:40]}, which is too large; correct it")
    return value


def cubic(node: Node) -> Cubic:
    """Returns the attributes a, b, c and d as a cubic polynomial; b, c and d are 0 if they are missing."""
    return (number(node, "a"), number(node, "b", 0.0), number(node, "c", 0.0), number(node, "d", 0.0))


def cubics(nodes: Iterable[Node], station: str, start: float = 0.0) -> CubicProfile | None:
    """Returns the cubic polynomials that the elements define; None if there are no elements.

    Each cubic applies from its own station to the station of the next cubic. Before the first station, the
    value is that of the first cubic at this station.

    Args:
        nodes: Elements with the attributes a, b, c and d.
        station: Name of the attribute with the station at which a cubic begins.
        start: Distance in metres that is added to each station.
    """
    rows = sorted(
        ((start + number(node, station, 0.0), cubic(node)) for node in nodes), key=lambda row: row[0]
    )
    kept: dict[float, Cubic] = {}
    for s, coefficients in rows:
        kept[s] = coefficients  # where several begin at one station, the last one applies
    if not kept:
        return None
    stations = list(kept)
    if stations[0] > start:
        first = kept[stations[0]][0]
        kept = {start: (first, 0.0, 0.0, 0.0), **kept}
    return CubicProfile(tuple(kept), tuple(kept.values()))
