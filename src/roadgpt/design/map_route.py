"""Draws a route through the draft of a map of roads.

If the description says where the route turns, the route takes these turns. Otherwise, it passes several
junctions and turns to both sides where possible.
"""

import cmath
from collections.abc import Iterator, Sequence
from itertools import pairwise

from roadgpt.brief.junction_ranges import side_of
from roadgpt.brief.junctions import Way
from roadgpt.design.map_draft import MapDraft, Rng

WALKS = 60  # number of random walks, of which the best is taken
PASSED = (3, 6)  # number of junctions that a route passes, where possible
LONG = 120.0  # m; a shorter route counts as worse


def drawn_route(draft: MapDraft, rng: Rng) -> list[int] | None:
    """Returns the numbers of the nodes along a random route from one end to another; None if none was found.

    If the map has fewer than two ends, the route leads from one junction to another, or to an end. No node is
    passed twice.
    """
    ends = [n for n, node in enumerate(draft.nodes) if node.kind == "end"]
    to_end = len(ends) > 1
    starts = ends if to_end else [n for n, node in enumerate(draft.nodes) if node.is_junction]
    if not starts:
        return None
    wanted = int(rng.integers(PASSED[0], PASSED[1] + 1))
    neighbours = draft.neighbours()
    best: tuple[tuple[float, ...], list[int]] | None = None
    for _ in range(WALKS):
        walk = _walk(draft, neighbours, starts[int(rng.integers(len(starts)))], wanted, to_end, rng)
        if walk is None:
            continue
        worth = _worth(draft, walk, wanted)
        if best is None or worth > best[0]:
            best = worth, walk
    return None if best is None else best[1]


def named_route(draft: MapDraft, ways: Sequence[Way], rng: Rng) -> list[int] | None:
    """Returns the numbers of the nodes along a route that turns as ``ways`` says at its junctions, in order.

    Returns None if there is no such route. The route starts and finishes at ends where possible, and
    otherwise at junctions. No node is passed twice.
    """
    neighbours = draft.neighbours()
    starts = [n for n, node in enumerate(draft.nodes) if node.kind != "bend"]
    found = [walk for n in starts for walk in _named(draft, neighbours, [n], ways)]
    if not found:
        return None
    ends = [sum(draft.nodes[walk[n]].kind == "end" for n in (0, -1)) for walk in found]
    best = [walk for walk, number in zip(found, ends, strict=True) if number == max(ends)]
    return best[int(rng.integers(len(best)))]


def _named(
    draft: MapDraft, neighbours: Sequence[Sequence[int]], walk: list[int], ways: Sequence[Way]
) -> Iterator[list[int]]:
    """Yields all routes that begin with ``walk`` and go the given ways from there on."""
    here = draft.nodes[walk[-1]]
    is_first = len(walk) == 1
    if not is_first and not ways and here.kind != "bend":
        yield walk
        return
    if here.kind == "end" and not is_first:
        return
    passes = here.is_junction and not is_first
    for other in neighbours[walk[-1]]:
        if other in walk:
            continue
        if passes:
            z = [draft.nodes[n].z for n in (walk[-2], walk[-1], other)]
            if side_of(_degrees(z[0], z[1], z[2])) != ways[0]:
                continue
        yield from _named(draft, neighbours, [*walk, other], ways[1:] if passes else ways)


def _walk(
    draft: MapDraft, neighbours: Sequence[Sequence[int]], start: int, wanted: int, to_end: bool, rng: Rng
) -> list[int] | None:
    """Returns the nodes of a random walk that reaches an end or, if ``to_end`` is False, another junction;
    None if the walk reaches neither.
    """
    walk, passed = [start], 0
    while True:
        ways = [n for n in neighbours[walk[-1]] if n not in walk]
        if not ways:
            break
        walk.append(ways[int(rng.integers(len(ways)))])
        kind = draft.nodes[walk[-1]].kind
        if kind == "end":
            return walk
        if kind != "bend":
            if not to_end and passed == wanted:
                return walk
            passed += 1
    if to_end:
        return None
    while len(walk) > 1 and not draft.nodes[walk[-1]].is_junction:
        walk.pop()
    return walk if len(walk) > 1 else None


def _worth(draft: MapDraft, walk: Sequence[int], wanted: int) -> tuple[float, ...]:
    """Returns numbers by which routes are compared; the larger, the better."""
    inner = [n for n in range(1, len(walk) - 1) if draft.nodes[walk[n]].is_junction]
    z = [draft.nodes[n].z for n in walk]
    sides = {side_of(_degrees(z[n - 1], z[n], z[n + 1])) for n in inner}
    length = sum(abs(b - a) for a, b in pairwise(z))
    near = -abs(len(inner) - wanted)
    turns = len(sides & {"left", "right"})
    return float(bool(inner)), float(length >= LONG), float(turns), float(near)


def _degrees(before: complex, here: complex, after: complex) -> float:
    """Returns the change of direction at a node in degrees, positive to the left."""
    return cmath.phase((after - here) / (here - before)) * 180 / cmath.pi
