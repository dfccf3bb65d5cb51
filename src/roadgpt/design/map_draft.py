"""Defines the draft of a map of roads, nodes and roads in plan view before they are placed, and drafts grids.

A grid has rectangular blocks between its streets, and a few roads that lead out. The spacing of the streets
varies, and nodes are moved a little. A corner of the grid is a bend that joins two streets, or a junction if
a road leads out there.

Maps with few dead ends are carved out of a grid, in which all arms lead somewhere; roads that are joined at
random, as in ``village_draft``, seldom use up every arm. Streets are taken out until the junctions are of the
required kinds. If the street between two crossroads is taken out, both become T-junctions. If the street
between two T-junctions is taken out, a road leads on at both places."""

import cmath
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.amount import Amount, span
from roadgpt.brief.junctions import Control, JunctionCount, MapClause, MapJunctionKind
from roadgpt.brief.ranges import Range, overlap
from roadgpt.network.map_design import NodeKind
from roadgpt.network.pose import tangent_length
from roadgpt.network.ring import ring_width

Rng = np.random.Generator
KERBS = (6.0, 10.0)  # m, radius of kerbs between neighbouring roads
STUBS = (20.0, 34.0)  # m, length of a dead end
BENDS = (18.0, 40.0)  # m, radius of bends where there is room
STRAIGHT = 15.0  # m of each road that are straight at a junction: they set the direction of its arm
AROUND = 16  # number of points around a roundabout
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


@dataclass
class DraftNode:
    """A node of a draft."""

    z: complex  # its place as x + iy in metres
    kind: NodeKind
    kerb: float = 8.0  # radius in metres of the kerbs between neighbouring roads at a junction
    radius: float | None = None
    """Radius in metres of a bend, or of the central island of a roundabout; None at any other node."""
    control: Control = "none"  # the signs or lights of a junction

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
        """Returns the points that must lie in the square of side ``map_size``, x + iy in metres, ``(n,)``:
        all nodes, and 16 points around each roundabout, without the width of roads."""
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
    The larger ``haste``, from 0 to 1, the shorter the dead end."""
    low, high = STUBS
    return low + (high - low) * (1 - haste) * float(rng.random())


def drawn_bend(rng: Rng, least: float, room: float) -> float | None:
    """Returns a random radius of a bend in metres; None if the largest that fits, ``room``, is smaller than
    the smallest allowed, ``least``."""
    low, high = max(least, min(BENDS[0], room)), min(BENDS[1], room)
    if room < least:
        return None
    return float(np.floor(10 * rng.uniform(low, max(low, high))) / 10)


def draft_grid(asked: MapClause, room: float, least_radius: float, rng: Rng, haste: float) -> MapDraft | None:
    """Returns a random draft of a grid; None if the draft leaves too little room for its bends. ``room`` is
    the side in metres of the square into which the grid should fit, and ``least_radius`` the smallest radius
    in metres of a bend. The larger ``haste``, from 0 to 1, the smaller the grid."""
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
    """Returns a random whole number that ``asked`` allows and that lies between ``least`` and ``most``. If
    ``asked`` is None or has no upper limit, the result exceeds the lowest possible number by 2 at most. There
    must be at least one possible number."""
    both = overlap(span(asked), Range(least, most))
    assert both is not None
    low = int(np.ceil(both.lo))
    high = int(both.hi) if span(asked).hi < inf else min(int(both.hi), low + ALIKE)
    return int(rng.integers(low, max(low, high) + 1))


def _entrances(
    size: tuple[int, int], asked: Amount | None, rng: Rng, haste: float
) -> list[tuple[Cell, tuple[int, int]]]:
    """Returns the nodes at which roads lead out of a grid, each with its side. If no number is asked for, in
    great haste there are none where junctions remain."""
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
    """Gives random junctions of a draft the signs that are asked for; returns whether there are enough. Signs
    at crossroads stand within the grid first, where every junction has four arms."""
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


def can_be_carved(asked: MapClause) -> bool:
    """Returns whether a grid can have the junctions of a map: few dead ends, and three or four arms each."""
    ends = asked.dead_ends
    has_few = ends is not None and ends.exact and (ends.lo or 0) <= FEW_ENDS
    return has_few and asked.blocks is None and all(each.kind in ARMS for each in asked.junctions)


def draft_carved(
    asked: MapClause, room: float, least_radius: float, rng: Rng, haste: float
) -> MapDraft | None:
    """Returns the draft of a map for which ``can_be_carved`` is true; None if none was found. The other
    arguments are those of ``draft_grid``."""
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
    """Returns the streets that are left of a grid, and the places and sides of its dead ends; None if no
    junctions with the numbers of arms in ``wanted`` are left."""
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
