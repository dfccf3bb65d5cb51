"""Defines the draft of a map of roads: nodes and roads in plan view, before they are placed."""

import cmath
from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.junctions import Control
from roadgpt.network.map_design import NodeKind
from roadgpt.network.ring import ring_width

Rng = np.random.Generator
KERBS = (6.0, 10.0)  # m, radius of kerbs between neighbouring roads
STUBS = (20.0, 34.0)  # m, length of a dead end
BENDS = (18.0, 40.0)  # m, radius of bends where there is room
STRAIGHT = 15.0  # m of each road that are straight at a junction: they set the direction of its arm
AROUND = 16  # number of points around a roundabout


@dataclass
class DraftNode:
    """A node of a draft."""

    z: complex
    """Its place as x + iy in metres."""
    kind: NodeKind
    kerb: float = 8.0
    """Radius in metres of the kerbs between neighbouring roads at a junction."""
    radius: float | None = None
    """Radius in metres of a bend, or of the central island of a roundabout; None at any other node."""
    control: Control = "none"
    """The signs or lights of a junction."""

    @property
    def is_junction(self) -> bool:
        """Whether three or more roads meet here: the node is neither a bend nor an end."""
        return self.kind not in ("bend", "end")


@dataclass
class MapDraft:
    """Nodes, numbered from 0, and roads, each given by the numbers of the two nodes that it joins."""

    nodes: list[DraftNode] = field(default_factory=list)
    roads: list[tuple[int, int]] = field(default_factory=list)

    def add(self, node: DraftNode, *joined_to: int) -> int:
        """Adds a node, and a road to it from each of the nodes ``joined_to``; returns the node's number."""
        self.nodes.append(node)
        number = len(self.nodes) - 1
        self.roads += [(other, number) for other in joined_to]
        return number

    def neighbours(self) -> list[list[int]]:
        """Returns, for each node, the numbers of the nodes to which roads join it."""
        found: list[list[int]] = [[] for _ in self.nodes]
        for one, other in self.roads:
            found[one].append(other)
            found[other].append(one)
        return found

    def corners(self) -> NDArray[np.complex128]:
        """Returns the points that must lie in the square of side ``map_size``, x + iy in metres, ``(n,)``.

        These are all nodes, and 16 points around each roundabout. The width of roads is not included.
        """
        points = [node.z for node in self.nodes]
        for node in self.nodes:
            if node.kind == "roundabout" and node.radius is not None:
                far = node.radius + ring_width(node.radius)
                points += [node.z + cmath.rect(far, 2 * pi * n / AROUND) for n in range(AROUND)]
        return np.array(points)


def drawn_kerb(rng: Rng, haste: float) -> float:
    """Returns a random kerb radius in metres. The larger ``haste``, from 0 to 1, the smaller the radius."""
    low, high = KERBS
    return round(low + (high - low) * (1 - haste) * float(rng.random()), 1)


def drawn_stub(rng: Rng, haste: float) -> float:
    """Returns a random length in metres of a dead end, from its contact: the point where the junction ends.

    The larger ``haste``, from 0 to 1, the shorter the dead end.
    """
    low, high = STUBS
    return low + (high - low) * (1 - haste) * float(rng.random())


def drawn_bend(rng: Rng, least: float, room: float) -> float | None:
    """Returns a random radius of a bend in metres; None if the largest that fits, ``room``, is smaller than
    the smallest allowed, ``least``.
    """
    low, high = max(least, min(BENDS[0], room)), min(BENDS[1], room)
    if room < least:
        return None
    return float(np.floor(10 * rng.uniform(low, max(low, high))) / 10)
