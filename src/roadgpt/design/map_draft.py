"""Defines the draft of a map: nodes and roads in plan view, before they are placed on the map."""

import cmath
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.junctions import PlainKind
from roadgpt.network.map_design import NodeKind
from roadgpt.network.ring import ring_width

Rng = np.random.Generator
KERBS = (6.0, 10.0)  # m, radius of kerbs between neighbouring roads
STUBS = (20.0, 34.0)  # m, of a road that ends nowhere
BENDS = (18.0, 40.0)  # m, radius of bends where there is room
STRAIGHT = 15.0  # m before and behind a junction that are kept straight: they give its arms their directions
AROUND = 16  # points around a roundabout


@dataclass
class DraftNode:
    """A node of a draft."""

    z: complex
    """Its place as x + iy in metres."""
    kind: NodeKind
    kerb: float = 8.0
    radius: float | None = None

    @property
    def is_junction(self) -> bool:
        """Whether roads meet here."""
        return self.kind not in ("bend", "end")


@dataclass
class MapDraft:
    """Nodes and the roads that join them; nodes are numbered from 0."""

    nodes: list[DraftNode] = field(default_factory=list)
    roads: list[tuple[int, int]] = field(default_factory=list)

    def add(self, node: DraftNode, *joined_to: int) -> int:
        """Adds a node and roads from others to it; returns its number."""
        self.nodes.append(node)
        number = len(self.nodes) - 1
        self.roads += [(other, number) for other in joined_to]
        return number

    def neighbours(self) -> list[list[int]]:
        """Returns the nodes to which roads lead from each node."""
        found: list[list[int]] = [[] for _ in self.nodes]
        for one, other in self.roads:
            found[one].append(other)
            found[other].append(one)
        return found

    def corners(self) -> NDArray[np.complex128]:
        """Returns points in metres around everything that is drawn, but for the width of roads."""
        points = [node.z for node in self.nodes]
        for node in self.nodes:
            if node.kind == "roundabout" and node.radius is not None:
                far = node.radius + ring_width(node.radius)
                points += [node.z + cmath.rect(far, 2 * pi * n / AROUND) for n in range(AROUND)]
        return np.array(points)


def drawn_kerb(rng: Rng, haste: float) -> float:
    """Returns the radius of a kerb in metres; the larger ``haste``, from 0 to 1, the smaller."""
    low, high = KERBS
    return round(low + (high - low) * (1 - haste) * float(rng.random()), 1)


def drawn_stub(rng: Rng, haste: float) -> float:
    """Returns the length in metres of a road that ends nowhere, from the junction's contact on."""
    low, high = STUBS
    return low + (high - low) * (1 - haste) * float(rng.random())


def drawn_bend(rng: Rng, least: float, room: float) -> float | None:
    """Returns the radius of a bend in metres; None if no bend has room.

    Args:
        rng: random number generator.
        least: the smallest radius allowed.
        room: the largest radius that fits.
    """
    low, high = max(least, min(BENDS[0], room)), min(BENDS[1], room)
    if room < least:
        return None
    return float(np.floor(10 * rng.uniform(low, max(low, high))) / 10)


def kind_of(arms: int) -> NodeKind:
    """Returns the kind of a node of a grid by the number of its roads."""
    kinds: Sequence[PlainKind] = ("t_junction", "crossroads", "star")
    return "end" if arms == 1 else "bend" if arms == 2 else kinds[arms - 3]
