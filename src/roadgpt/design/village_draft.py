"""Drafts maps of roads with junctions of required kinds.

Each new junction is joined by a road to a free arm: an arm of an earlier junction that leads nowhere yet.
Then pairs of free arms are joined by roads with one or two bends. The other free arms become dead ends."""

import cmath
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise
from math import pi, radians
from typing import NamedTuple

import numpy as np
import shapely

from roadgpt.brief.amount import exactly, span
from roadgpt.brief.junction_check import MOST_OF_KIND
from roadgpt.brief.junctions import JunctionClause, JunctionCount, MapClause
from roadgpt.brief.ranges import Range
from roadgpt.design.junction_draft import drawn_junction
from roadgpt.design.map_draft import (
    STRAIGHT,
    DraftNode,
    MapDraft,
    Rng,
    drawn_bend,
    drawn_count,
    drawn_kerb,
    drawn_stub,
)
from roadgpt.network import JunctionDesign
from roadgpt.network.growing import contact_distances
from roadgpt.network.map_growing import profile_of_map
from roadgpt.network.pose import tangent_length
from roadgpt.road import World

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
ASKED = 0.04  # greatest deviation of a distance from the required one, as a share of it
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
        profile = profile_of_map(None, self.world)
        return contact_distances(junction, directions, [profile] * len(directions))

    def _path(self, arm: _FreeArm, reach: float) -> tuple[list[DraftNode], complex] | None:
        """Returns the bends of a road from an arm to a new junction, and the place of this junction.
        ``reach`` is the distance in metres from the junction to the end of the road."""
        rng, (low, high) = self.rng, BETWEEN
        if self.asked.length is not None:
            allowed = span(self.asked.length)
            usual = allowed.lo if allowed.lo > 0 else allowed.hi
            distance = usual * float(rng.uniform(1 - ASKED, 1 + ASKED))
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
        """Returns whether a new junction at the last of some points, its arms, and the road to it keep off
        everything else."""
        first = len(self.draft.nodes)
        numbers = [arm.node, *range(first, first + len(points))]
        lines = [
            _Line(a, b, frozenset(nodes))
            for (a, b), nodes in zip(pairwise([arm.z, *points]), pairwise(numbers), strict=True)
        ]
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
        """Returns the straights between nodes, and those kept free for arms, but for some of these."""
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
        """Whether the number of free arms is an allowed number of dead ends."""
        return len(self.free) in self.ends

    def _meeting(self, one: _FreeArm, other: _FreeArm) -> list[DraftNode]:
        """Returns the bend at which two arms meet; none if they do not, or something is in the way."""
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
        """Returns two bends over which a road can lead from one arm to another; none if none were found."""
        for _ in range(LINKS):
            rooms = [float(self.rng.uniform(*BEFORE_BEND)) for _ in range(2)]
            places = [
                arm.z + arm.way * (arm.reach + STRAIGHT + room)
                for arm, room in zip((one, other), rooms, strict=True)
            ]
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
    """Returns the directions out of a junction that is turned by an angle in radians."""
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
