"""Builds the network that a design describes, and the route through it.

The design of a route gives the place of its start only: roads and junctions are built in the order in which
the route passes them, each where the one before it ends. A map gives the place of each node: the roads
between the nodes are built first, and then the junctions."""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import cast

from roadgpt.brief.junctions import RINGS, side_of
from roadgpt.errors import UsageError
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import wrapped
from roadgpt.geometry.pieces import joined
from roadgpt.language.names import Control, PlainKind
from roadgpt.network.building import (
    FAR,
    ISLAND_LENGTH,
    ISLAND_TAPER,
    USUALLY_FED,
    Builder,
    RampBuilder,
    Stub,
    around_length,
    contact_distance,
    edges_at,
    length_at_ramp,
    length_of_turn_lanes,
    setbacks,
    smallest_radius,
    with_island,
    with_turn_lanes,
)
from roadgpt.network.lane_along import legs_along
from roadgpt.network.network import Continuation, Junction, Leg, NetworkRoad, RoadEnd, Roundabout
from roadgpt.network.pose import NetworkPose, curve_between, tangent_length
from roadgpt.network.route import Route
from roadgpt.network.stretch import climb_between, parts_of, road_of, stretch_profiles
from roadgpt.road import Design, Profile, Road, World
from roadgpt.road.design import (
    BEND,
    ISLAND,
    ArmDesign,
    JunctionDesign,
    LanesChangeDesign,
    MapNode,
    PlaceDesign,
    RampDesign,
    heading_between,
)
from roadgpt.road.road import check_length, reversed_road

LEAST = math.radians(40.0)  # largest deviation from a straight line of two arms that count as opposite
BEFORE_TURN_LANES = 5.0  # m, least length of a road before the taper of its turn lanes
SHORTEST = 0.1  # m, least length of a straight road between two junctions; the rules require more
NO_TURN = 1e-6  # rad; a bend with a smaller turn has no curve


def build_route(design: Design, world: World) -> Route:
    """Returns the route that a design describes, with the network in which it lies. If a map has no route,
    the result has no legs; see ``Route``.

    The World gives the width of the shoulders, and the lane width where the design has none. Raises
    UsageError if the World asks for lanes or banked bends that networks do not have, the lanes of a road do
    not fit, no arm of a junction fits ``take``, a lane that the route needs cannot be reached, junctions,
    roundabouts or bends have no room on a road, the island of a roundabout is too small for its arms, a bend
    is tighter than its lane is wide, or a road is longer than 50 km."""
    # traffic on the left is the mirror image of traffic on the right
    seen = design.mirrored() if design.left_hand else design
    profiles = stretch_profiles(seen, world)
    passed: Sequence[int]
    shifts: Mapping[int, int] = {}
    if design.is_map:
        over_map = _MapGrowth(seen, profiles[0])
        passed, network = over_map.along(design.route), over_map.builder.network()
        if len(passed) == 1:
            is_along = (design.route in over_map.roads) != design.left_hand
            network = network.mirrored if design.left_hand else network
            return Route.along(network, [Leg(passed[0], -1 if is_along else 1)])
    else:
        grown = _RouteGrowth(seen, profiles)
        for number, (own, place) in enumerate(zip(design.junctions, seen.junctions, strict=True), 1):
            try:
                if isinstance(own, JunctionDesign):
                    own.check_taken(design.left_hand)  # says left and right as the design does
                grown.pass_place(number, place)
            except UsageError as error:
                raise UsageError(f"junction {number}: {error}") from error
        network, passed, shifts = grown.builder.network(), grown.passed, grown.shifts
    if design.left_hand:
        network, shifts = network.mirrored, {road: -shift for road, shift in shifts.items()}
    changes = any(getattr(place, "kind", None) == "lane_change" for place in design.junctions)
    # where the words say how the route changes lanes, they say in which one it begins
    lane = world.scene.lane if changes else world.scene.lane_driven(design.left_hand)
    return Route.along(network, legs_along(network, passed, shifts, lane) if passed else [])


@dataclass
class _RouteGrowth:
    """A network that is being built along its route."""

    design: Design
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
        is_level, around = number < len(self.design.junctions), self.profiles[number - 1 : number + 1]
        if isinstance(place, JunctionDesign):
            self._pass_junction(number, place, is_level)
        elif isinstance(place, LanesChangeDesign):  # another road continues that of arrival, with other lanes
            road = self._road(number, self._end(), (True, is_level))
            if place.island:
                self._pass_island(road)
            else:
                lanes = continued_lanes(place, *around)
                self._continue(self.passed[-1], road, lanes, place.kind == "crosswalk")
            if place.kind == "lane_change":
                self.shifts[road] = 1 if place.side == "left" else -1
        else:
            made = RampBuilder(self.builder, place, self.passed[-1], self._end(), *around)
            road = self._road(number, made.where_it_goes_on(), (True, is_level))
            self.passed += [*made.build(road), road]

    def _continue(
        self, before: int, road: int, lanes: tuple[tuple[int, int], ...], crosswalk: bool = False
    ) -> None:
        ends = RoadEnd(before, "end"), RoadEnd(road, "start")
        self.builder.continuations.append(Continuation(*ends, lanes, crosswalk))
        self.passed.append(road)

    def _split(self, number: int, s: float, before: Profile, behind: Profile) -> int:
        """Makes a road end at a station, and returns the id of a new one that leads on from there."""
        first, last = parts_of(self.builder.roads[number].road, s)
        self.builder.roads[number] = NetworkRoad(number, first.with_profile(before))
        return self.builder.add(last.with_profile(behind))

    def _pass_island(self, road: int) -> None:
        """Goes on to a road across a crosswalk with an island. The parts beside it are roads of their own."""
        (before, one), (_, two) = ((n, self.builder.roads[n].road) for n in (self.passed[-1], road))
        own, long = self.builder.roads[before].profile, ISLAND_TAPER + ISLAND_LENGTH
        if own.is_divided or not own.against_ids:
            raise UsageError("an island divides the two directions of a road without a median; leave it out")
        if (least := long + BEFORE_TURN_LANES) > (shorter := min(one.length, two.length)):
            raise UsageError(
                f"an island needs {least:.0f} m of the roads before and behind it, and one is "
                f"{shorter:.0f} m long; make it longer"
            )
        behind = self.builder.roads[road].profile
        wide = self._split(before, one.length - long, own, with_island(own, at_end=True))
        rest = self._split(road, long, with_island(behind, at_end=False), behind)
        lanes = tuple((n, n + (n > 0)) for n in (*own.along_ids, *own.against_ids))
        self._continue(before, wide, lanes)
        self._continue(wide, road, tuple((n, n) for _, n in lanes), crosswalk=True)
        self._continue(road, rest, tuple((n, number) for number, n in lanes))

    def _add_turn_lanes(self, junction: JunctionDesign) -> None:
        """Makes the last part of the road of arrival a road of its own, with turn lanes."""
        arrival, profile = self.passed[-1], self.builder.roads[self.passed[-1]].profile
        whole = self.builder.roads[arrival].road
        length = length_of_turn_lanes(junction, float(profile.width(whole.length)))
        start = whole.length - length
        if start < BEFORE_TURN_LANES or edges_at(profile, start) != edges_at(profile, FAR):
            raise UsageError(
                f"its turn lanes need {BEFORE_TURN_LANES + length:.0f} m of the road before it, which is "
                f"{whole.length:.0f} m long or changes its lanes there; make that road longer"
            )
        wide = self._split(arrival, start, profile, with_turn_lanes(profile, junction))
        inside = int("left" in junction.turn_lanes)
        lanes = (*((n, n - inside) for n in profile.along_ids), *((n, n) for n in profile.against_ids))
        self._continue(arrival, wide, lanes)

    def _pass_junction(self, number: int, junction: JunctionDesign, is_level: bool) -> None:
        if junction.turn_lanes:
            self._add_turn_lanes(junction)
        end, arms, taken = self._end(), junction.all_arms, junction.taken
        if taken is not None and side_of(arms[taken].angle) in junction.turn_lanes:
            self.shifts[self.passed[-1]] = 1 if arms[taken].angle > 0 else -1
        directions = [end.heading + math.pi, *(end.heading + math.radians(arm.angle) for arm in arms)]
        before = self.profiles[number - 1]
        profiles = [before, *profiles_of_arms(junction, before, self.profiles[number])]
        distances = contact_distances(junction, directions, profiles)
        node = end.ahead(distances[0]).point
        arrival = self.builder.stub(RoadEnd(self.passed[-1], "end"), directions[0])
        stubs = [replace(arrival, turn_lanes=junction.turn_lanes)]
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
        built = self.builder.join(junction, node, stubs, distances, controls)
        self.passed += self.builder.through(built, 0, to)
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
    counts = (ring, ring) if junction.kind in RINGS else ((1, 1), before.count)
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
    if taken is None or junction.kind in RINGS:
        return None
    angles = [arm.angle for arm in junction.all_arms]
    behind = math.radians(angles[taken] + 180)
    others = {n: abs(wrapped(math.radians(angle) - behind)) for n, angle in enumerate(angles)}
    others.pop(taken)
    nearest = min(others, key=lambda n: others[n], default=None)
    return nearest if nearest is not None and others[nearest] < LEAST else None


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
    if junction.kind not in RINGS:
        ends_here = {0, *(n for n, arm in enumerate(junction.all_arms, 1) if arm.one_way == "in")}
        mouths = []
        profiles = [with_turn_lanes(profiles[0], junction), *profiles[1:]]
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
    cross-sections are given: at a junction, from contact to contact; at a LanesChangeDesign, 0."""
    if not isinstance(place, JunctionDesign):
        return length_at_ramp(place) if isinstance(place, RampDesign) else 0.0
    taken = place.taken
    directions = [math.pi, *(math.radians(arm.angle) for arm in place.all_arms)]
    distances = contact_distances(place, directions, [before, *profiles_of_arms(place, before, after)])
    if place.kind in RINGS:
        angle = 2 * math.pi if taken is None else directions[taken + 1] + math.pi
        return around_length(place.radius, directions, angle, place.ring_lanes)
    assert taken is not None
    pieces = curve_between(distances[0], distances[taken + 1], directions[taken + 1])
    return sum(piece.length for piece in pieces)


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
    arms, control, taken = junction.all_arms, junction.control, junction.taken
    if not arms:
        return ("none",)
    nearest = min(range(len(arms)), key=lambda n: abs(arms[n].angle))
    opposite = nearest if abs(math.radians(arms[nearest].angle)) <= LEAST else None
    if junction.kind == "roundabout" and control != "lights":
        arrival: Control = "stop" if control == "stop" else "yield"
        found = (arrival, *_signs("yield", len(arms), ()))
    elif control == "priority":
        ahead = taken if opposite is None else opposite
        found = _signs(control, len(arms) + 1, {0} if ahead is None else {0, ahead + 1})
    else:
        found = _signs(control, len(arms) + 1, {n + 1 for n in range(len(arms)) if n != opposite})
    return (found[0], *(arm.control or usual for arm, usual in zip(arms, found[1:], strict=True)))


def _signs(control: Control, count: int, main: Collection[int]) -> tuple[Control, ...]:
    """Returns the signs or lights of ``count`` arms: the same on all with "lights" and "none". Otherwise the
    arms of the main road have priority, and the others stop with "stop" and else give way."""
    if control in ("lights", "none"):
        return (control,) * count
    minor: Control = "yield" if control == "priority" else control
    return tuple("priority" if n in main else minor for n in range(count))


def signs_at(node: MapNode, directions: Sequence[float]) -> tuple[Control, ...]:
    """Returns the sign or light of each arm of a junction, from the headings of the arms out of it in
    radians.

    The ``control`` of the node decides. With "lights", all arms have lights. Otherwise all arms of a
    roundabout have stop signs with "stop", and give way with any other value. At other junctions, no arm has
    a sign with "none". Otherwise the two arms that are most nearly opposite are the main road and have
    priority; the other arms have stop signs with "stop", and give way with "yield" or "priority"."""
    count = len(directions)
    if count == 1:
        return ("none",)
    if node.kind == "roundabout":
        return (node.control if node.control in ("lights", "stop") else "yield",) * count
    pairs = [(i, j) for i in range(count) for j in range(i)]
    main = max(pairs, key=lambda pair: abs(wrapped(directions[pair[0]] - directions[pair[1]])))
    return _signs(node.control, count, main)


class _MapGrowth:
    """A network that is being built from a map, for traffic on the right."""

    def __init__(self, design: Design, profile: Profile) -> None:
        self.profile, self.builder = profile, Builder()
        self.nodes: dict[int, MapNode] = dict(enumerate(design.nodes, 1))
        ways: dict[int, dict[int, float]] = {number: {} for number in self.nodes}
        for one, other in design.roads:
            for here, there in ((one, other), (other, one)):
                ways[here][there] = heading_between(self.nodes[here], self.nodes[there])
        self.ways = {n: dict(sorted(to.items(), key=lambda way: way[1])) for n, to in ways.items()}
        """For each node, the headings in radians to the nodes that roads join to it, counter-clockwise."""
        self.contacts = {number: self._contacts(number) for number in self.nodes}
        self.roads: dict[tuple[int, ...], int] = {}
        """The id of each road, by the nodes along the road."""
        self.ends: dict[tuple[int, int], RoadEnd] = {}
        """For each node and the next node on one of its roads, the end of this road at the first node."""
        for nodes in self._chains():
            self._add_road(nodes)
        self.built: dict[int, Junction | Roundabout] = {}
        for n, node in ((n, node) for n, node in self.nodes.items() if node.is_junction):
            stubs = [self.builder.stub(self.ends[n, other], way) for other, way in self.ways[n].items()]
            signs, distances = signs_at(node, [*self.ways[n].values()]), [*self.contacts[n].values()]
            self.built[n] = self.builder.join(junction_of(node), node.at, stubs, distances, signs)

    def along(self, route: Sequence[int]) -> list[int]:
        """Returns the ids of the roads that lead along nodes, in driving order."""
        passed: list[int] = []
        first = 0
        for n in range(1, len(route)):
            if self.nodes[route[n]].kind == "bend":
                continue
            if passed:
                here, others = route[first], [*self.ways[route[first]]]
                arms = others.index(route[first - 1]), others.index(route[first + 1])
                passed += self.builder.through(self.built[here], *arms)
            nodes = tuple(route[first : n + 1])
            passed.append(self.roads[nodes if nodes in self.roads else nodes[::-1]])
            first = n
        return passed

    def _contacts(self, number: int) -> dict[int, float]:
        """Returns the distance in metres from a node to the start of each of its roads, by the next node."""
        node, ways = self.nodes[number], self.ways[number]
        if not node.is_junction:
            return dict.fromkeys(ways, 0.0)
        try:
            found = contact_distances(junction_of(node), [*ways.values()], [self.profile] * len(ways))
        except UsageError as error:
            raise UsageError(f"node {number}: {error}") from error
        return dict(zip(ways, found, strict=True))

    def _chains(self) -> Iterator[tuple[int, ...]]:
        """Yields the chains of roads that lead over bends from one junction or end of a road to the next,
        each once, in one of its two directions, given by the nodes along it."""
        found = set[tuple[int, ...]]()
        for start, ways in self.ways.items():
            for end in ways if self.nodes[start].kind != "bend" else ():
                nodes = [start, end]
                while self.nodes[nodes[-1]].kind == "bend":
                    nodes.append(next(each for each in self.ways[nodes[-1]] if each != nodes[-2]))
                if tuple(nodes) not in found:
                    found |= {tuple(nodes), tuple(reversed(nodes))}
                    yield tuple(nodes)

    def _add_road(self, nodes: tuple[int, ...]) -> None:
        """Builds the road along nodes, from a junction or end to the next."""
        start, end = nodes[0], nodes[-1]
        before, after = self.contacts[start][nodes[1]], self.contacts[end][nodes[-2]]
        pieces = self._pieces(nodes, before, after)
        check_length(sum(piece.length for piece in pieces))
        x, y, _ = self.nodes[start].at
        heading = self.ways[start][nodes[1]]
        plan = PieceCurve(x + before * math.cos(heading), y + before * math.sin(heading), heading, pieces)
        heights = climb_between(self.nodes[start].at[2], self.nodes[end].at[2], plan.length)
        road = self.builder.add(Road(plan, heights, profile=self.profile))
        self.roads[nodes] = road
        self.ends[start, nodes[1]] = RoadEnd(road, "start")
        self.ends[end, nodes[-2]] = RoadEnd(road, "end")

    def _pieces(self, nodes: Sequence[int], before: float, after: float) -> tuple[Piece, ...]:
        """Returns the straights and curves of a road along nodes, from ``before`` metres behind the first
        node to ``after`` metres before the last one."""
        pieces: list[Piece] = []
        taken, curve = before, tuple[Piece, ...]()
        for n, (one, other) in enumerate(pairwise(nodes), 1):
            needed, following = after, tuple[Piece, ...]()
            if n < len(nodes) - 1:
                needed, following = self._bend(other, self.ways[other][nodes[n + 1]] - self.ways[one][other])
            (x, y, _), (to_x, to_y, _) = self.nodes[one].at, self.nodes[other].at
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

    def _bend(self, number: int, turned: float) -> tuple[float, tuple[Piece, ...]]:
        """Returns the length in metres that a bend takes of each straight beside it, and the bend's curve;
        ``turned`` is the difference of their headings in radians."""
        turn = wrapped(turned)
        if abs(turn) < NO_TURN:
            return 0.0, ()
        radius, width = self.nodes[number].radius or BEND, float(self.profile.width(0.0))
        if radius < width:
            raise UsageError(
                f"node {number}: a bend with a radius of {radius:g} m is tighter than the lane beside it is "
                f"wide; give a radius of {width:g} m or more"
            )
        tangent = radius * tangent_length(abs(turn))
        return tangent, curve_between(tangent, tangent, turn)


def junction_of(node: MapNode) -> JunctionDesign:
    """Returns a JunctionDesign with the kind, kerb and radius of a node; do not use its other fields."""
    radius = ISLAND if node.radius is None else node.radius
    return JunctionDesign.model_construct(
        after=1, take=1, kind=cast(PlainKind, node.kind), kerb=node.kerb, radius=radius
    )
