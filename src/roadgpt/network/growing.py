"""Builds a network along a route: each road and each junction in the order in which the route passes them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from roadgpt.brief.junctions import Control
from roadgpt.errors import UsageError
from roadgpt.network.building import Builder, Stub
from roadgpt.network.crossing import Mouth, build_crossing, setbacks
from roadgpt.network.design import STUB, ArmDesign, JunctionDesign, NetworkDesign
from roadgpt.network.network import Leg, RoadEnd, Roundabout
from roadgpt.network.ring import around_length, build_roundabout, contact_distance, smallest_radius
from roadgpt.network.route import Route
from roadgpt.network.stretch import road_of
from roadgpt.network.turning import curve_between
from roadgpt.road import Profile, Segment, World
from roadgpt.road.road import check_length
from roadgpt.road.world import OWN

LEAST = math.radians(40.0)  # of an arm that lies opposite another one


def build_route(design: NetworkDesign, world: World) -> Route:
    """Returns the route that a design describes, with the network in which it lies.

    Args:
        design: The segments and junctions of the route.
        world: The World, which gives the width of lanes and shoulders where the design gives none.

    Raises:
        UsageError: The World asks for lanes or banked bends that networks do not have, the island of a
            roundabout is too small for its arms, or a road is longer than 50 km.
    """
    grown = _RouteGrowth(design, _profile(design, world))
    for number, junction in enumerate(design.junctions, 1):
        try:
            grown.pass_junction(number, junction)
        except UsageError as error:
            raise UsageError(f"junction {number}: {error}") from error
    return Route.along(grown.builder.network(), grown.legs)


def _profile(design: NetworkDesign, world: World) -> Profile:
    section = world.section
    changed = [name for name, usual in OWN.items() if getattr(section, name) != usual]
    if changed:
        flags = ", ".join(f"--{name.replace('_', '-')}" for name in changed)
        raise UsageError(f"a network has level roads with one lane in each direction; leave out {flags}")
    width = section.lane_width if design.lanes is None else design.lanes.width
    return Profile.of(1, 1, width, section.shoulder)


@dataclass
class _RouteGrowth:
    """A network that is being built along its route."""

    design: NetworkDesign
    profile: Profile
    builder: Builder = field(default_factory=Builder)
    legs: list[Leg] = field(default_factory=list)
    _number: int = 0
    """The id of the road on which the route has arrived."""

    def __post_init__(self) -> None:
        x, y, z = self.design.starting_point
        first = self.design.stretches[0]
        self._number = self._road(first, (x, y, z), math.radians(self.design.theta), (False, True))
        self.legs.append(Leg(self._number, -1))

    def _road(
        self,
        segments: Sequence[Segment],
        start: tuple[float, float, float],
        heading: float,
        is_level: tuple[bool, bool],
    ) -> int:
        check_length(sum(segment.distance for segment in segments))
        return self.builder.add(road_of(segments, start, heading, self.profile, is_level))

    def pass_junction(self, number: int, junction: JunctionDesign) -> None:
        """Builds a junction of the design, with its arms and the road on which the route goes on."""
        arrival = self.builder.roads[self._number].road
        x, y, z = arrival.at(arrival.length).tolist()
        heading = float(arrival.heading(arrival.length))
        arms, taken = junction.all_arms, junction.taken
        directions = [heading + math.pi, *(heading + math.radians(arm.angle) for arm in arms)]
        distances = contact_distances(junction, directions, float(self.profile.width(0.0)))
        far = distances[0]
        node = (x + far * math.cos(heading), y + far * math.sin(heading), z)
        stubs = [Stub(RoadEnd(self._number, "end"), directions[0], self.profile, arrival.length)]
        ends_here = number == len(self.design.junctions)
        for n, (arm, direction) in enumerate(zip(arms, directions[1:], strict=True)):
            out = distances[n + 1]
            start = (node[0] + out * math.cos(direction), node[1] + out * math.sin(direction), z)
            if n == taken:
                road = self._road(self.design.stretches[number], start, direction, (True, not ends_here))
            else:
                side = (Segment(distance=arm.length or STUB, direction="straight"),)
                road = self._road(side, start, direction, (True, False))
            stubs.append(Stub(RoadEnd(road, "start"), direction, self.profile, 0.0))
        controls = controls_of(junction)
        to = 0 if taken is None else taken + 1
        if junction.kind == "roundabout":
            ring = build_roundabout(self.builder, node, junction.radius, stubs, controls, junction.kerb)
            self.legs += _around(self.builder, ring, to)
        else:
            built = build_crossing(
                self.builder, junction.kind, node, stubs, distances, controls, junction.kerb
            )
            way = next(
                each
                for each in built.connections
                if each.incoming == stubs[0].end and each.outgoing == stubs[to].end
            )
            self.legs.append(Leg(way.road, -1))
        self._number = stubs[to].end.road
        self.legs.append(Leg(self._number, -1 if to else 1))


def contact_distances(junction: JunctionDesign, directions: Sequence[float], width: float) -> list[float]:
    """Returns the distance in metres from the node of a junction to the contact of each arm.

    Args:
        junction: The junction.
        directions: The headings of its arms out of the junction in radians, counter-clockwise, first that of
            the road on which the route arrives.
        width: The width of every lane in metres.

    Raises:
        UsageError: The island of a roundabout is too small for its arms.
    """
    if junction.kind != "roundabout":
        return setbacks([Mouth(each, width, width) for each in directions], junction.kerb)
    least = smallest_radius(directions)
    if junction.radius < least:
        raise UsageError(
            f"an island with a radius of {junction.radius:g} m is too small for its arms; "
            f"give a radius of {math.ceil(10 * least) / 10:g} m or more"
        )
    return [contact_distance(junction.radius)] * len(directions)


def passing_length(junction: JunctionDesign, width: float) -> float:
    """Returns the length in metres of a route inside a junction, from contact to contact.

    Args:
        junction: The junction.
        width: The width of every lane in metres.

    Raises:
        UsageError: The island of a roundabout is too small for its arms.
    """
    arms, taken = junction.all_arms, junction.taken
    directions = [math.pi, *(math.radians(arm.angle) for arm in arms)]
    distances = contact_distances(junction, directions, width)
    if junction.kind == "roundabout":
        angle = 2 * math.pi if taken is None else directions[taken + 1] + math.pi
        return around_length(junction.radius, directions, angle)
    assert taken is not None
    turn = directions[taken + 1]
    pieces = curve_between(distances[0], distances[taken + 1], turn)
    return sum(piece.length for piece in pieces)


def _around(builder: Builder, ring: Roundabout, to: int) -> list[Leg]:
    """Returns the legs of a route around a roundabout, from its first arm to the arm with index ``to``."""
    mouths = {each.id: each.connections for each in builder.junctions if each.id in ring.junctions}
    legs = [Leg(mouths[ring.junctions[0]][2].road, -1)]
    count = len(ring.ring)
    for n in range((to - 1) % count + 1):
        legs.append(Leg(ring.ring[n], -1))
        along, off, _ = mouths[ring.junctions[(n + 1) % count]]
        is_last = n == (to - 1) % count
        legs.append(Leg((off if is_last else along).road, -1))
    return legs


def controls_of(junction: JunctionDesign) -> tuple[Control, ...]:
    """Returns the sign or light of each arm, first of the road of arrival, then of the others from the right.

    With "lights", every arm has lights. With "yield" or "stop", the road of arrival has the sign, and so does
    an arm opposite it. With "priority", all arms give way except the road of arrival and the road that goes
    on: the one opposite, or else the one that is taken. At a roundabout, every arm gives way unless there are
    lights. An arm's own ``control`` replaces all this.
    """
    arms = junction.all_arms
    opposite = _opposite(arms)
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


def _opposite(arms: Sequence[ArmDesign]) -> int | None:
    """Returns the index of the arm that goes straight on, within ``LEAST``; None if there is none."""
    nearest = min(range(len(arms)), key=lambda n: abs(arms[n].angle))
    return nearest if abs(math.radians(arms[nearest].angle)) <= LEAST else None
