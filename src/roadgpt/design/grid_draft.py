"""Drafts grids of streets with rectangular blocks between them, and a few roads that lead out of the grid.

The spacing of the streets varies, and nodes are moved a little. A corner of the grid is a bend that joins two
streets, or a junction if a road leads out there.
"""

import cmath
from collections.abc import Sequence
from math import inf, pi

import numpy as np

from roadgpt.brief.amount import Amount, span
from roadgpt.brief.junctions import JunctionCount, MapClause
from roadgpt.brief.ranges import Range, overlap
from roadgpt.design.map_draft import DraftNode, MapDraft, Rng, drawn_bend, drawn_kerb, drawn_stub
from roadgpt.network.map_design import NodeKind
from roadgpt.network.turning import tangent_length

LEAST_BLOCK = 48.0  # m, least side of a block if no length is required; a smaller one has no room for bends
MOST_BLOCK = 100.0  # m, greatest usual side of a block if no length is required
UNEVEN = 0.12  # greatest change of the distance between two streets, as a share of the usual distance
MOVED = 0.06  # greatest displacement of nodes along x and y, as a share of the smallest side of a block
ASKED = 0.025  # replaces both shares if a length is required
LEANING = 8.0  # degrees, greatest angle between a road out of the grid and its usual direction
ENTRANCES = (2, 4)  # number of roads that lead out of a grid, if none is required
CONTACT = 13.0  # m, approximate distance from a node to the start of its roads
ALIKE = 2  # how far a count may exceed its lower limit if it has no upper limit
SIDES: tuple[tuple[int, int], ...] = ((-1, 0), (1, 0), (0, -1), (0, 1))
KINDS: tuple[NodeKind, ...] = ("end", "bend", "t_junction", "crossroads", "star")
"""The kind of a node of a grid at which 1, 2, 3, 4 or 5 roads meet, in this order."""

Cell = tuple[int, int]
"""The column and the row of a node, from 0."""


def draft_grid(asked: MapClause, room: float, least_radius: float, rng: Rng, haste: float) -> MapDraft | None:
    """Returns a random draft of a grid; None if the draft leaves too little room for its bends.

    ``room`` is the side in metres of the square into which the grid should fit, and ``least_radius`` the
    smallest radius in metres of a bend. The larger ``haste``, from 0 to 1, the smaller the grid.
    """
    size = drawn_count(asked.columns, rng), drawn_count(asked.rows, rng)
    entrances = _entrances(size, asked.dead_ends, rng, haste)
    lengths = [
        drawn_streets(count, asked.length, room - _outside(entrances, axis), rng, haste)
        for axis, count in enumerate(size)
    ]
    xs, ys = (np.concatenate([[0.0], np.cumsum(each)]) for each in lengths)
    moved = (ASKED if asked.length else MOVED) * min(map(min, lengths))
    draft, numbers = MapDraft(), dict[Cell, int]()
    for i, x in enumerate(xs):
        for j, y in enumerate(ys):
            z = complex(x, y) + complex(*rng.uniform(-moved, moved, 2))
            joined = [numbers[cell] for cell in ((i - 1, j), (i, j - 1)) if cell in numbers]
            node = DraftNode(z, "end", drawn_kerb(rng, haste), control=asked.control or "none")
            numbers[i, j] = draft.add(node, *joined)
    for cell, side in entrances:
        way = cmath.rect(1.0, cmath.phase(complex(*side)) + rng.uniform(-LEANING, LEANING) * pi / 180)
        node = draft.nodes[numbers[cell]]
        draft.add(DraftNode(node.z + way * (CONTACT + drawn_stub(rng, haste)), "end"), numbers[cell])
    inner = [draft.nodes[n] for (i, j), n in numbers.items() if 0 < i < size[0] and 0 < j < size[1]]
    return (
        draft
        if with_kinds_and_bends(draft, least_radius, rng) and _signed(draft, asked.signed, inner, rng)
        else None
    )


def drawn_count(asked: Amount | None, rng: Rng, most: int = 8, least: int = 1) -> int:
    """Returns a random whole number that ``asked`` allows and that lies between ``least`` and ``most``.

    If ``asked`` is None or has no upper limit, the result exceeds the lowest possible number by 2 at most.
    There must be at least one possible number.
    """
    both = overlap(span(asked), Range(least, most))
    assert both is not None
    low = int(np.ceil(both.lo))
    high = int(both.hi) if span(asked).hi < inf else min(int(both.hi), low + ALIKE)
    return int(rng.integers(low, max(low, high) + 1))


def _entrances(
    size: tuple[int, int], asked: Amount | None, rng: Rng, haste: float
) -> list[tuple[Cell, tuple[int, int]]]:
    """Returns the nodes at which roads lead out of a grid, each with its side.

    If no number is asked for, in great haste there are none where junctions remain.
    """
    columns, rows = size
    if asked is None and haste > 0.7 and max(columns, rows) > 1:
        return []
    places = []
    for side in SIDES:
        along = rows if side[0] else columns
        for n in range(along + 1):
            cell = (0 if side[0] < 0 else columns, n) if side[0] else (n, 0 if side[1] < 0 else rows)
            places.append((cell, side))
    order = [places[n] for n in rng.permutation(len(places))]
    chosen = dict[Cell, tuple[int, int]]()
    for cell, side in order:
        chosen.setdefault(cell, side)
    if asked is not None:
        count = drawn_count(asked, rng, len(chosen), least=0)
    else:
        count = int(rng.integers(ENTRANCES[0], ENTRANCES[1] + 1)) if haste < 0.4 else ENTRANCES[0]
    return list(chosen.items())[:count]


def _outside(entrances: list[tuple[Cell, tuple[int, int]]], axis: int) -> float:
    """Returns the metres that roads out of the grid need beside it, along x (0) or y (1)."""
    return sum(CONTACT + 25.0 for side in {side for _, side in entrances} if side[axis])


def drawn_streets(count: int, asked: Amount | None, room: float, rng: Rng, haste: float) -> list[float]:
    """Returns the distances in metres between neighbouring streets."""
    if asked is None:
        most = min(max(room / count / (1 + UNEVEN / 2), LEAST_BLOCK), MOST_BLOCK)
        usual = LEAST_BLOCK + (most - LEAST_BLOCK) * (1 - haste * float(rng.random()))
        return [max(usual * (1 + float(rng.uniform(-UNEVEN, UNEVEN))), LEAST_BLOCK) for _ in range(count)]
    allowed = span(asked)
    low = allowed.lo if allowed.lo > 0 else min(LEAST_BLOCK, allowed.hi)
    high = min(allowed.hi, 1.3 * low)
    usual = float(rng.uniform(low, high)) if high > low else low
    return [usual * (1 + float(rng.uniform(-ASKED, ASKED))) for _ in range(count)]


def _signed(draft: MapDraft, asked: Sequence[JunctionCount], inner: Sequence[DraftNode], rng: Rng) -> bool:
    """Gives random junctions of a draft the signs that are asked for; returns whether there are enough.

    Signs at crossroads stand within the grid first, where every junction has four arms.
    """
    free = [node for node in draft.nodes if node.is_junction]
    for each in sorted(asked, key=lambda each: each.kind == "junction"):
        fitting = [node for node in free if each.kind in ("junction", node.kind)]
        if span(each.count).lo > len(fitting):
            return False
        count = drawn_count(each.count, rng, len(fitting), least=0)
        outer = {
            n
            for n, node in enumerate(fitting)
            if each.kind == "crossroads" and not any(node is one for one in inner)
        }
        order = sorted(rng.permutation(len(fitting)), key=lambda n, outer=outer: n in outer)  # type: ignore[misc]
        for n in order[:count]:
            fitting[n].control = each.control or "none"
            free.remove(fitting[n])
    return True


def with_kinds_and_bends(draft: MapDraft, least_radius: float, rng: Rng) -> bool:
    """Gives each node its kind, and each bend its radius; returns whether all bends have room."""
    ends = draft.neighbours()
    for number, node in enumerate(draft.nodes):
        node.kind = KINDS[len(ends[number]) - 1]
    for number, node in enumerate(draft.nodes):
        if node.kind != "bend":
            continue
        one, other = (draft.nodes[n] for n in ends[number])
        turn = pi - abs(cmath.phase((one.z - node.z) / (other.z - node.z)))
        room = min(
            abs(each.z - node.z) * (0.48 if each.kind == "bend" else 1.0)
            - (0.0 if each.kind == "bend" else each.kerb * 1.3 + 9.0)
            for each in (one, other)
        )
        radius = drawn_bend(rng, least_radius, room / tangent_length(turn) if turn > 0 else inf)
        if radius is None:
            return False
        node.radius = radius
    return True
