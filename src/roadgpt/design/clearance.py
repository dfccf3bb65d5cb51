"""Tells whether straights of a map that is drafted keep off each other and off junctions."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely


class Line(NamedTuple):
    """A straight of a draft, from one point x + iy in metres to another."""

    start: complex
    end: complex
    nodes: frozenset[int]
    """The nodes that it joins; lines that share a node may be near each other."""


class Disc(NamedTuple):
    """The area around a junction that other roads keep off."""

    z: complex
    """Its middle as x + iy in metres."""
    radius: float
    node: int
    """The node of the junction; lines that lead to it may be near it."""


def is_clear(new: Sequence[Line], lines: Sequence[Line], discs: Sequence[Disc], apart: float) -> bool:
    """Returns whether new lines keep off all lines and discs with which they share no node.

    Args:
        new: the new lines.
        lines: the lines that are there.
        discs: the junctions that are there.
        apart: the least distance in metres between two lines; half of it is that from a disc.
    """
    if not new:
        return True
    ours = _shapes(new)
    for others, least in (
        (list(lines), np.full(len(lines), apart)),
        ([Line(each.z, each.z, frozenset({each.node})) for each in discs], _radii(discs) + apart / 2),
    ):
        if not others:
            continue
        away = shapely.distance(ours[:, None], _shapes(others)[None, :])
        meet = np.array([[bool(a.nodes & b.nodes) for b in others] for a in new])
        if (~meet & (away < least)).any():
            return False
    return True


def _radii(discs: Sequence[Disc]) -> np.ndarray:
    return np.array([each.radius for each in discs])


def _shapes(lines: Sequence[Line]) -> np.ndarray:
    z = np.array([(line.start, line.end) for line in lines])
    return np.asarray(shapely.linestrings(np.stack((z.real, z.imag), axis=-1)))
