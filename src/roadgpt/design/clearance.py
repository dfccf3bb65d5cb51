"""Checks whether the straights of a draft map keep clear of each other and of junctions."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely


class Line(NamedTuple):
    """A straight of a draft, from one point x + iy in metres to another."""

    start: complex
    end: complex
    nodes: frozenset[int]
    """The numbers of the nodes at its ends; lines that share a node may be near each other."""


class Disc(NamedTuple):
    """The circular area of a junction; only roads that lead to the junction may enter it."""

    z: complex
    """Its centre as x + iy in metres."""
    radius: float
    """Its radius in metres."""
    node: int
    """The number of the junction's node; lines that lead to this node may enter the area."""


def is_clear(new: Sequence[Line], lines: Sequence[Line], discs: Sequence[Disc], apart: float) -> bool:
    """Returns whether new lines keep clear of all lines and discs with which they share no node.

    Distances between the new lines are not checked.

    Args:
        new: the new lines; the result is True if there are none.
        lines: the existing lines.
        discs: the areas of existing junctions.
        apart: the least distance in metres between two lines; a line and a disc must be half as far apart.
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
