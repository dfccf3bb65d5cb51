"""Searches for a map of roads: tries random drafts until one fits and breaks no rule.

A draft is a grid, or junctions joined by roads. The draft is rotated and moved into a square with sides of
``map_size``, and heights and a route are drawn at random. If the description says where the route turns, the
route takes these turns; otherwise, it passes several junctions and turns to both sides where possible. The
rules must then accept the network that is built from the draft."""

import cmath
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import inf, sqrt

import numpy as np

from roadgpt.brief.amount import Amount, span
from roadgpt.brief.junctions import MapClause, Way, side_of
from roadgpt.brief.map_fit import EDGE
from roadgpt.brief.model import Brief
from roadgpt.check.network_measures import measured_map
from roadgpt.check.network_promises import length_range
from roadgpt.design.first_accepted import first_accepted
from roadgpt.design.layout import drawn_ground, first_that_fits
from roadgpt.design.map_draft import (
    LEAST_BLOCK,
    DraftNode,
    MapDraft,
    Rng,
    can_be_carved,
    draft_carved,
    draft_grid,
)
from roadgpt.design.village_draft import draft_village
from roadgpt.errors import DesignError, UsageError
from roadgpt.network import MapDesign, MapNode, build_map
from roadgpt.network.map_growing import profile_of_map
from roadgpt.road import World

WALKS = 60  # number of random walks, of which the best is taken
PASSED = (3, 6)  # number of junctions that a route passes, where possible
LONG = 120.0  # m; a shorter route counts as worse
DRAFTS = 200  # for one map, at most
BUILT = 30  # drafts that fit and break a rule, after which the search is given up
PER_JUNCTION = 80.0  # m; n junctions fill a map whose side is this length times the square root of n
NO_HASTE = 8  # drafts without haste
HURRIED = 0.12  # least haste for each junction beyond the first ``FEW``
FEW = 2.0  # number of junctions that need no haste on the usual map
ACROSS = 0.2  # side of the smallest map that is tried, as a share of the length of all its roads
WITHIN = 0.9  # where only one limit of a length is given, the other one is this share of it
PARTS = 250.0  # m, side of the usual map
LEANING = 14.0  # degrees, greatest rotation of a grid; its columns still run from south to north
TURNS = 24  # number of rotations that are tried
TIGHTEST = 1.05  # least radius of bends, as a multiple of the smallest radius allowed
CARVED = 0.7  # share of drafts with few dead ends that are carved out of a grid
LEVEL = 0.4  # share of maps that are level
TILT = 0.02  # ratio, greatest slope of the plane in which the nodes of a map lie
TOO_LARGE = "too large"


def drawn_route(draft: MapDraft, rng: Rng) -> list[int] | None:
    """Returns the numbers of the nodes along a random route from one end to another; None if none was found.
    If the map has fewer than two ends, the route leads from one junction to another, or to an end. No node is
    passed twice."""
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
    """Returns the numbers of the nodes along a route that turns as ``ways`` says at its junctions, in order;
    None if there is no such route. It starts and finishes at ends where possible, and otherwise at junctions.
    No node is passed twice."""
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
    None if the walk reaches neither."""
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


class MapSearch:
    """The search for one map."""

    tried = 24
    """Number of drafts in a search that tests whether the World's map is large enough."""

    def __init__(self, brief: Brief, world: World, rng: np.random.Generator) -> None:
        assert brief.map is not None
        self.brief, self.asked, self.world, self.rng = brief, brief.map, world, rng
        self.failed: Counter[str] = Counter()
        self.boxes: list[float] = []

    def run(self, drafts: int = DRAFTS) -> MapDesign:
        """Returns the first of up to ``drafts`` drafts that is accepted. Raises DesignError if none was, and
        UsageError if the World has lanes or superelevation that networks cannot have."""
        profile_of_map(None, self.world)
        hastes = (max(0.0, (n - NO_HASTE) / (drafts / 2)) ** 0.5 for n in range(drafts))
        tried = (self._draft(min(max(haste, self._least_haste), 1.0)) for haste in hastes)
        found = first_accepted(tried, build_map, self.brief, self.world, self.failed, BUILT)
        if found is None:
            raise DesignError(self._advice())
        return found

    @property
    def lacks_room(self) -> bool:
        """Whether drafts were too large for the map, so that a larger one may help."""
        return self.failed[TOO_LARGE] > 0

    @property
    def _least_haste(self) -> float:
        """The haste of the first drafts, without which many junctions would not fit on the map."""
        share = PARTS / self.world.site.map_size
        return HURRIED * max(_least_count(self.asked) * share**2 - FEW, 0.0)

    def _draft(self, haste: float) -> MapDesign | None:
        world = self.world
        room = world.site.map_size - world.section.road_width - 2 * EDGE
        radius = TIGHTEST * world.limits.min_radius
        if self.asked.junctions:
            is_carved = can_be_carved(self.asked) and self.rng.random() < CARVED
            draft = (
                draft_carved(self.asked, room, radius, self.rng, haste)
                if is_carved
                else draft_village(self.asked, world, radius, self.rng, haste)
            )
            turns = self.rng.uniform(0, 360, TURNS)
        else:
            draft = draft_grid(self.asked, room, radius, self.rng, haste)
            turns = self.rng.uniform(-LEANING, LEANING, TURNS) * np.linspace(1, 0, TURNS)
        length = self.brief.length
        if draft is None or (length is not None and not self._stretch(draft, length)):
            self.failed["its roads would overlap or bend too much"] += 1
            return None
        if not self._place(draft, turns, room):
            self.failed[TOO_LARGE] += 1
            return None
        ways = self.asked.route
        route = named_route(draft, ways, self.rng) if ways else drawn_route(draft, self.rng)
        if route is None:
            which = f"no route {', '.join(ways)}" if ways else "no route"
            self.failed[f"{which} leads through it"] += 1
            return None
        return _design(draft, self._heights(draft, haste), route)

    def _stretch(self, draft: MapDraft, length: Amount) -> bool:
        """Makes a draft larger or smaller, so that all its roads together have the required length. Only the
        roads between its nodes change: junctions and the radii of bends stay as they are. Returns whether the
        draft can be built, which shows how long its roads are."""
        route = drawn_route(draft, self.rng)
        if route is None:
            return False
        try:
            flat = _design(draft, [0.0] * len(draft.nodes), route)
            built = measured_map(build_map(flat, self.world).network).length
        except UsageError:
            return False
        asked = length_range(length)
        if built not in asked:
            low = asked.lo if asked.lo > 0 else WITHIN * asked.hi
            wanted = (low + min(asked.hi, low / WITHIN)) / 2
            between = sum(abs(draft.nodes[one].z - draft.nodes[other].z) for one, other in draft.roads)
            for node in draft.nodes:
                node.z *= (between + wanted - built) / between
        return True

    def _place(self, draft: MapDraft, turns: np.ndarray, room: float) -> bool:
        """Turns and moves a draft onto the map; returns whether it fits. The angles ``turns`` in degrees are
        tried in order; ``room`` is the side in metres of the square into which the draft must fit."""
        found = first_that_fits(draft.corners(), turns, room)
        if found is None:
            return False
        turn, left, low, width, height = found
        spin = np.exp(1j * np.radians(turn))
        border = (self.world.site.map_size - room) / 2
        x, y = (
            border - edge + float(self.rng.random()) * max(room - size, 0.0)
            for edge, size in ((left, width), (low, height))
        )
        for node in draft.nodes:
            moved = node.z * spin + complex(x, y)
            node.z = complex(round(moved.real, 2), round(moved.imag, 2))
        return True

    def _heights(self, draft: MapDraft, haste: float) -> list[float]:
        """Returns the height of each node in metres; all nodes lie in one plane, nearly level."""
        ground = drawn_ground(self.world, self.rng)
        tilt = TILT * (1 - haste) * float(self.rng.random()) if self.rng.random() > LEVEL else 0.0
        way = np.exp(2j * np.pi * self.rng.random())
        along = np.array([(node.z * way).real for node in draft.nodes])
        return [round(float(each), 2) for each in ground + tilt * (along - along.min())]

    def _advice(self) -> str:
        why, _ = max(self.failed.items(), key=lambda item: item[1], default=("nothing could be drafted", 0))
        size = self.world.site.map_size
        if why == TOO_LARGE:
            fewer = "junctions" if self.asked.junctions else "or shorter blocks"
            return (
                f"this map of roads found no place on a map of {size:g} m; ask for fewer {fewer}, or give a "
                "larger map with --map-size"
            )
        return f"no draft of this map was accepted: {why}; leave something out or give other numbers"


def _design(draft: MapDraft, heights: Sequence[float], route: Sequence[int]) -> MapDesign:
    return MapDesign(
        nodes=tuple(_node(node, height) for node, height in zip(draft.nodes, heights, strict=True)),
        roads=tuple((one + 1, other + 1) for one, other in draft.roads),
        route=tuple(number + 1 for number in route),
    )


def _node(node: DraftNode, height: float) -> MapNode:
    at = (node.z.real, node.z.imag, height)
    if not node.is_junction:
        return MapNode(at=at, kind=node.kind, radius=node.radius)
    return MapNode(at=at, kind=node.kind, radius=node.radius, control=node.control, kerb=node.kerb)


def likely_room_of_map(brief: Brief) -> float:
    """Returns the side in metres of a square that a map of roads may just fit into."""
    assert brief.map is not None
    asked = brief.map
    if asked.junctions:
        usual = PER_JUNCTION * sqrt(_least_count(asked))
    else:
        length = span(asked.length).lo
        blocks = max(span(asked.columns).lo, span(asked.rows).lo, 1.0)
        usual = blocks * (length if 0 < length < inf else LEAST_BLOCK)
    return max(usual, ACROSS * max(span(brief.length).lo, 0.0))


def _least_count(asked: MapClause) -> float:
    return sum(max(span(each.count).lo, 1.0) for each in asked.junctions)
