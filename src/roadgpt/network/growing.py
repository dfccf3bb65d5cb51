"""Builds a network along a route: each road and each junction in the order in which the route passes them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from roadgpt.brief.junctions import Control, side_of
from roadgpt.errors import UsageError
from roadgpt.geometry import GradeProfile, PieceCurve
from roadgpt.geometry.curve import wrapped
from roadgpt.network.building import Builder, Stub, edges_at
from roadgpt.network.crossing import USUALLY_FED, build_crossing, setbacks
from roadgpt.network.design import (
    ArmDesign,
    JunctionDesign,
    LanesChangeDesign,
    NetworkDesign,
    PlaceDesign,
    RampDesign,
)
from roadgpt.network.lane_along import legs_along
from roadgpt.network.network import Connection, Continuation, RoadEnd, Roundabout
from roadgpt.network.pose import NetworkPose, curve_between
from roadgpt.network.ramps import RampBuilder, length_at_ramp
from roadgpt.network.ring import around_length, build_roundabout, contact_distance, smallest_radius
from roadgpt.network.route import Route
from roadgpt.network.stretch import road_of, stretch_profiles
from roadgpt.road import Profile, World
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
        """Adds the road behind the place with this number (0: the first road), level at its start and its end
        or not; returns its id."""
        segments = self.design.stretches[number]
        check_length(sum(segment.distance for segment in segments))
        return self.builder.add(road_of(segments, *start, self.profiles[number], is_level))

    def _end(self) -> NetworkPose:
        """Returns the pose at the end of the road on which the route has arrived."""
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
