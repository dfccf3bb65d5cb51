"""Measures a whole network as a map: its junctions and their kinds, blocks, ends, signs and distances."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from roadgpt.brief.junctions import Control, JunctionKind
from roadgpt.check.junction_measures import directions_of, kinds_of
from roadgpt.network import Junction, Network, RoadEnd

STRAIGHT = math.radians(5.0)  # largest change of heading of a road that counts as straight


@dataclass(frozen=True)
class MeasuredNode:
    """A junction or a roundabout of a map."""

    place: tuple[float, float]
    """Its middle (x, y) in metres."""
    kinds: tuple[JunctionKind, ...]
    """The kinds that the junction may be called; empty if its angles fit no kind."""
    gaps: tuple[float, ...]
    """Angles in degrees between neighbouring arms, in order around the junction."""
    controls: frozenset[Control]
    """The signs and lights of its arms."""


@dataclass(frozen=True)
class MeasuredMap:
    """The measures of a whole network."""

    nodes: tuple[MeasuredNode, ...]
    """The junctions. A roundabout counts as one junction."""
    blocks: int
    """The number of areas that roads enclose."""
    ends: int
    """The number of road ends that meet no junction."""
    parts: int
    """The number of separate parts, which no roads connect; 1 for a connected map."""
    distances: tuple[float, ...]
    """For each straight road between two junctions, the distance in metres between their middles."""
    length: float
    """The length in metres of all roads outside junctions."""

    def number(self, kind: JunctionKind) -> int:
        """Returns the number of junctions that have this kind among their ``kinds``."""
        return sum(kind in node.kinds for node in self.nodes)


def measured_map(network: Network) -> MeasuredMap:
    """Measures a network; a roundabout counts as one junction."""
    found = [_node(network, junctions) for _, junctions in network.nodes]
    number_of = {junction.id: n for n, (_, group) in enumerate(network.nodes) for junction in group}
    roads = network.roads_outside
    joined, distances, ends = list[tuple[int, int]](), list[float](), 0
    for member in roads:
        met = []
        for contact in (RoadEnd(member.id, "start"), RoadEnd(member.id, "end")):
            junction = network.junction_at.get(contact)
            if junction is None:
                ends += 1
                met.append(len(found) + ends - 1)
            else:
                met.append(number_of[junction])
        joined.append((met[0], met[1]))
        if max(met) < len(found) and _is_straight(network, member.id):
            distances.append(math.dist(found[met[0]].place, found[met[1]].place))
    count = len(found) + ends
    graph = coo_array((np.ones(len(joined)), np.reshape(joined, (-1, 2)).T), (count, count))
    parts, _ = connected_components(graph, directed=False)
    length = sum(member.road.length for member in roads)
    return MeasuredMap(tuple(found), len(roads) - count + parts, ends, parts, tuple(distances), length)


def _node(network: Network, junctions: tuple[Junction, ...]) -> MeasuredNode:
    is_ring = junctions[0].id in network.roundabout_of
    # the first arm of each junction of a roundabout is the one that is no part of the ring
    arms = [each.arms[0] for each in junctions] if is_ring else list(junctions[0].arms)
    directions = directions_of(network, [arm.end for arm in arms])
    around = -1 if is_ring and network.left_hand else 1
    gaps = [around * (b - a) % 360 for a, b in pairwise([*directions, directions[0]])]
    kinds: tuple[JunctionKind, ...] = ("roundabout",) if is_ring else kinds_of(gaps)
    x, y, _ = junctions[0].node
    return MeasuredNode((x, y), kinds, tuple(gaps), frozenset(arm.control for arm in arms))


def _is_straight(network: Network, number: int) -> bool:
    road = network.road(number).road
    return abs(float(road.heading(road.length) - road.heading(0.0))) < STRAIGHT and math.isclose(
        road.length, math.dist(road.at(0.0)[:2].tolist(), road.at(road.length)[:2].tolist()), rel_tol=0.01
    )
