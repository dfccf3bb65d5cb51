"""Builds a network from a design: along a route, each road and each junction in the order in which it passes
them, or the junctions of a map, the roads between them, and the route."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import cast

from roadgpt.brief.junctions import Control, PlainKind, side_of
from roadgpt.errors import UsageError
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import wrapped
from roadgpt.geometry.pieces import joined
from roadgpt.network.building import (
    USUALLY_FED,
    Builder,
    RampBuilder,
    Stub,
    around_length,
    build_crossing,
    build_roundabout,
    contact_distance,
    edges_at,
    length_at_ramp,
    setbacks,
    smallest_radius,
)
from roadgpt.network.design import (
    ISLAND,
    ArmDesign,
    JunctionDesign,
    LanesChangeDesign,
    NetworkDesign,
    PlaceDesign,
    RampDesign,
)
from roadgpt.network.lane_along import legs_along
from roadgpt.network.map_design import BEND, MapDesign, MapLanes, MapNode
from roadgpt.network.network import Connection, Continuation, Junction, Leg, Network, RoadEnd, Roundabout
from roadgpt.network.pose import NetworkPose, curve_between, tangent_length
from roadgpt.network.route import Route
from roadgpt.network.stretch import climb_between, refuse_other_lanes, road_of, stretch_profiles
from roadgpt.road import Profile, Road, World
from roadgpt.road.road import check_length, reversed_road

FAR = 1e6  # m, a station behind all changes of a cross-section
LEAST = math.radians(40.0)  # largest deviation from a straight line of two arms that count as opposite


def build_route(design: NetworkDesign, world: World) -> Route:
    """Returns the route that a design describes, with the network in which it lies.

    The World gives the width of the shoulders, and the lane width where the design has none. Raises
    UsageError if the World asks for lanes or banked bends that networks do not have, the lanes of a road do
    not fit, no arm of a junction fits ``take``, the island of a roundabout is too small for its arms, a lane
    that the route needs cannot be reached, or a road is longer than 50 km."""
    # traffic on the left is the mirror image of traffic on the right
    seen = design.mirrored() if design.left_hand else design
    grown = _RouteGrowth(seen, stretch_profiles(seen, world))
    for number, (own, place) in enumerate(zip(design.junctions, seen.junctions, strict=True), 1):
        try:
            if isinstance(own, JunctionDesign):
                own.arm_taken(design.left_hand)  # says left and right as the design does
            grown.pass_place(number, place)
        except UsageError as error:
            raise UsageError(f"junction {number}: {error}") from error
    network, shifts = grown.builder.network(), grown.shifts
    if design.left_hand:
        network, shifts = network.mirrored, {road: -shift for road, shift in shifts.items()}
    return Route.along(network, legs_along(network, grown.passed, shifts))


@dataclass
class _RouteGrowth:
    """A network that is being built along its route."""

    design: NetworkDesign
    profiles: list[Profile]
    """The cross-section of each road before, between and behind the places that the route passes."""
    builder: Builder = field(default_factory=Builder)
    passed: list[int] = field(default_factory=list)
    """The ids of the roads of the route; the last one is that on which it has arrived."""
    shifts: dict[int, int] = field(default_factory=dict)
    """For the id of a road on which the route changes lanes, the number of lanes to the left."""

    def __post_init__(self) -> None:
        x, y, z = self.design.starting_point
        start = NetworkPose((x, y, z), math.radians(self.design.theta))
        self.passed.append(self._road(0, start, (False, bool(self.design.junctions))))

    def _road(self, number: int, start: NetworkPose, is_level: tuple[bool, bool]) -> int:
        segments = self.design.stretches[number]
        check_length(sum(segment.distance for segment in segments))
        return self.builder.add(road_of(segments, *start, self.profiles[number], is_level))

    def _end(self) -> NetworkPose:
        arrival = self.builder.roads[self.passed[-1]].road
        assert isinstance(arrival.plan, PieceCurve)
        assert isinstance(arrival.elevation, GradeProfile)
        x, y, heading = arrival.plan.end
        return NetworkPose((x, y, arrival.elevation.at(arrival.length)[0]), heading)

    def pass_place(self, number: int, place: PlaceDesign) -> None:
        """Builds a place of the design, with its arms and the road on which the route goes on."""
        is_level = number < len(self.design.junctions)
        if isinstance(place, JunctionDesign):
            self._pass_junction(number, place, is_level)
        elif isinstance(place, LanesChangeDesign):
            self._go_on(number, place, is_level)
        else:
            around = self.profiles[number - 1], self.profiles[number]
            made = RampBuilder(self.builder, place, self.passed[-1], self._end(), *around)
            road = self._road(number, made.where_it_goes_on(), (True, is_level))
            self.passed += [*made.build(road), road]

    def _go_on(self, number: int, place: LanesChangeDesign, is_level: bool) -> None:
        """Lets another road continue the one on which the route has arrived, with other lanes."""
        before = self.passed[-1]
        lanes = continued_lanes(place, self.profiles[number - 1], self.profiles[number])
        road = self._road(number, self._end(), (True, is_level))
        self.builder.continuations.append(Continuation(RoadEnd(before, "end"), RoadEnd(road, "start"), lanes))
        if place.kind == "lane_change":
            self.shifts[road] = 1 if place.side == "left" else -1
        self.passed.append(road)

    def _pass_junction(self, number: int, junction: JunctionDesign, is_level: bool) -> None:
        end, arms, taken = self._end(), junction.all_arms, junction.taken
        directions = [end.heading + math.pi, *(end.heading + math.radians(arm.angle) for arm in arms)]
        before = self.profiles[number - 1]
        profiles = [before, *profiles_of_arms(junction, before, self.profiles[number])]
        distances = contact_distances(junction, directions, profiles)
        node = end.ahead(distances[0]).point
        stubs = [self.builder.stub(RoadEnd(self.passed[-1], "end"), directions[0])]
        for n, (arm, direction) in enumerate(zip(arms, directions[1:], strict=True)):
            start = NetworkPose(node, direction).ahead(distances[n + 1])
            if n == taken:
                road = self._road(number, start, (True, is_level))
                stubs.append(self.builder.stub(RoadEnd(road, "start"), direction))
            else:
                stubs.append(self._arm(arm, start, profiles[n + 1]))
        # where no lane leads into the junction, nobody sees a sign
        controls = [
            control if stub.into else "none"
            for control, stub in zip(controls_of(junction), stubs, strict=True)
        ]
        to = 0 if taken is None else taken + 1
        if junction.kind == "roundabout":
            size = junction.radius, stubs, controls, junction.kerb, junction.ring_lanes, junction.crosswalk
            ring = build_roundabout(self.builder, node, *size)
            self.passed += roads_around(self.builder, ring, 0, to)
        else:
            built = build_crossing(
                self.builder,
                junction.kind,
                node,
                stubs,
                distances,
                controls,
                junction.kerb,
                junction.crosswalk,
            )
            self.passed.append(way_through(built.connections, stubs[0].end, stubs[to].end))
        self.passed.append(stubs[to].end.road)

    def _arm(self, arm: ArmDesign, contact: NetworkPose, profile: Profile) -> Stub:
        """Adds the road of an arm that the route does not take; a one-way road leads as its traffic does.
        ``contact`` is where it meets the junction, with the heading out of it."""
        check_length(sum(segment.distance for segment in arm.stretch))
        road = road_of(arm.stretch, *contact, profile, (True, False))
        if arm.one_way == "in":
            end = RoadEnd(self.builder.add(reversed_road(road).with_profile(profile)), "end")
        else:
            end = RoadEnd(self.builder.add(road), "start")
        return self.builder.stub(end, contact.heading)


def profiles_of_arms(junction: JunctionDesign, before: Profile, after: Profile) -> list[Profile]:
    """Returns the cross-sections of the arms in the order of ``all_arms``.

    The arm that the route takes has the cross-section ``after``. For every other arm, the first rule that
    applies gives the number of lanes in each direction. A one-way arm keeps only the lanes of its direction,
    at least one. The rules are:

    - An arm of a roundabout has as many lanes as the ring.
    - The arm opposite the arm taken has as many lanes as the arm taken, if the arm taken has more than two
      lanes in a direction, or more than one and the road of arrival is one-way. With fewer, some lanes of the
      arm taken would lead nowhere. For the same reason, the opposite arm has as many lanes as the road of
      arrival, if that road has more than two in a direction and no arm is straight ahead; at a fork, not
      more than the arm taken. If both numbers apply, the larger one counts.
    - An arm straight ahead has as many lanes as the road of arrival.
    - Any other arm has one lane.

    Args:
        junction: The junction.
        before: The cross-section of the road on which the route arrives.
        after: The cross-section of the road on which the route goes on.

    Raises:
        UsageError: The arm that the route takes has ``one_way``, or no arm fits ``take``."""
    width, shoulder = float(after.width(0.0)), after.shoulder_width
    ring, arms, taken = (junction.ring_lanes, junction.ring_lanes), junction.all_arms, junction.taken
    counts = (ring, ring) if junction.kind == "roundabout" else ((1, 1), before.count)
    side, ahead = (Profile.of(*count, width, shoulder) for count in counts)
    found = [
        after if n == taken else ahead if side_of(arm.angle) == "straight" else side
        for n, arm in enumerate(arms)
    ]
    opposite = _continuing(junction)
    fed = USUALLY_FED if before.count[1] else 1  # no lane leads to a one-way road of arrival
    needed = [after.count[::-1]] if max(after.count) > fed else []
    if max(before.count) > USUALLY_FED and all(side_of(arm.angle) != "straight" for arm in arms):
        most = after.count if junction.kind == "y_junction" else before.count
        needed.append((min(before.count[0], most[0]), min(before.count[1], most[1])))
    if opposite is not None and needed:
        out, into = (max(1, *counts) for counts in zip(*needed, strict=True))
        found[opposite] = Profile.of(out, into, width, shoulder)
    for n, arm in enumerate(arms):
        if arm.one_way is not None:
            if n == taken:
                raise UsageError(
                    "the arm that the route takes has one_way; leave it out, and give the junction lanes "
                    'with "backward": 0'
                )
            out, into = found[n].count
            found[n] = Profile.of(max(1, into if arm.one_way == "in" else out), 0, width, shoulder)
    return found


def _continuing(junction: JunctionDesign) -> int | None:
    """Returns the index of the arm opposite the arm that the route takes; None at a roundabout, or if only
    the road of arrival or no road lies there."""
    taken = junction.taken
    if taken is None or junction.kind == "roundabout":
        return None
    angles = [arm.angle for arm in junction.all_arms]
    behind = math.radians(angles[taken] + 180)
    others = {n: abs(wrapped(math.radians(angle) - behind)) for n, angle in enumerate(angles)}
    others.pop(taken)
    nearest = min(others, key=lambda n: others[n], default=None)
    return nearest if nearest is not None and others[nearest] < LEAST else None


def way_through(connections: Sequence[Connection], start: RoadEnd, end: RoadEnd) -> int:
    """Returns the id of the connecting road from one road to another. Raises UsageError if there is none."""
    for each in connections:
        if (each.incoming, each.outgoing) == (start, end):
            return each.road
    raise UsageError("the route cannot go on there: no lane leads out of the junction; give that road a lane")


def continued_lanes(place: LanesChangeDesign, before: Profile, after: Profile) -> tuple[tuple[int, int], ...]:
    """Returns pairs of lane ids: a lane before a place where lanes change, and its continuation behind it."""
    is_left = place.side == "left"
    drop, gain = place.kind == "lane_drop" and is_left, place.kind == "lane_gain" and is_left
    count = min(before.count[0], after.count[0])
    right = [(-1 - n - drop, -1 - n - gain) for n in range(count)]
    return (*right, *zip(before.against_ids, after.against_ids, strict=False))


def contact_distances(
    junction: JunctionDesign, directions: Sequence[float], profiles: Sequence[Profile]
) -> list[float]:
    """Returns the distance in metres from the node of a junction to the contact of each arm.

    ``directions`` are the headings of the arms out of the junction in radians, counter-clockwise from the
    road of arrival; ``profiles`` are the cross-sections of the arms. The road of arrival and one-way roads
    into the junction end here, so the widths at their ends count. All other roads begin here, so the widths
    at their starts count. Raises UsageError if the island of a roundabout is too small for its arms."""
    if junction.kind != "roundabout":
        ends_here = {0, *(n for n, arm in enumerate(junction.all_arms, 1) if arm.one_way == "in")}
        mouths = []
        for n, (direction, profile) in enumerate(zip(directions, profiles, strict=True)):
            left, right = edges_at(profile, FAR if n in ends_here else 0.0)
            into, out = (-right, left) if n in ends_here else (left, -right)
            mouths.append((direction, into, out))
        return setbacks(mouths, junction.kerb)
    least = smallest_radius(directions)
    if junction.radius < least:
        raise UsageError(
            f"an island with a radius of {junction.radius:g} m is too small for its arms; "
            f"give a radius of {math.ceil(10 * least) / 10:g} m or more"
        )
    return [contact_distance(junction.radius, junction.ring_lanes)] * len(directions)


def length_inside(place: PlaceDesign, before: Profile, after: Profile) -> float:
    """Returns the length in metres of a route at a place, without the roads before and behind it, whose
    cross-sections are given; 0 at a LanesChangeDesign."""
    if isinstance(place, JunctionDesign):
        return passing_length(place, before, after)
    return length_at_ramp(place) if isinstance(place, RampDesign) else 0.0


def passing_length(junction: JunctionDesign, before: Profile, after: Profile) -> float:
    """Returns the length in metres of a route inside a junction, from contact to contact, for the
    cross-sections of the roads on which the route arrives and goes on."""
    arms, taken = junction.all_arms, junction.taken
    directions = [math.pi, *(math.radians(arm.angle) for arm in arms)]
    profiles = [before, *profiles_of_arms(junction, before, after)]
    distances = contact_distances(junction, directions, profiles)
    if junction.kind == "roundabout":
        angle = 2 * math.pi if taken is None else directions[taken + 1] + math.pi
        return around_length(junction.radius, directions, angle, junction.ring_lanes)
    assert taken is not None
    turn = directions[taken + 1]
    pieces = curve_between(distances[0], distances[taken + 1], turn)
    return sum(piece.length for piece in pieces)


def roads_around(builder: Builder, ring: Roundabout, start: int, to: int) -> list[int]:
    """Returns the ids of the roads from the arm of a roundabout with index ``start`` to the arm with index
    ``to``, in driving order; all the way round if both are the same arm. Raises UsageError if no lane leads
    into or out of one of these arms."""
    mouths = {each.id: each for each in builder.junctions if each.id in ring.junctions}
    count, entered = len(ring.ring), mouths[ring.junctions[start]]
    passed = [way_through(entered.connections, entered.arms[0].end, RoadEnd(ring.ring[start], "start"))]
    for n in range(start, start + (to - start - 1) % count + 1):
        road, following = ring.ring[n % count], (n + 1) % count
        mouth = mouths[ring.junctions[following]]
        after = mouth.arms[0].end if following == to else RoadEnd(ring.ring[following], "start")
        passed += [road, way_through(mouth.connections, RoadEnd(road, "end"), after)]
    return passed


def controls_of(junction: JunctionDesign) -> tuple[Control, ...]:
    """Returns the sign or light of the road of arrival, then those of the arms in the order of ``all_arms``.

    They depend on the ``control`` of the junction:

    - With "lights", every arm has lights.
    - Otherwise every arm of a roundabout gives way; with "stop", the road of arrival has a stop sign instead.
    - Elsewhere, with "yield" or "stop", the road of arrival and the arm straight ahead have this sign, and
      the others have priority.
    - Elsewhere, with "priority", the road of arrival and the arm straight ahead have priority. If no arm is
      straight ahead, the arm that the route takes has priority instead. The others give way.
    - Elsewhere, with "none", no arm has a sign.

    The ``control`` of an arm replaces the sign or light of this arm."""
    arms = junction.all_arms
    nearest = min(range(len(arms)), key=lambda n: abs(arms[n].angle))
    opposite = nearest if abs(math.radians(arms[nearest].angle)) <= LEAST else None
    found: list[Control]
    if junction.control == "lights":
        found = ["lights"] * (len(arms) + 1)
    elif junction.kind == "roundabout":
        found = ["yield"] * (len(arms) + 1)
        found[0] = junction.control if junction.control in ("stop", "yield") else "yield"
    elif junction.control == "priority":
        main = opposite if opposite is not None else junction.taken
        found = ["priority", *("priority" if n == main else "yield" for n in range(len(arms)))]
    elif junction.control in ("stop", "yield"):
        minor = junction.control
        found = [minor, *(minor if n == opposite else "priority" for n in range(len(arms)))]
    else:
        found = ["none"] * (len(arms) + 1)
    return (found[0], *(arm.control or usual for arm, usual in zip(arms, found[1:], strict=True)))


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
        return self._roads[nodes if nodes in self._roads else nodes[::-1]]

    def _through(self, number: int, before: int, after: int) -> list[int]:
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
