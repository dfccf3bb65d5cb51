"""Reads numbers and cubic polynomials from the attributes of OpenDRIVE elements."""

import math
import re
from collections.abc import Iterable
from xml.etree.ElementTree import Element

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.elevation import Cubic

NUMBER = re.compile(r"\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*")
LARGEST = 1e12  # of any number; beyond it, sums are no longer exact to a metre


def number(node: Element, name: str, missing: float | None = None) -> float:
    """Returns an attribute of an element as a finite number; ``missing`` if there is no such attribute. If
    ``missing`` is None, the attribute is required. Raises UsageError if a required attribute is missing, or
    if the attribute is not a number, not finite, or has an absolute value above 1e12.
    """
    text = node.get(name)
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


def cubics(nodes: Iterable[Element], station: str, start: float = 0.0) -> CubicProfile | None:
    """Returns the cubic polynomials that the elements define by a, b, c and d; None if there are no elements.

    The station of a cubic is its attribute named ``station``, plus ``start`` metres; stations ascend. Each
    cubic applies from its station to that of the next cubic. Before the first station, the value is that at
    the first station.
    """
    kept: dict[float, Cubic] = {}
    for node in nodes:
        a, b, c, d = (number(node, name, None if name == "a" else 0.0) for name in "abcd")
        kept[start + number(node, station, 0.0)] = (a, b, c, d)
    if not kept:
        return None
    stations = list(kept)
    if stations[0] > start:
        first = kept[stations[0]][0]
        kept = {start: (first, 0.0, 0.0, 0.0), **kept}
    return CubicProfile(tuple(kept), tuple(kept.values()))
