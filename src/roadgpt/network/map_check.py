"""Checks the graph of a map and the route through it, and raises the first fault as a UsageError."""

import math
from collections.abc import Sequence
from itertools import pairwise

from roadgpt.errors import UsageError
from roadgpt.network.design import ASTERN, COUNTS
from roadgpt.plural import plural

NEAREST = 1.0  # m, least distance between two nodes that a road joins
STEEPEST_BEND = 150.0  # degrees, largest angle by which a road may turn at a bend

Place = tuple[float, float, float]
"""x, y and height of a node, in metres."""


def check_graph(kinds: Sequence[str], places: Sequence[Place], roads: Sequence[tuple[int, int]]) -> None:
    """Checks the roads and nodes of a map.

    Every road must join two existing nodes that are at least ``NEAREST`` metres apart, and no two roads may
    join the same nodes. Every node must have as many roads as its kind needs, with large enough angles
    between them. The roads must connect all nodes, and at least one node must not be a bend.

    Args:
        kinds: The kind of each node.
        places: The place of each node.
        roads: Pairs of nodes, which are numbered from 1.

    Raises:
        UsageError: One of these conditions does not hold; the message names the first fault.
    """
    ends: dict[int, list[int]] = {number: [] for number in range(1, len(kinds) + 1)}
    for number, (one, other) in enumerate(roads, 1):
        for each in (one, other):
            if each not in ends:
                raise UsageError(f"road {number} names node {each}, and there are nodes 1 to {len(kinds)}")
        if one == other:
            raise UsageError(f"road {number} joins node {one} to itself; give two different nodes")
        if other in ends[one]:
            raise UsageError(
                f"two roads join nodes {one} and {other}; leave one out, or lead it over another node"
            )
        (x, y, _), (to_x, to_y, _) = places[one - 1], places[other - 1]
        if math.hypot(to_x - x, to_y - y) < NEAREST:
            raise UsageError(
                f"nodes {one} and {other} are less than {NEAREST:g} m apart; move them apart or make them one"
            )
        ends[one].append(other)
        ends[other].append(one)
    for number, others in ends.items():
        _check_node(number, kinds[number - 1], others)
        _check_angles(number, kinds[number - 1], places, others)
    _check_connected(kinds, ends)


def _check_node(number: int, kind: str, others: Sequence[int]) -> None:
    """Raises UsageError unless a node has as many roads as its kind needs."""
    least, most = {"end": (1, 1), "bend": (2, 2)}.get(kind, (0, 0))
    if not most:
        least, most = (each + 1 for each in next(v for k, v in COUNTS.items() if k == kind))
    if not least <= len(others) <= most:
        wanted = plural(most, "road") if least == most else f"{least} to {most} roads"
        here = plural(len(others), "road")
        name = f"{'an' if kind == 'end' else 'a'} {kind}"
        raise UsageError(
            f"node {number} is {name}, which has {wanted}, and here it has {here}; change its kind or the "
            "roads"
        )


def _check_angles(number: int, kind: str, places: Sequence[Place], others: Sequence[int]) -> None:
    """Raises UsageError if two roads leave a node in nearly the same direction."""
    x, y, _ = places[number - 1]
    out = sorted((math.degrees(math.atan2(places[n - 1][1] - y, places[n - 1][0] - x)), n) for n in others)
    if len(out) < 2:
        return
    least = 180 - STEEPEST_BEND if kind == "bend" else ASTERN
    for (a, one), (b, other) in pairwise([*out, (out[0][0] + 360, out[0][1])]):
        if b - a < least - 1e-9:
            raise UsageError(
                f"the roads from node {number} to nodes {one} and {other} are {b - a:.0f} degrees apart, and "
                f"{least:g} are needed; move one of these nodes"
            )


def _check_connected(kinds: Sequence[str], ends: dict[int, list[int]]) -> None:
    if all(kind == "bend" for kind in kinds):
        raise UsageError("all nodes are bends, so that no road begins or ends; add an end or a junction")
    seen, waiting = {1}, [1]
    while waiting:
        new = [n for n in ends[waiting.pop()] if n not in seen]
        seen.update(new)
        waiting += new
    lost = next((number for number in ends if number not in seen), None)
    if lost is not None:
        raise UsageError(f"no roads lead from node 1 to node {lost}; join them or leave node {lost} out")


def check_route(kinds: Sequence[str], roads: Sequence[tuple[int, int]], route: Sequence[int]) -> None:
    """Checks that a route follows roads, turns back at roundabouts only, and has no bend at its ends.

    Args:
        kinds: The kind of each node.
        roads: Pairs of nodes, which are numbered from 1.
        route: Two or more nodes in driving order.

    Raises:
        UsageError: One of these conditions does not hold; the message names the first fault.
    """
    joined = {frozenset(pair) for pair in roads}
    for one, other in pairwise(route):
        if frozenset((one, other)) not in joined:
            raise UsageError(f"the route goes from node {one} to node {other}, and no road joins them")
    for n in (0, -1):
        if kinds[route[n] - 1] == "bend":
            raise UsageError(
                f"the route begins or ends at node {route[n]}, a bend; take a junction or an end"
            )
    for before, here, after in zip(route, route[1:], route[2:], strict=False):
        if before == after and kinds[here - 1] != "roundabout":
            raise UsageError(
                f"the route turns back at node {here}, and one can only at a roundabout; leave out the rest"
            )
