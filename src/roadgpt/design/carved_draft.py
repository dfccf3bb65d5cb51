"""Drafts maps whose roads have few dead ends: streets are taken out of a grid until its junctions are of the
required kinds.

Roads that are joined at random, as in ``village_draft``, seldom use up every arm. In a grid, all arms lead
somewhere. If the street between two crossroads is taken out, both become T-junctions. If the street between
two T-junctions is taken out, a road leads on at both places.
"""

import cmath
from collections import Counter
from collections.abc import Mapping, Sequence
from math import pi

import numpy as np

from roadgpt.brief.junctions import JunctionCount, MapClause, MapJunctionKind
from roadgpt.design.grid_draft import (
    CONTACT,
    MOVED,
    SIDES,
    Cell,
    drawn_count,
    drawn_streets,
    with_kinds_and_bends,
)
from roadgpt.design.map_draft import DraftNode, MapDraft, Rng, drawn_kerb, drawn_stub

FEW_ENDS = 3
"""Greatest number of dead ends for which a grid is carved."""
ARMS: Mapping[MapJunctionKind, tuple[int, ...]] = {
    "crossroads": (4,),
    "t_junction": (3,),
    "roundabout": (3, 4),
    "junction": (3, 4),
}
SPARE = 9  # greatest number of nodes of a grid that are no junctions in the end, beside its corners
CARVINGS = 60  # grids that are tried
IDLE = 0.25  # chance of taking out a street that brings the grid no nearer
ISLANDS = (12.0, 15.0)  # m, radii of the central islands of roundabouts
Street = frozenset[Cell]


def can_be_carved(asked: MapClause) -> bool:
    """Returns whether a grid can have the junctions of a map: few dead ends, and three or four arms each."""
    ends = asked.dead_ends
    has_few = ends is not None and ends.exact and (ends.lo or 0) <= FEW_ENDS
    return has_few and asked.blocks is None and all(each.kind in ARMS for each in asked.junctions)


def draft_carved(
    asked: MapClause, room: float, least_radius: float, rng: Rng, haste: float
) -> MapDraft | None:
    """Returns the draft of a map for which ``can_be_carved`` is true; None if none was found.

    The other arguments are those of ``draft_grid``.
    """
    kinds = [each for each in asked.junctions for _ in range(drawn_count(each.count, rng))]
    ends = int(asked.dead_ends.lo or 0) if asked.dead_ends else 0
    for _ in range(CARVINGS):
        arms = [int(rng.choice(ARMS[each.kind])) for each in kinds]
        if (arms.count(3) + ends) % 2:
            continue
        size = _drawn_size(len(kinds), rng)
        carved = _carved(size, Counter(arms), ends, rng)
        if carved is not None:
            lengths = [drawn_streets(count, asked.length, room, rng, haste) for count in size]
            draft = _placed(*carved, lengths, rng, haste)
            return draft if _finished(draft, asked, kinds, arms, least_radius, rng) else None
    return None


def _drawn_size(junctions: int, rng: Rng) -> tuple[int, int]:
    """Returns the random numbers of columns and rows of a grid with enough nodes."""
    sizes = [
        (columns, rows)
        for columns in range(1, junctions + 2)
        for rows in range(1, columns + 1)
        if 0 <= (columns + 1) * (rows + 1) - 4 - junctions <= SPARE
    ]
    columns, rows = sizes[int(rng.integers(len(sizes)))]
    return (columns, rows) if rng.random() < 0.5 else (rows, columns)


def _carved(
    size: tuple[int, int], wanted: Counter[int], ends: int, rng: Rng
) -> tuple[set[Street], list[tuple[Cell, tuple[int, int]]]] | None:
    """Returns the streets that are left of a grid, and the places and sides of its dead ends.

    None if no junctions with the numbers of arms in ``wanted`` are left.
    """
    cells = [(i, j) for i in range(size[0] + 1) for j in range(size[1] + 1)]
    streets = {frozenset((cell, (cell[0] + 1, cell[1]))) for cell in cells if cell[0] < size[0]}
    streets |= {frozenset((cell, (cell[0], cell[1] + 1))) for cell in cells if cell[1] < size[1]}
    outward = [(c, s) for c in cells for s in SIDES if (c[0] + s[0], c[1] + s[1]) not in cells]
    stubs = [outward[n] for n in rng.permutation(len(outward))[:ends]]
    order = sorted(streets, key=sorted)
    for n in [*rng.permutation(len(order)), *rng.permutation(len(order))]:
        street, arms = order[n], _arms(streets, stubs)
        missing = _distance(arms, wanted)
        if not missing:
            return streets, stubs
        rest = streets - {street}
        nearer = _distance(_arms(rest, stubs), wanted) < missing
        if street in streets and (nearer or rng.random() < IDLE) and _is_whole(rest, arms, street):
            streets = rest
    return (streets, stubs) if not _distance(_arms(streets, stubs), wanted) else None


def _arms(streets: set[Street], stubs: Sequence[tuple[Cell, tuple[int, int]]]) -> Counter[Cell]:
    """Returns the number of roads that meet at each place."""
    return Counter([cell for street in streets for cell in street] + [cell for cell, _ in stubs])


def _distance(arms: Counter[Cell], wanted: Counter[int]) -> int:
    """Returns by how many junctions a grid differs from the wanted one."""
    found = Counter(arms.values())
    return sum(abs(found[number] - wanted[number]) for number in (3, 4))


def _is_whole(streets: set[Street], arms: Counter[Cell], gone: Street) -> bool:
    """Returns whether a grid without a street is connected and has no new dead end."""
    led_to = {cell for street in streets for cell in street}
    if any(arms[cell] < 3 or cell not in led_to for cell in gone):
        return False
    first = next(iter(streets))
    reached, ahead = set[Cell](), [*first]
    while ahead:
        cell = ahead.pop()
        if cell not in reached:
            reached.add(cell)
            ahead += [other for street in streets if cell in street for other in street]
    return all(cell in reached for street in streets for cell in street)


def _placed(
    streets: set[Street],
    stubs: Sequence[tuple[Cell, tuple[int, int]]],
    lengths: Sequence[Sequence[float]],
    rng: Rng,
    haste: float,
) -> MapDraft:
    """Returns the draft of a carved grid; where a road only leads on, it has no node."""
    xs, ys = (np.concatenate([[0.0], np.cumsum(each)]) for each in lengths)
    moved = MOVED * min(map(min, lengths))
    joined: dict[Cell, list[Cell]] = {}
    for one, other in map(sorted, streets):
        joined.setdefault(one, []).append(other)
        joined.setdefault(other, []).append(one)
    on_stub = {cell for cell, _ in stubs}
    for cell in sorted(joined):
        ends = joined[cell]
        if len(ends) == 2 and cell not in on_stub and _is_straight(cell, *ends):
            for end, other in (ends, ends[::-1]):
                joined[end][joined[end].index(cell)] = other
            del joined[cell]
    draft, numbers = MapDraft(), dict[Cell, int]()
    for cell in sorted(joined):
        z = complex(xs[cell[0]], ys[cell[1]]) + complex(*rng.uniform(-moved, moved, 2))
        earlier = [numbers[other] for other in joined[cell] if other in numbers]
        numbers[cell] = draft.add(DraftNode(z, "end", drawn_kerb(rng, haste)), *earlier)
    for cell, side in stubs:
        far = complex(*side) * (CONTACT + drawn_stub(rng, haste))
        draft.add(DraftNode(draft.nodes[numbers[cell]].z + far, "end"), numbers[cell])
    return draft


def _is_straight(cell: Cell, one: Cell, other: Cell) -> bool:
    """Returns whether two places lie on opposite sides of a third one."""
    ways = [complex(each[0] - cell[0], each[1] - cell[1]) for each in (one, other)]
    return abs(abs(cmath.phase(ways[0] / ways[1])) - pi) < 1e-6


def _finished(
    draft: MapDraft,
    asked: MapClause,
    kinds: Sequence[JunctionCount],
    arms: Sequence[int],
    least_radius: float,
    rng: Rng,
) -> bool:
    """Gives junctions their kinds and signs, and bends their radii; returns whether all bends have room."""
    if not with_kinds_and_bends(draft, least_radius, rng):
        return False
    roads = [len(each) for each in draft.neighbours()]
    for number in (3, 4):
        free = [node for node, count in zip(draft.nodes, roads, strict=True) if count == number]
        wanted = [kind for kind, count in zip(kinds, arms, strict=True) if count == number]
        for n, kind in zip(rng.permutation(len(free)), wanted, strict=True):
            node = free[n]
            node.control = asked.control_of(kind) or "none"
            if kind.kind == "roundabout":
                node.kind, node.radius = "roundabout", round(float(rng.uniform(*ISLANDS)), 1)
    return True
