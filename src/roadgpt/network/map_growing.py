"""Builds a network from the design of a map: its junctions, the roads between them, and the route."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import cast

from roadgpt.brief.junctions import Control, PlainKind
from roadgpt.errors import UsageError
from roadgpt.geometry import Piece, PieceCurve
from roadgpt.geometry.curve import wrapped
from roadgpt.geometry.pieces import joined
from roadgpt.network.building import Builder
from roadgpt.network.crossing import build_crossing
from roadgpt.network.design import ISLAND, JunctionDesign, NetworkDesign
from roadgpt.network.growing import build_route, contact_distances, roads_around, way_through
from roadgpt.network.lane_along import legs_along
from roadgpt.network.map_design import BEND, MapDesign, MapLanes, MapNode
from roadgpt.network.network import Junction, Leg, Network, RoadEnd, Roundabout
from roadgpt.network.pose import curve_between, tangent_length
from roadgpt.network.ring import build_roundabout
from roadgpt.network.route import Route
from roadgpt.network.stretch import climb_between, refuse_other_lanes
from roadgpt.road import Profile, Road, World
from roadgpt.road.road import check_length

SHORTEST = 0.1  # m, least length of a straight road between two junctions; the rules require more
NO_TURN = 1e-6  # rad; a bend with a smaller turn has no curve


def network_made_from(design: NetworkDesign | MapDesign, world: World) -> Route:
    """Returns the route of a design with junctions or a map, before ``Route.on_ground`` adds shoulders."""
    return build_map(design, world) if isinstance(design, MapDesign) else build_route(design, world)


def build_map(design: MapDesign, world: World) -> Route:
    """Returns the route of a map, with the network of the whole map. Without a route in the design, the
    result has no legs; see ``Route``.

    The World gives the width of the shoulders, and the lane width where the design has none. Raises
    UsageError if junctions, roundabouts or bends have no room on a road, the island of a roundabout is too
    small for its arms, a bend is tighter than its lane is wide, a road is longer than 50 km, or the World
    asks for lanes or banked bends that networks do not have."""
    if design.left_hand:  # traffic on the left is the mirror image of traffic on the right
        return build_map(design.mirrored(), world).mirrored
    grown = _MapGrowth(design, profile_of_map(design.lanes, world))
    for nodes in design.chains:
        grown.add_road(nodes)
    for number, node in enumerate(design.nodes, 1):
        if node.is_junction:
            grown.add_junction(number, node)
    network = grown.builder.network()
    return Route.along(network, grown.legs(network))


def profile_of_map(lanes: MapLanes | None, world: World) -> Profile:
    """Returns the cross-section of the roads of a map: one lane in each direction, as wide as those of the
    World if no lanes are given, and shoulders."""
    refuse_other_lanes(world)
    width = world.section.lane_width if lanes is None else lanes.width
    return Profile.of(1, 1, width, world.section.shoulder)


def signs_at(node: MapNode, directions: Sequence[float]) -> tuple[Control, ...]:
    """Returns the sign or light of each arm of a junction, from the headings of the arms out of it in
    radians.

    The ``control`` of the node decides. With "lights", all arms have lights. Otherwise all arms of a
    roundabout have stop signs with "stop", and give way with any other value. At other junctions, no arm has
    a sign with "none". Otherwise the two arms that are most nearly opposite are the main road and have
    priority; the other arms have stop signs with "stop", and give way with "yield" or "priority"."""
    count = len(directions)
    if node.kind == "roundabout":
        return (node.control if node.control in ("lights", "stop") else "yield",) * count
    if node.control in ("lights", "none"):
        return (node.control,) * count
    pairs = [(i, j) for i in range(count) for j in range(i)]
    main = max(pairs, key=lambda pair: abs(wrapped(directions[pair[0]] - directions[pair[1]])))
    minor: Control = "yield" if node.control == "priority" else node.control
    return tuple("priority" if n in main else minor for n in range(count))


@dataclass
class _MapGrowth:
    """A network that is being built from a map."""

    design: MapDesign
    profile: Profile
    builder: Builder = field(default_factory=Builder)
    _roads: dict[tuple[int, ...], int] = field(default_factory=dict)
    """The id of each road, by the nodes along the road."""
    _ends: dict[tuple[int, int], RoadEnd] = field(default_factory=dict)
    """For each node and the next node on one of its roads, the end of this road at the first node."""
    _built: dict[int, Junction | Roundabout] = field(default_factory=dict)
    _contacts: dict[int, dict[int, float]] = field(default_factory=dict)
    """For each node, the distance in metres to the start of each of its roads, by the road's next node."""

    def _contact(self, number: int, towards: int) -> float:
        """Returns the distance in metres from a node to the start of its road towards another node."""
        if number not in self._contacts:
            node, others = self.design.node(number), self.design.neighbours[number]
            distances = [0.0] * len(others)
            if node.is_junction:
                directions = [self.design.direction(number, other) for other in others]
                try:
                    profiles = [self.profile] * len(others)
                    distances = contact_distances(junction_of(node), directions, profiles)
                except UsageError as error:
                    raise UsageError(f"node {number}: {error}") from error
            self._contacts[number] = dict(zip(others, distances, strict=True))
        return self._contacts[number][towards]

    def add_road(self, nodes: tuple[int, ...]) -> None:
        """Builds the road along nodes, from a junction or end to the next."""
        design = self.design
        start, end = nodes[0], nodes[-1]
        before, after = self._contact(start, nodes[1]), self._contact(end, nodes[-2])
        pieces = self._pieces(nodes, before, after)
        length = sum(piece.length for piece in pieces)
        check_length(length)
        x, y, z = design.node(start).at
        heading = design.direction(start, nodes[1])
        plan = PieceCurve(x + before * math.cos(heading), y + before * math.sin(heading), heading, pieces)
        heights = climb_between(z, design.node(end).at[2], plan.length)
        road = self.builder.add(Road(plan, heights, profile=self.profile))
        self._roads[nodes] = road
        self._ends[start, nodes[1]] = RoadEnd(road, "start")
        self._ends[end, nodes[-2]] = RoadEnd(road, "end")

    def _pieces(self, nodes: Sequence[int], before: float, after: float) -> tuple[Piece, ...]:
        """Returns the straights and curves of a road along nodes, from ``before`` metres behind the first
        node to ``after`` metres before the last one."""
        pieces: list[Piece] = []
        taken, curve = before, tuple[Piece, ...]()
        for n, (one, other) in enumerate(pairwise(nodes), 1):
            (x, y, _), (to_x, to_y, _) = self.design.node(one).at, self.design.node(other).at
            needed, following = after, tuple[Piece, ...]()
            if n < len(nodes) - 1:
                turn = self.design.direction(other, nodes[n + 1]) - self.design.direction(one, other)
                needed, following = self._bend(other, wrapped(turn))
            distance = math.hypot(to_x - x, to_y - y)
            free = distance - taken - needed
            if free < (SHORTEST if len(nodes) == 2 else 0.0):
                raise UsageError(
                    f"nodes {one} and {other} are {distance:.1f} m apart, and their junctions or bends take "
                    f"{taken + needed:.1f} m of the road between them; move them apart, or give a smaller "
                    "kerb or radius"
                )
            pieces += [*curve, Piece(free)]
            taken, curve = needed, following
        return joined(pieces)

    def _bend(self, number: int, turn: float) -> tuple[float, tuple[Piece, ...]]:
        """Returns the length in metres that a bend takes of each straight beside it, and the bend's curve."""
        if abs(turn) < NO_TURN:
            return 0.0, ()
        radius, width = self.design.node(number).radius or BEND, float(self.profile.width(0.0))
        if radius < width:
            raise UsageError(
                f"node {number}: a bend with a radius of {radius:g} m is tighter than the lane beside it is "
                f"wide; give a radius of {width:g} m or more"
            )
        tangent = radius * tangent_length(abs(turn))
        return tangent, curve_between(tangent, tangent, turn)

    def add_junction(self, number: int, node: MapNode) -> None:
        """Builds the junction or roundabout at a node; all roads at the node must exist already."""
        others = self.design.neighbours[number]
        directions = [self.design.direction(number, other) for other in others]
        stubs = [
            self.builder.stub(self._ends[number, other], direction)
            for other, direction in zip(others, directions, strict=True)
        ]
        signs, distances = signs_at(node, directions), [self._contact(number, other) for other in others]
        if node.kind == "roundabout":
            self._built[number] = build_roundabout(
                self.builder, node.at, node.radius or ISLAND, stubs, signs, node.kerb
            )
        else:
            self._built[number] = build_crossing(
                self.builder, junction_of(node).kind, node.at, stubs, distances, signs, node.kerb
            )

    def legs(self, network: Network) -> list[Leg]:
        """Returns the legs of the route through the finished network; none for a map without a route."""
        if not self.design.route:
            return []
        driven = list(self.design.driven)
        if len(driven) == 1:
            is_along = driven[0] in self._roads
            return [Leg(self._road(driven[0]), -1 if is_along else 1)]
        passed = [self._road(driven[0])]
        for before, nodes in pairwise(driven):
            passed += [*self._through(nodes[0], before[-2], nodes[1]), self._road(nodes)]
        return legs_along(network, passed, {})

    def _road(self, nodes: tuple[int, ...]) -> int:
        """Returns the id of the road along nodes, in one direction or the other."""
        return self._roads[nodes if nodes in self._roads else nodes[::-1]]

    def _through(self, number: int, before: int, after: int) -> list[int]:
        """Returns the ids of the roads through a junction, from the road towards one node to that towards
        another."""
        built = self._built[number]
        incoming, outgoing = self._ends[number, before], self._ends[number, after]
        if isinstance(built, Junction):
            return [way_through(built.connections, incoming, outgoing)]
        others = self.design.neighbours[number]
        return roads_around(self.builder, built, others.index(before), others.index(after))


def junction_of(node: MapNode) -> JunctionDesign:
    """Returns a JunctionDesign with the kind, kerb and radius of a node; do not use its other fields."""
    radius = ISLAND if node.radius is None else node.radius
    return JunctionDesign.model_construct(
        after=1, take=1, kind=cast(PlainKind, node.kind), kerb=node.kerb, radius=radius
    )
