"""Defines the draft of a map of roads, nodes and roads in plan view before they are placed, and makes drafts.

A grid has rectangular blocks between its streets, and a few roads that lead out. The spacing of the streets
varies, and nodes are moved a little. A corner of the grid is a bend that joins two streets, or a junction if
a road leads out there.

Junctions of required kinds make a village: each new one is joined by a road to a free arm, an arm of an
earlier junction that leads nowhere yet. Then pairs of free arms are joined by roads with one or two bends,
which seldom uses up every arm; the others become dead ends.

Maps with few dead ends are carved out of a grid instead, in which all arms lead somewhere. Streets are taken
out until the junctions are of the required kinds. If the street between two crossroads is taken out, both
become T-junctions. If the street between two T-junctions is taken out, a road leads on at both places."""

import cmath
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise
from math import inf, pi, radians
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from roadgpt.brief.amount import Amount, exactly, span
from roadgpt.brief.junction_check import MOST_OF_KIND
from roadgpt.brief.junctions import JunctionClause, JunctionCount, MapClause
from roadgpt.brief.ranges import Range, overlap
from roadgpt.design.junction_draft import drawn_junction
from roadgpt.language.names import Control, MapJunctionKind
from roadgpt.network.building import ring_width
from roadgpt.network.growing import contact_distances
from roadgpt.network.pose import tangent_length
from roadgpt.road import Profile, World
from roadgpt.road.design import JunctionDesign, NodeKind

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
    has_room = with_kinds_and_bends(draft, least_radius, rng)
    return draft if has_room and _signed(draft, asked.signed, inner, rng) else None


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
        order = [fitting[n] for n in rng.permutation(len(fitting))]
        if each.kind == "crossroads":
            order.sort(key=lambda node: not any(node is one for one in inner))
        for node in order[:count]:
            node.control = each.control or "none"
            free = [one for one in free if one is not node]
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
        away = [(abs(each.z - node.z), each) for each in (one, other)]
        room = min(far * 0.48 if each.kind == "bend" else far - (each.kerb * 1.3 + 9.0) for far, each in away)
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
    return Counter([cell for street in streets for cell in street] + [cell for cell, _ in stubs])


def _distance(arms: Counter[Cell], wanted: Counter[int]) -> int:
    found = Counter(arms.values())
    return sum(abs(found[number] - wanted[number]) for number in (3, 4))


def _is_whole(streets: set[Street], arms: Counter[Cell], gone: Street) -> bool:
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


TRIES = 30  # number of places that are tried for one junction
CHOICES = 4  # number of places that fit, of which the one nearest to the middle is taken in great haste
BETWEEN = (16.0, 70.0)  # m, length of a straight road between two junctions
BENT = 0.35  # share of roads between junctions that have a bend
TURN = (20.0, 60.0)  # degrees, angle of such a bend
WIDEST = 35.0  # m, greatest radius of such a bend
MARGIN = 2.0  # m between the shoulders of roads that do not meet
FARTHEST = 130.0  # m, greatest distance from a junction to the bend of a road that joins two arms
SHARPEST = 115.0  # degrees, greatest angle of such a bend
GENTLEST = 8.0  # degrees, least angle of such a bend
JOINED = 0.8  # share of the arms that are joined where they can be
ENDS = 2  # least number of arms that become dead ends, if none is required
DRAWN = 20  # sets of junctions that are drawn, until the arms of one allow the required dead ends
ORDERS = 6  # number of orders of joining arms that are tried, to leave the required dead ends
LINKS = 12  # number of roads with two bends that are tried between two arms
BEFORE_BEND = (16.0, 70.0)  # m before such a bend's node that its tangent may take
DONE = 0.3  # chance of not joining a pair of arms when the number of dead ends is already allowed
OFF_ASKED = 0.04  # greatest deviation of a distance from the required one, as a share of it
LONGER = 1.2  # greatest extension of the dead ends of a map with one junction, as a share of their length
STUB = 24.0  # m, kept free for each free arm


def draft_village(
    asked: MapClause, world: World, least_radius: float, rng: Rng, haste: float
) -> MapDraft | None:
    """Returns the draft of a map of roads with junctions; None if there was no room for a junction, or if the
    number of dead ends or of blocks is not the required one. ``least_radius`` is the smallest radius in
    metres of a bend. The larger ``haste``, from 0 to 1, the smaller the map."""
    counts = [each for each in asked.junctions for _ in range(drawn_count(each.count, rng, MOST_OF_KIND))]
    sets = (_junctions(counts, asked, rng, haste, n >= DRAWN // 2) for n in range(DRAWN))
    junctions = next(filter(None, sets), None)
    if junctions is None:
        return None
    village = _Village(asked, world, least_radius, rng, haste)
    village.put(junctions[0], 0j, float(rng.uniform(0, 2 * pi)))
    if not all(village.grow(junction) for junction in junctions[1:]):
        return None
    for _ in range(ORDERS if village.has_asked_ends else 1):
        trial = village.copied()
        if trial.join_arms():
            trial.end_arms()
            return trial.draft
    return None


def _junctions(
    kinds: Sequence[JunctionCount], asked: MapClause, rng: Rng, haste: float, has_few_arms: bool
) -> list[JunctionDesign] | None:
    """Returns one junction for each of ``kinds``, in random order; roundabouts with three arms each if
    ``has_few_arms`` is true. A junction alone has an arm for each dead end that is required. None if one of
    them was not found, or if the required number of dead ends is impossible: there are too few arms, or
    joining arms in pairs always leaves another number."""
    found = []
    for n in rng.permutation(len(kinds)):
        arms = exactly(3) if has_few_arms and kinds[n].kind == "roundabout" else None
        arms = asked.dead_ends if len(kinds) == 1 else arms
        junction = drawn_junction(JunctionClause(kind=kinds[n].kind, arms=arms), rng, haste)
        if junction is None:
            return None
        control = asked.control_of(kinds[n]) or "none"
        found.append(junction.model_copy(update={"kerb": drawn_kerb(rng, haste), "control": control}))
    free = sum(len(each.all_arms) + 1 for each in found) - 2 * (len(found) - 1)
    wanted = asked.ends_of_tree(free)
    return found if any(number in wanted for number in range(free, -1, -2)) else None


class _Line(NamedTuple):
    """A straight of a draft, from one point x + iy in metres to another."""

    start: complex
    end: complex
    nodes: frozenset[int]
    """The numbers of the nodes at its ends; lines that share a node may be near each other."""


_Disc = tuple[_Line, float]
"""The circular area of a junction: its centre, as a line without length, and its radius in metres. Only roads
that lead to the junction may enter it."""


@dataclass(frozen=True, eq=False)
class _FreeArm:
    """An arm that leads nowhere yet."""

    node: int
    z: complex  # the place of the junction as x + iy in metres
    way: complex  # the direction of the arm out of the junction, of length 1
    reach: float  # distance in metres from the node to the place where the arm meets the junction

    @property
    def line(self) -> _Line:
        """The straight that is kept free for the arm."""
        return _Line(self.z, self.z + self.way * (self.reach + STUB), frozenset({self.node}))


@dataclass
class _Village:
    """A draft that grows."""

    asked: MapClause
    world: World
    least_radius: float
    rng: Rng
    haste: float
    draft: MapDraft = field(default_factory=MapDraft)
    free: list[_FreeArm] = field(default_factory=list)
    discs: list[_Disc] = field(default_factory=list)
    ends: Range = field(default_factory=Range)
    """The allowed numbers of dead ends, once all junctions are joined."""

    @property
    def has_asked_ends(self) -> bool:
        """Whether a number of dead ends or of blocks is required."""
        return not (self.asked.dead_ends is None and self.asked.blocks is None)

    def copied(self) -> "_Village":
        """Returns a copy to which nodes and roads can be added without changing this draft."""
        draft = MapDraft(list(self.draft.nodes), list(self.draft.roads))
        return replace(self, draft=draft, free=list(self.free))

    def grow(self, junction: JunctionDesign) -> bool:
        """Joins a junction to a free arm; returns whether a place was found for the junction."""
        nodes = self.draft.nodes
        middle = sum(node.z for node in nodes) / len(nodes)
        found = []
        for _ in range(TRIES):
            arm = self.free[int(self.rng.integers(len(self.free)))]
            back = int(self.rng.integers(len(junction.all_arms) + 1))
            path = self._path(arm, self._reaches(junction)[back])
            if path is None:
                continue
            bends, here = path
            before = bends[-1].z if bends else arm.z
            turn = cmath.phase((before - here) / _ways(junction, 0.0)[back])
            if self._fits(arm, [*(each.z for each in bends), here], junction, turn, back):
                found.append((arm, bends, here, turn, back))
            if len(found) == CHOICES:
                break
        if not found:
            return False
        count = 1 + round(self.haste * (len(found) - 1))
        arm, bends, here, turn, back = min(found[:count], key=lambda each: abs(each[2] - middle))
        self.free.remove(arm)
        last = arm.node
        for bend in bends:
            last = self.draft.add(bend, last)
        self.put(junction, here, turn, back, last)
        return True

    def put(
        self, junction: JunctionDesign, z: complex, turn: float, back: int | None = None, *joined_to: int
    ) -> None:
        """Adds a junction at ``z``, turned by an angle in radians, and its arms. ``back`` is the index of the
        arm to which a road leads from an earlier node, and ``joined_to`` the number of this node; both are
        left out for the first junction, to which no road leads yet."""
        radius = junction.radius if junction.kind == "roundabout" else None
        node = DraftNode(z, junction.kind, junction.kerb, radius, junction.control)
        number = self.draft.add(node, *joined_to)
        reaches = self._reaches(junction)
        self.discs.append((_Line(z, z, frozenset({number})), max(reaches)))
        for n, way in enumerate(_ways(junction, turn)):
            if n != back:
                self.free.append(_FreeArm(number, z, way, reaches[n]))

    def _reaches(self, junction: JunctionDesign) -> list[float]:
        directions = [cmath.phase(way) for way in _ways(junction, 0.0)]
        section = self.world.section
        profile = Profile.of(1, 1, section.lane_width, section.shoulder)
        return contact_distances(junction, directions, [profile] * len(directions))

    def _path(self, arm: _FreeArm, reach: float) -> tuple[list[DraftNode], complex] | None:
        rng, (low, high) = self.rng, BETWEEN
        if self.asked.length is not None:
            allowed = span(self.asked.length)
            usual = allowed.lo if allowed.lo > 0 else allowed.hi
            distance = usual * float(rng.uniform(1 - OFF_ASKED, 1 + OFF_ASKED))
            fits = distance > arm.reach + reach + low / 2
            return ([], arm.z + arm.way * distance) if fits else None
        length = low + (high - low) * (1 - self.haste) * float(rng.random())
        if rng.random() > BENT * (1 - self.haste):
            return [], arm.z + arm.way * (arm.reach + length + reach)
        turn = radians(float(rng.uniform(*TURN))) * (1 if rng.random() < 0.5 else -1)
        radius = drawn_bend(rng, self.least_radius, max(WIDEST, self.least_radius))
        assert radius is not None
        tangent = radius * tangent_length(abs(turn))
        bend = arm.z + arm.way * (arm.reach + STRAIGHT + tangent)
        further = tangent + max(length / 2, STRAIGHT) + reach
        return [DraftNode(bend, "bend", radius=radius)], bend + arm.way * cmath.rect(further, turn)

    def _fits(
        self, arm: _FreeArm, points: Sequence[complex], junction: JunctionDesign, turn: float, back: int
    ) -> bool:
        first = len(self.draft.nodes)
        numbers = [arm.node, *range(first, first + len(points))]
        pairs = zip(pairwise([arm.z, *points]), pairwise(numbers), strict=True)
        lines = [_Line(*ends, frozenset(nodes)) for ends, nodes in pairs]
        reaches, here = self._reaches(junction), points[-1]
        for n, way in enumerate(_ways(junction, turn)):
            if n != back:
                lines.append(_FreeArm(numbers[-1], here, way, reaches[n]).line)
        there = self._lines(arm)
        disc = _Line(here, here, frozenset(numbers[-1:])), max(reaches)
        return _is_clear(lines, there, self.discs, self.apart) and _is_clear(there, [], [disc], self.apart)

    @property
    def apart(self) -> float:
        """The least distance in metres between the centre lines of roads that do not meet."""
        section = self.world.section
        return float(2 * section.lane_width + 2 * section.shoulder + MARGIN)

    def _lines(self, *without: _FreeArm) -> list[_Line]:
        nodes = self.draft.nodes
        roads = [_Line(nodes[a].z, nodes[b].z, frozenset((a, b))) for a, b in self.draft.roads]
        return roads + [arm.line for arm in self.free if arm not in without]

    def join_arms(self) -> bool:
        """Joins pairs of free arms by roads with one bend or, if a number of dead ends or of blocks is
        required, where necessary with two. Returns whether as many arms remain free as dead ends are
        required."""
        asked = self.has_asked_ends
        self.ends = self.asked.ends_of_tree(len(self.free))
        fewest, share = (self.ends.lo, 1.0) if asked else (ENDS, JOINED)
        pairs = list(combinations(self.free, 2))
        for n in self.rng.permutation(len(pairs)):
            one, other = pairs[n]
            is_done = len(self.free) < fewest + 2 or (asked and self._is_met and self.rng.random() < DONE)
            if is_done or one not in self.free or other not in self.free or one.node == other.node:
                continue
            bends = self._meeting(one, other)
            if not bends and asked:
                bends = self._linked(one, other)
            if bends and self.rng.random() < share:
                self.free.remove(one)
                self.free.remove(other)
                last = one.node
                for bend in bends:
                    last = self.draft.add(bend, last)
                self.draft.roads.append((last, other.node))
        return self._is_met

    @property
    def _is_met(self) -> bool:
        return len(self.free) in self.ends

    def _meeting(self, one: _FreeArm, other: _FreeArm) -> list[DraftNode]:
        across = (one.way.conjugate() * other.way).imag
        turn = abs(cmath.phase(-other.way / one.way))
        if not radians(GENTLEST) <= turn <= radians(SHARPEST):
            return []
        between = (other.z - one.z).conjugate()
        first, second = (between * other.way).imag / across, (between * one.way).imag / across
        room = min(first - one.reach, second - other.reach) - STRAIGHT
        if room <= 0 or max(first, second) > FARTHEST:
            return []
        radius = drawn_bend(self.rng, self.least_radius, room / tangent_length(turn))
        z, number = one.z + one.way * first, len(self.draft.nodes)
        lines = [_Line(arm.z, z, frozenset((arm.node, number))) for arm in (one, other)]
        if radius is None or not _is_clear(lines, self._lines(one, other), self.discs, self.apart):
            return []
        return [DraftNode(z, "bend", radius=radius)]

    def _linked(self, one: _FreeArm, other: _FreeArm) -> list[DraftNode]:
        for _ in range(LINKS):
            rooms = [float(self.rng.uniform(*BEFORE_BEND)) for _ in range(2)]
            pairs = zip((one, other), rooms, strict=True)
            places = [arm.z + arm.way * (arm.reach + STRAIGHT + room) for arm, room in pairs]
            across = places[1] - places[0]
            turns = [abs(cmath.phase(across / one.way)), abs(cmath.phase(-across / other.way))]
            if not all(radians(GENTLEST) <= turn <= radians(SHARPEST) for turn in turns):
                continue
            radii = [
                drawn_bend(self.rng, self.least_radius, min(room, abs(across) / 2) / tangent_length(turn))
                for room, turn in zip(rooms, turns, strict=True)
            ]
            first = len(self.draft.nodes)
            points, nodes = [one.z, *places, other.z], [one.node, first, first + 1, other.node]
            lines = [_Line(points[n], points[n + 1], frozenset(nodes[n : n + 2])) for n in range(3)]
            if None not in radii and _is_clear(lines, self._lines(one, other), self.discs, self.apart):
                return [DraftNode(z, "bend", radius=radius) for z, radius in zip(places, radii, strict=True)]
        return []

    def end_arms(self) -> None:
        """Turns each free arm into a dead end."""
        longer = 1 + (1 - self.haste) * LONGER / len(self.discs)
        for arm in self.free:
            z = arm.z + arm.way * (arm.reach + longer * drawn_stub(self.rng, self.haste))
            self.draft.add(DraftNode(z, "end"), arm.node)
        self.free = []


def _ways(junction: JunctionDesign, turn: float) -> list[complex]:
    angles = [pi, *(radians(arm.angle) for arm in junction.all_arms)]
    return [cmath.rect(1.0, angle + turn) for angle in angles]


def _is_clear(new: Sequence[_Line], lines: Sequence[_Line], discs: Sequence[_Disc], apart: float) -> bool:
    """Returns whether new lines keep clear of all lines and discs with which they share no node. Two lines
    must be ``apart`` metres apart, and a line and a disc half as far; the new lines are not compared with
    each other."""
    least = np.array([apart] * len(lines) + [radius + apart / 2 for _, radius in discs])
    others = [*lines, *(centre for centre, _ in discs)]
    if not new or not others:
        return True
    away = shapely.distance(_shapes(new)[:, None], _shapes(others)[None, :])
    meet = np.array([[bool(a.nodes & b.nodes) for b in others] for a in new])
    return not (~meet & (away < least)).any()


def _shapes(lines: Sequence[_Line]) -> np.ndarray:
    z = np.array([(line.start, line.end) for line in lines])
    return np.asarray(shapely.linestrings(np.stack((z.real, z.imag), axis=-1)))
