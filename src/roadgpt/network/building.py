"""Builds junctions, roundabouts and ramps, for traffic on the right, and gives roads and junctions their ids.

The node is the point at which the reference lines of all arms meet. Each arm ends at a contact before the
node, so far away that the kerbs to both neighbouring arms have room. A connecting road leads from one contact
to another: its reference line consists of lines, an arc and clothoids, and begins and ends on the reference
lines of the two arms.

Which lanes lead to which arms, for traffic on the right: traffic that turns right to the rightmost arm uses
the rightmost lane. Traffic that turns left to the leftmost arm uses the leftmost lane. If there is one arm
between these two arms, all lanes lead to that arm; if the arm has fewer lanes, only the leftmost lanes do. If
the arm has two lanes more, traffic straight on uses its middle lanes, and traffic that turns to the arm uses
its leftmost and its rightmost lane. Two or more arms in between divide the lanes. If there is no arm in
between, the left and the right turn divide the lanes. There are two exceptions:

- If a lane would then lead to no arm, the lanes are divided so that no lane leads to two arms. - If an arm
has more than two lanes and no arm leads straight on to it, several lanes turn to it side by side.

The ways from one arm never cross each other.

At a roundabout, the reference line of the ring is the edge of the central island; the ring is driven
counter-clockwise, with its lanes on the right of this line. A road with one lane joins the outer lane of the
ring. Each arm leads towards the centre and has a junction of its own, its mouth: the part of the ring at the
arm. Through a mouth, one connecting road leads along the ring, one from the ring to the arm, and one from the
arm to the ring.

A merge or an exit is a ramp that joins or leaves a main road, with an additional lane of this road:

    main road  -----------+--------------------------------------
    ramp  ----------------'  node | lane for acceleration | taper

The reference lines of the main road and of the ramp meet at the node. Behind a merge, the main road has an
additional lane that ends in a taper; before an exit, it has one that begins in a taper. Traffic drives on the
right. A ramp on the left joins the innermost lanes, beside the median."""

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import pairwise

from roadgpt.brief.junctions import RINGS, side_of
from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import Point, wrapped
from roadgpt.language.names import Control, Side, Way
from roadgpt.network.lane_along import added
from roadgpt.network.network import (
    Arm,
    Connection,
    Contact,
    Continuation,
    Junction,
    LaneLink,
    Network,
    NetworkRoad,
    RoadEnd,
    Roundabout,
)
from roadgpt.network.pose import STRAIGHT, NetworkPose, curve_between, tangent_length
from roadgpt.network.stretch import road_of
from roadgpt.road import Profile, Road, Segment
from roadgpt.road.design import JunctionDesign, PlaceDesign, RampDesign
from roadgpt.road.profile import LaneStrip, Marking, Width, width_at


@dataclass
class Builder:
    """A network under construction."""

    roads: dict[int, NetworkRoad] = field(default_factory=dict)
    junctions: list[Junction] = field(default_factory=list)
    roundabouts: list[Roundabout] = field(default_factory=list)
    continuations: list[Continuation] = field(default_factory=list)
    _last: int = 0

    def number(self) -> int:
        """Returns the next free id. Roads and junctions are numbered in one series."""
        self._last += 1
        return self._last

    def add(self, road: Road, junction: int | None = None, number: int | None = None) -> int:
        """Adds a road that has a profile; returns its id: ``number`` or, for None, the next free one.
        ``junction`` is the id of the junction to which a connecting road belongs."""
        number = self.number() if number is None else number
        self.roads[number] = NetworkRoad(number, road, junction)
        return number

    def stub(self, end: RoadEnd, direction: float) -> "Stub":
        """Returns the end of a road that leads out of a junction in a direction, given in radians."""
        member = self.roads[end.road]
        return Stub(end, direction, member.profile, member.road.length if end.contact == "end" else 0.0)

    def join(
        self,
        design: JunctionDesign,
        node: Point,
        stubs: Sequence["Stub"],
        distances: Sequence[float],
        controls: Sequence[Control],
    ) -> Junction | Roundabout:
        """Builds the junction or the roundabout at which the stubs meet, and returns it. ``node`` is the
        point in metres at which the reference lines would meet. ``distances`` are those in metres from the
        node to the contacts of the stubs, and decide how much room there is; the kerb is only stored. All
        sequences are in counter-clockwise order."""
        if design.kind in RINGS:
            return build_roundabout(self, design, node, stubs, controls)
        number, far = self.number(), distances
        connections = [
            connected(self, number, node, (stubs[i], stubs[j]), (far[i], far[j]), way)
            for i in range(len(stubs))
            for j, way in lane_ways(stubs, i)
        ]
        arms = tuple(
            Arm(stub.end, stub.direction, control, design.crosswalk)
            for stub, control in zip(stubs, controls, strict=True)
        )
        junction = Junction(number, design.kind, arms, tuple(connections), node, design.kerb)
        self.junctions.append(junction)
        return junction

    def through(self, built: Junction | Roundabout, start: int, to: int) -> list[int]:
        """Returns the ids of the roads that lead through a junction or roundabout, in driving order, from the
        arm with index ``start`` to the arm with index ``to``; all the way round a roundabout if both are the
        same arm. Raises UsageError if no lane leads into or out of one of these arms."""
        if isinstance(built, Junction):
            return [way_through(built.connections, built.arms[start].end, built.arms[to].end)]
        mouths = {each.id: each for each in self.junctions if each.id in built.junctions}
        count, entered = len(built.ring), mouths[built.junctions[start]]
        passed = [way_through(entered.connections, entered.arms[0].end, RoadEnd(built.ring[start], "start"))]
        for n in range(start, start + (to - start - 1) % count + 1):
            road, following = built.ring[n % count], (n + 1) % count
            mouth = mouths[built.junctions[following]]
            after = mouth.arms[0].end if following == to else RoadEnd(built.ring[following], "start")
            passed += [road, way_through(mouth.connections, RoadEnd(road, "end"), after)]
        return passed

    def network(self) -> Network:
        """Returns the finished network, with the roads in the order of their ids."""
        ordered = tuple(self.roads[number] for number in sorted(self.roads))
        return Network(ordered, tuple(self.junctions), tuple(self.roundabouts), tuple(self.continuations))


def way_through(connections: Sequence[Connection], start: RoadEnd, end: RoadEnd) -> int:
    """Returns the id of the connecting road from one road to another. Raises UsageError if there is none."""
    for each in connections:
        if (each.incoming, each.outgoing) == (start, end):
            return each.road
    raise UsageError("the route cannot go on there: no lane leads out of the junction; give that road a lane")


@dataclass(frozen=True)
class Stub:
    """The end of a road at a junction that is not built yet. Traffic drives on the right."""

    end: RoadEnd
    direction: float  # the heading in radians out of the junction
    profile: Profile
    station: float  # the station in metres of this end of the road
    turn_lanes: tuple[Side, ...] = ()
    """The sides to which the outermost lanes into the junction lead alone."""

    @cached_property
    def into(self) -> "StubLanes":
        """The driving lanes that lead into the junction."""
        return self._lanes(self.end.contact == "end")

    @cached_property
    def out_of(self) -> "StubLanes":
        """The driving lanes that lead out of the junction."""
        return self._lanes(self.end.contact == "start")

    def _lanes(self, is_along: bool) -> "StubLanes":
        profile, offset = self.profile, width_at(self.profile.offset, self.station)
        lanes = profile.right if is_along else profile.left
        ids = profile.along_ids if is_along else profile.against_ids
        widths = [width_at(lane.width, self.station) for lane in lanes]
        inside = sum(widths[: abs(ids[0]) - 1]) if ids else 0.0
        own = tuple(widths[abs(number) - 1] for number in ids)
        return StubLanes(ids, own, (-offset if is_along else offset) + inside)


@dataclass(frozen=True)
class StubLanes:
    """The driving lanes of a stub in one direction, from the centre line outwards."""

    ids: tuple[int, ...]
    widths: tuple[float, ...]  # the widths in metres at the junction
    edge: float
    """The distance in metres from the reference line to the left edge of the first lane. Left and right are
    those of the driver; the distance is positive to the right."""

    def __len__(self) -> int:
        return len(self.widths)

    def inside(self, index: int) -> float:
        """Returns the distance to the left edge of a lane, measured as ``edge`` is for the first lane."""
        return self.edge + sum(self.widths[:index])


def edges_at(profile: Profile, s: float) -> tuple[float, float]:
    """Returns the offsets of ``Profile.edges`` at one station, without the overhead of arrays."""
    centre, (left, right) = width_at(profile.offset, s), profile.carriageway
    return (
        centre + sum(width_at(lane.width, s) for lane in profile.left[:left]),
        centre - sum(width_at(lane.width, s) for lane in profile.right[:right]),
    )


Change = tuple[float, float]
"""A width or an offset in metres at the start and at the end of a road."""


def one_way(
    widths: Sequence[Change], length: float, offset: Change = (0.0, 0.0), between: Marking = "none"
) -> Profile:
    """Returns the cross-section of a road with lanes on the right only, given by their widths from left to
    right. ``offset`` is that of the first lane's left edge, positive to the left of the reference line.
    Widths and offset change smoothly over ``length`` metres. ``between`` is the marking between lanes; the
    outer edges have none."""
    return _one_way(tuple(_changing(each, length) for each in widths), _changing(offset, length), between)


@lru_cache(maxsize=256)
def _one_way(widths: tuple[Width, ...], offset: Width, between: Marking) -> Profile:
    """Returns one Profile for all connecting roads that have the same lanes, since a Profile takes long."""
    marks: list[Marking] = [*[between] * (len(widths) - 1), "none"]
    lanes = tuple(LaneStrip("driving", width, mark) for width, mark in zip(widths, marks, strict=True))
    return Profile((), lanes, 0, "none", offset=offset)


def _changing(change: Change, length: float) -> Width:
    first, last = change
    same = math.isclose(first, last, abs_tol=1e-9)
    return first if same else CubicProfile.smooth([(0.0, first), (length, last)])


def connecting_road(
    start: Point,
    heading: float,
    pieces: Sequence[Piece],
    widths: Sequence[Change],
    offset: Change = (0.0, 0.0),
    between: Marking = "none",
) -> Road:
    """Returns a level connecting road that begins at a point in metres with a heading in radians; for
    ``widths``, ``offset`` and ``between`` see ``one_way``."""
    x, y, z = start
    plan = PieceCurve(x, y, heading, tuple(pieces))
    profile = one_way(widths, plan.length, offset, between)
    return Road(plan, GradeProfile.level(plan.length, z), profile=profile)


USUALLY_FED = 2  # lanes of a road that can be reached by turning only: one lane turns left, one turns right
LaneWay = tuple[tuple[int, int], ...]
"""Pairs of lanes that continue each other, from left to right. The first index is that of the lane into the
junction, the second that of the lane out of the junction; both count from 0 at the centre line."""
NEAREST = 2.0  # m, from the node to a contact
OPPOSITE = math.radians(2.0)  # two arms within this angle of a straight line have no kerb between them


def lane_ways(stubs: Sequence[Stub], start: int) -> Iterator[tuple[int, LaneWay]]:
    """Yields the index of each arm that traffic from the arm ``start`` can reach, with the lanes that lead
    there, for traffic on the right. The stubs are in counter-clockwise order, so the arms are yielded from
    right to left."""
    count = len(stubs)
    others = [(start + n) % count for n in range(1, count)]
    exits = [j for j in others if stubs[start].into and stubs[j].out_of]
    own, inside = stubs[start].turn_lanes, int("left" in stubs[start].turn_lanes)
    for j in [j for j in exits if side_of(_turn(stubs[start], stubs[j])) in own]:
        exits.remove(j)
        is_left = side_of(_turn(stubs[start], stubs[j])) == "left"
        yield j, ((0, 0) if is_left else (len(stubs[start].into) - 1, len(stubs[j].out_of) - 1),)
    if not exits:
        return
    turns = [side_of(_turn(stubs[start], stubs[j])) for j in exits]
    into, room = len(stubs[start].into) - len(own), [len(stubs[j].out_of) for j in exits]
    turns_right = turns[0] == "right" and len(exits) > 1
    turns_left = turns[-1] == "left" and len(exits) > 1
    left, right = _turning_lanes(stubs, exits[-1])[0], _turning_lanes(stubs, exits[0])[1]
    if left + right > into + 1:
        left, right = 1, 1
    spans = _usual_spans(into, room, right if turns_right else 0, left if turns_left else 0)
    if len({n for span in spans for n in span}) < min(into, sum(room)) and len(exits) <= into:
        spans, left = _spans_of_their_own(into, room, turns_right, turns_left), 1
    for n, j in enumerate(exits):
        lanes = spans[n]
        spare = room[n] - len(lanes)
        joining = _joining(stubs, j) if spare and turns[n] == "straight" else set()
        beside = min(left - 1, spare) if turns_left and n < len(exits) - 1 else 0
        if (turns_right and n == 0) or ("left" in joining and "right" not in joining):
            beside = spare  # traffic that turns left to the arm uses the others
        elif spare == 2 and joining >= {"left", "right"}:
            beside = 1  # one lane on each side of these is that of traffic which turns to the arm
        yield j, tuple((inside + i, beside + k) for k, i in enumerate(lanes))


def _joining(stubs: Sequence[Stub], end: int) -> set[Way]:
    return {side_of(_turn(stub, stubs[end])) for n, stub in enumerate(stubs) if n != end and stub.into}


def _turning_lanes(stubs: Sequence[Stub], end: int) -> tuple[int, int]:
    """Returns how many lanes turn left and how many turn right to an arm: one each. Only where the arm has
    more than two lanes and no way leads straight to it, its lanes are divided between both turns, in halves
    if the other arms have lanes enough for that."""
    room = len(stubs[end].out_of)
    if room <= USUALLY_FED:
        return 1, 1
    others = [(side_of(_turn(stub, stubs[end])), len(stub.into)) for n, stub in enumerate(stubs) if n != end]
    if any(side == "straight" and lanes for side, lanes in others):
        return 1, 1
    most = {side: max((n for each, n in others if each == side), default=0) for side in ("left", "right")}
    left = min(max(room - room // 2, room - most["right"]), max(most["left"], 1))
    return left, max(room - left, 1)


def _usual_spans(into: int, room: Sequence[int], turns_right: int, turns_left: int) -> list[range]:
    """Returns the lanes that lead to each exit, where exits may share lanes. ``into`` is the number of lanes
    into the junction, ``room`` those of each exit, from right to left. ``turns_right`` and ``turns_left`` are
    the numbers of lanes that turn to the first and to the last exit."""
    through = len(room) - bool(turns_right) - bool(turns_left)
    left, right = turns_left, turns_right
    if not through:  # those to the left and to the right share all lanes
        left, right = (into - into // 2, into // 2) if max(left, right) <= 1 else (left, right)
        left, right = max(left, into - right, 1), max(right, into - left, 1)
    # each of them shares one lane with the ways between them
    inner, outer = max(left - 1, 0), into - max(right, 1)
    found = []
    for n, most in enumerate(room):
        if turns_right and n == 0:
            found.append(range(into - min(right, most), into))
        elif turns_left and n == len(room) - 1:
            found.append(range(min(left, most)))
        else:
            place = len(room) - 1 - bool(turns_left) - n  # 0 for the leftmost way on
            first, last = (inner + round(k * (outer - inner) / through) for k in (place, place + 1))
            found.append(range(first, min(last + 1, first + most)))
    return found


def _spans_of_their_own(into: int, room: Sequence[int], turns_right: bool, turns_left: bool) -> list[range]:
    """Returns the lanes that lead to each exit, where no lane leads to two exits; see ``_usual_spans``."""
    sizes = [1] * len(room)
    order = range(turns_right, len(room) - turns_left), range(len(room))
    for n in (n for each in order for n in each):
        sizes[n] = min(room[n], sizes[n] + into - sum(sizes))
    found = []
    for n, size in enumerate(sizes):
        first = into - size if turns_right and n == 0 else sum(sizes[n + 1 :])
        found.append(range(first, first + size))
    return found


def _turn(start: Stub, end: Stub) -> float:
    return math.degrees(wrapped(end.direction - start.direction - math.pi))


Mouth = tuple[float, float, float]
"""The heading of an arm out of the junction in radians, and the total width in metres of its lanes that lead
into the junction and of those that lead out of it."""


def setbacks(mouths: Sequence[Mouth], kerb: float) -> list[float]:
    """Returns the distance in metres from the node to the contact of each arm, at least ``NEAREST``. The arms
    are given counter-clockwise; ``kerb`` is the smallest radius in metres of a kerb between two of them."""
    found = [NEAREST] * len(mouths)
    for i, (direction, width_in, _) in enumerate(mouths):
        j = (i + 1) % len(mouths)
        to, _, width_out = mouths[j]
        gap = (to - direction) % (2 * math.pi)
        if gap >= math.pi - OPPOSITE:
            continue
        # traffic that turns right here keeps to the kerb, at most these widths from the reference line
        tangent = (kerb + max(width_in, width_out)) * tangent_length(math.pi - gap)
        for arm, own, theirs in ((i, width_out, width_in), (j, width_in, width_out)):
            clear = (own + theirs * math.cos(gap)) / math.sin(gap)
            found[arm] = max(found[arm], tangent, clear)
    return found


def connected(
    builder: Builder,
    junction: int,
    node: Point,
    ends: tuple[Stub, Stub],
    distances: tuple[float, float],
    way: LaneWay,
    between: Marking = "none",
) -> Connection:
    """Adds a connecting road from one arm to another; returns the connection. The reference lines of the two
    ``ends`` meet at ``node``, which lies ``distances`` metres from their contacts. ``way`` has at least one
    pair of lanes, ``between`` is the marking between two lanes."""
    start, end = ends
    heading = start.direction + math.pi
    turn = wrapped(end.direction - heading)
    contact = NetworkPose(node, start.direction).ahead(distances[0]).point
    pieces = curve_between(*distances, turn if abs(turn) >= STRAIGHT else 0.0)
    widths = [(start.into.widths[i], end.out_of.widths[j]) for i, j in way]
    first_in, first_out = way[0]
    offset = (-start.into.inside(first_in), -end.out_of.inside(first_out))
    road = builder.add(connecting_road(contact, heading, pieces, widths, offset, between), junction)
    lanes = tuple(LaneLink(start.into.ids[i], -1 - n, end.out_of.ids[j]) for n, (i, j) in enumerate(way))
    return Connection(road, start.end, end.end, lanes)


WIDTH = 5.0  # m, of the circulatory roadway with one lane
WIDTH_OF_TWO = 9.0  # m, of a circulatory roadway with two lanes
MOST_LANES = 2
NARROW_WIDTH = 4.5  # m, of the circulatory roadway of a mini roundabout
MINI = 8.0  # m, largest radius of the island of a mini roundabout, with an outer diameter of 25 m
MOUTH = 9.5  # m along the ring, from the middle of a mouth to either end
SMALLEST_MOUTH = 4.4  # m; with a shorter one, kerbs between the arms have radii below 3 m
BETWEEN = 2.0  # m along the ring, between two mouths
ALONE = 2 * math.pi / 3  # rad, of the ring for the mouth of the only arm: as of one of three
APPROACH = 9.0  # m, from the outer edge of the ring to the contact of an arm


def ring_width(radius: float, lanes: int = 1) -> float:
    """Returns the width in metres of the circulatory roadway around an island of this radius in metres."""
    if lanes > 1:
        return WIDTH_OF_TWO
    return NARROW_WIDTH if radius <= MINI else WIDTH


def contact_distance(radius: float, lanes: int) -> float:
    """Returns the distance in metres from the centre of a roundabout to the contacts of its arms."""
    return radius + ring_width(radius, lanes) + APPROACH


def mouth_of(radius: float, directions: Sequence[float]) -> float:
    """Returns half the length in metres of every mouth along the edge of the island: at most ``MOUTH``, and
    so short that ``BETWEEN`` metres of ring remain between mouths; ``directions`` as in ``smallest_radius``.
    """
    return min(MOUTH, (radius * _least_gap(directions) - BETWEEN) / 2)


def smallest_radius(directions: Sequence[float]) -> float:
    """Returns the smallest radius in metres of an island around which the mouths of all arms fit.
    ``directions`` are those of the arms out of the centre in radians, counter-clockwise."""
    return (2 * SMALLEST_MOUTH + BETWEEN) / _least_gap(directions)


def _least_gap(directions: Sequence[float]) -> float:
    return min((b - a) % (2 * math.pi) for a, b in pairwise([*directions, directions[0]])) or ALONE


def around_length(radius: float, directions: Sequence[float], angle: float, lanes: int) -> float:
    """Returns the length in metres of a way through a roundabout, from contact to contact. ``directions`` are
    as in ``smallest_radius``. ``angle`` is the angle in radians, counter-clockwise, from the arm of arrival
    to the arm that is taken; 2 pi for the way back."""
    half = mouth_of(radius, directions) / radius
    tangents = contact_distance(radius, lanes) - radius / math.cos(half), radius * math.tan(half)
    ramp = sum(piece.length for piece in curve_between(*tangents, half - math.pi / 2))
    return 2 * ramp + radius * (angle - 2 * half)


def build_roundabout(
    builder: Builder,
    design: JunctionDesign,
    centre: Point,
    stubs: Sequence[Stub],
    controls: Sequence[Control],
) -> Roundabout:
    """Adds a roundabout to a network that has the roads of all stubs; returns the roundabout. Its radius is
    at least ``smallest_radius``, each stub ends ``contact_distance`` from the centre, and its kerb is only
    stored. Raises UsageError if a road has more lanes in one direction than the ring."""
    radius, lanes = design.radius, design.ring_lanes
    if any(max(len(stub.into), len(stub.out_of)) > lanes for stub in stubs):
        said = "one lane" if lanes == 1 else f"{lanes} lanes"
        raise UsageError(
            f"a roundabout with {said} joins roads with {said} in each direction, and a road has more; "
            "change one of them"
        )
    directions = [stub.direction for stub in stubs]
    half = mouth_of(radius, directions) / radius
    numbers, ring = [builder.number() for _ in stubs], list[int]()
    found = Roundabout(tuple(numbers), (), centre, radius, ring_width(radius, lanes))
    for one, two in pairwise([*directions, directions[0]]):  # from the mouth of each arm to the next mouth
        gap = (two - one) % (2 * math.pi) or 2 * math.pi
        ring.append(builder.add(_arc(found, one + half, gap - 2 * half, lanes, "broken")))
    found = replace(found, ring=tuple(ring))
    for i, stub in enumerate(stubs):
        before, after = RoadEnd(ring[i - 1], "end"), RoadEnd(ring[i], "start")
        connections = _mouth(builder, found, numbers[i], stub, (before, after), half, lanes)
        arms = (
            Arm(stub.end, stub.direction, controls[i], design.crosswalk),
            Arm(after, stub.direction + half + math.pi / 2),
            Arm(before, stub.direction - half - math.pi / 2),
        )
        builder.junctions.append(Junction(numbers[i], "roundabout", arms, connections, centre, design.kerb))
    builder.roundabouts.append(found)
    return found


def _arc(ring: Roundabout, start: float, angle: float, lanes: int, between: Marking = "none") -> Road:
    piece, width = Piece(angle * ring.radius, 1 / ring.radius, 1 / ring.radius), ring.width / lanes
    begin = NetworkPose(ring.centre, start).ahead(ring.radius).point
    return connecting_road(begin, start + math.pi / 2, [piece], [(width, width)] * lanes, between=between)


def _mouth(
    builder: Builder,
    ring: Roundabout,
    junction: int,
    stub: Stub,
    ends: tuple[RoadEnd, RoadEnd],
    half: float,
    lanes: int,
) -> tuple[Connection, ...]:
    before, after = ends
    at, turn = stub.direction, math.pi / 2 - half
    # the reference line of the arm and the tangent of the ring at an end of the mouth meet here
    meeting = ring.radius / math.cos(half)
    far, each = contact_distance(ring.radius, lanes), ring.width / lanes
    to_ring, to_arm = ring.radius * math.tan(half), far - meeting
    along = builder.add(_arc(ring, at - half, 2 * half, lanes), junction)
    links = tuple(LaneLink(n, n, n) for n in range(-1, -1 - lanes, -1))
    made = [Connection(along, before, after, links)]
    if stub.out_of:
        start = NetworkPose(ring.centre, at - half).ahead(ring.radius).point
        pieces = curve_between(to_ring, to_arm, -turn)
        count = len(stub.out_of)
        widths = [(each, width) for width in stub.out_of.widths]
        offset = (-(lanes - count) * each, -stub.out_of.edge)
        off = connecting_road(start, at - half + math.pi / 2, pieces, widths, offset)
        links = tuple(LaneLink(n - lanes, -1 - k, stub.out_of.ids[k]) for k, n in _outermost(count))
        made.append(Connection(builder.add(off, junction), before, stub.end, links))
    if stub.into:
        start = NetworkPose(ring.centre, at).ahead(far).point
        pieces = curve_between(to_arm, to_ring, -turn)
        count = len(stub.into)
        widths = [(width, each) for width in stub.into.widths]
        offset = (-stub.into.edge, -(lanes - count) * each)
        onto = connecting_road(start, at + math.pi, pieces, widths, offset)
        links = tuple(LaneLink(stub.into.ids[k], -1 - k, n - lanes) for k, n in _outermost(count))
        made.append(Connection(builder.add(onto, junction), stub.end, after, links))
    return tuple(made)


def _outermost(count: int) -> list[tuple[int, int]]:
    """Returns, for each of ``count`` lanes of a road, its index and the number of ring lanes outside the ring
    lane that continues it."""
    return [(k, count - 1 - k) for k in range(count)]


ANGLE = math.radians(8.0)  # between the ramp and the main road
CONTACT = 25.0  # m, from the node to each contact, where a road ends and the junction begins
BESIDE = 60.0  # m, length of the road that the route does not take
FAR = 1e6  # m, a station behind all changes of a cross-section


def length_beside(ramp: RampDesign) -> float:
    """Returns the length in metres of the road with the additional lane, its taper included."""
    return ramp.length + ramp.taper


def length_at_ramp(ramp: RampDesign) -> float:
    """Returns the length in metres of a route in the junction and on the road with the additional lane."""
    turn = ANGLE if ramp.take == "ramp" else 0.0
    return sum(piece.length for piece in curve_between(CONTACT, CONTACT, turn)) + length_beside(ramp)


def lines_at_ramp(ramp: RampDesign) -> tuple[list[complex], list[complex]]:
    """Returns sketches of the route at a ramp, and of the road that the route does not take: lists of points
    x + iy in metres. The route begins at the origin and leads along +x; the last two points of its sketch
    give the direction in which it goes on."""
    length, is_merge, by_ramp = length_beside(ramp), ramp.kind == "merge", ramp.take == "ramp"
    node = CONTACT if is_merge else length + CONTACT
    turned = cmath.exp(-1j * ANGLE)
    ahead = turned if by_ramp else complex(1.0)
    if is_merge:
        other = -1.0 * (turned if by_ramp else cmath.exp(1j * ANGLE))
    else:
        other = complex(1.0) if by_ramp else turned
    if ramp.is_on_left:
        ahead, other = ahead.conjugate(), other.conjugate()
    behind = CONTACT + (length if is_merge else 0.0)
    on_route = list[complex]()
    for start, way, far in ((0.0, complex(1.0), node), (node, ahead, behind)):
        count = max(1, int(far / 4.0))
        on_route += [start + way * far * n / count for n in range(count)]
    beside = [node + other * far for far in (CONTACT, CONTACT + BESIDE / 2, CONTACT + BESIDE)]
    return [*on_route, node + behind * ahead], beside


@dataclass
class RampBuilder:
    """Adds one merge or exit to a network, and also the road there that the route does not take."""

    builder: Builder
    ramp: RampDesign
    arrival: int  # the id of the road on which the route arrives
    end: NetworkPose  # the pose at the end of the road on which the route arrives
    before: Profile  # the cross-section of the road on which the route arrives
    after: Profile  # the cross-section of the road on which the route goes on

    def where_it_goes_on(self) -> NetworkPose:
        """Returns the pose at the start of the road on which the route goes on."""
        by_ramp, length = self.ramp.take == "ramp", length_beside(self.ramp)
        if self.ramp.kind == "merge":
            return self._node.ahead(CONTACT + length)
        turned = NetworkPose(self._node.point, self.end.heading - self._angle) if by_ramp else self._node
        return turned.ahead(CONTACT)

    @property
    def _angle(self) -> float:
        """The angle in radians by which traffic turns right, from the ramp at a merge or onto the ramp at an
        exit; negative for a ramp on the left."""
        return -ANGLE if self.ramp.is_on_left else ANGLE

    @property
    def _node(self) -> NetworkPose:
        by_ramp = self.ramp.take == "ramp"
        if self.ramp.kind == "merge":
            return self.end.ahead(CONTACT, -self._angle if by_ramp else 0.0)
        return self.end.ahead(length_beside(self.ramp) + CONTACT)

    def build(self, going_on: int) -> list[int]:
        """Builds the merge or exit; returns the ids of its roads on the route, in driving order. ``going_on``
        is the id of the road on which the route goes on, which begins at ``where_it_goes_on``."""
        is_merge, is_left, by_ramp = self.ramp.kind == "merge", self.ramp.is_on_left, self.ramp.take == "ramp"
        node, length = self._node, length_beside(self.ramp)
        profile = _constant(self.after, 0.0) if is_merge else _constant(self.before, FAR)
        width = _width(profile)
        falling = [(0.0, width), (self.ramp.length, width), (length, 0.0)]
        lane = CubicProfile.smooth(falling if is_merge else [(0.0, 0.0), (self.ramp.taper, width)])
        start = node.ahead(CONTACT) if is_merge else self.end
        beside = self._straight(start, length, _with_lane(profile, lane, is_left))
        self._continue(*((beside, going_on) if is_merge else (self.arrival, beside)))
        other = self._not_taken(profile, -CONTACT - BESIDE if is_merge else CONTACT)
        on_route = self.arrival if is_merge else going_on
        numbers = (other, on_route) if by_ramp else (on_route, other)
        main, ramp = (self._stub(each, "end" if is_merge else "start") for each in numbers)
        wide = self._stub(beside, "start" if is_merge else "end")
        # the additional lane, and those of the main road beside it
        count = len(main.into if is_merge else main.out_of)
        own, lanes = (0, range(1, count + 1)) if is_left else (count, range(count))
        junction = self.builder.number()
        if is_merge:
            back = wide, main
            ways = [self._way(junction, main, wide, [*enumerate(lanes)])]
            ways.append(self._way(junction, ramp, wide, [(0, own)]))
        else:
            back = main, wide
            ways = [self._way(junction, wide, main, [(lane, n) for n, lane in enumerate(lanes)])]
            ways.append(self._way(junction, wide, ramp, [(own, 0)]))
        pairs = [(n, n) for n in range(min(len(back[0].into), len(back[1].out_of)))]
        ways += [self._way(junction, *back, pairs)] if pairs else []
        stubs = wide, *((main, ramp) if is_merge != is_left else (ramp, main))
        arms = tuple(Arm(stub.end, stub.direction) for stub in stubs)
        made = Junction(junction, self.ramp.kind, arms, tuple(ways), node.point, 0.0)
        self.builder.junctions.append(made)
        taken = ways[1 if by_ramp else 0].road
        return [taken, beside] if is_merge else [beside, taken]

    def _straight(self, start: NetworkPose, length: float, profile: Profile) -> int:
        segment = Segment(distance=length, direction="straight")
        return self.builder.add(road_of((segment,), *start, profile, (True, True)))

    def _continue(self, before: int, after: int) -> None:
        profiles = [self.builder.roads[each].profile for each in (before, after)]
        forward = min(each.count[0] for each in profiles)
        left = zip(*(each.against_ids for each in profiles), strict=False)
        # an additional lane on the left is the first one
        first, second = (each.count[0] - forward if self.ramp.is_on_left else 0 for each in profiles)
        lanes = (*((-n - first, -n - second) for n in range(1, forward + 1)), *((a, b) for a, b in left))
        self.builder.continuations.append(
            Continuation(RoadEnd(before, "end"), RoadEnd(after, "start"), lanes)
        )

    def _stub(self, road: int, contact: Contact) -> Stub:
        member = self.builder.roads[road].road
        at_end = contact == "end"
        heading = float(member.heading(member.length if at_end else 0.0)) + (math.pi if at_end else 0.0)
        return self.builder.stub(RoadEnd(road, contact), heading)

    def _way(self, junction: int, start: Stub, end: Stub, lanes: Sequence[tuple[int, int]]) -> Connection:
        """Adds a connecting road for pairs of lanes, counted from 0 at the line between the directions. The
        broken lines between the lanes go on in the junction, because traffic hardly turns there."""
        far = (CONTACT, CONTACT)
        return connected(self.builder, junction, self._node.point, (start, end), far, tuple(lanes), "broken")

    def _not_taken(self, main: Profile, ahead: float) -> int:
        """Adds the main road or the ramp, whichever the route does not take; it begins ``ahead`` metres from
        the node. Such a ramp has one lane beside the main road, whose cross-section is given."""
        node = self._node
        if self.ramp.take == "ramp":
            return self._straight(node.ahead(ahead), BESIDE, main)
        width = _width(main)
        offset = width_at(main.offset, 0.0) + width if self.ramp.is_on_left else float(main.edges(0.0).right)
        profile = replace(Profile.of(1, 0, width, main.shoulder_width), offset=offset)
        turn = self._angle if self.ramp.kind == "merge" else -self._angle
        return self._straight(NetworkPose(node.point, node.heading + turn).ahead(ahead), BESIDE, profile)


TURN_TAPER = 8.0  # m of taper for each metre of a turn lane's width: AASHTO 2018, section 9.7, low speeds


def length_of_turn_lanes(place: PlaceDesign, width: float) -> float:
    """Returns the length in metres of the turn lanes of a place with their taper, 0 if it has none, on a road
    with lanes of a width in metres."""
    if not isinstance(place, JunctionDesign) or not place.turn_lanes:
        return 0.0
    return place.turn_length + TURN_TAPER * width


def with_turn_lanes(profile: Profile, junction: JunctionDesign) -> Profile:
    """Returns the cross-section of the last part of a road of arrival, along which its turn lanes become as
    wide as its other lanes. A turn lane on the right lies outside them. One on the left lies inside them, and
    moves the oncoming lanes to the left, so that the others lead on as before."""
    if not junction.turn_lanes:
        return profile
    found = _constant(profile, FAR)
    width = _width(found)
    lane = CubicProfile.smooth([(0.0, 0.0), (TURN_TAPER * width, width)])
    for side in junction.turn_lanes:
        found = _with_lane(found, lane, side == "left")
    return replace(found, centre_marking="solid") if found.centre_marking == "broken" else found


ISLAND_WIDTH = 2.0  # m, at a crosswalk: for persons to wait, at least (RASt 06, section 6.1.8)
ISLAND_LENGTH = 8.0  # m before and behind the end of the road at which the crosswalk is
ISLAND_TAPER = 29.0  # m, in which the lanes move aside by half of that: V sqrt(i / 3) at 50 km/h (RAS-K-1)


def with_island(profile: Profile, at_end: bool) -> Profile:
    """Returns the cross-section of the part of a road before or behind a crosswalk with an island: a median
    from which both directions move away."""
    wide, long = ISLAND_WIDTH, ISLAND_LENGTH
    to, off = [(0.0, 0.0), (ISLAND_TAPER, wide)], [(0.0, wide), (long, wide), (long + ISLAND_TAPER, 0.0)]
    width = CubicProfile.smooth(to if at_end else off)
    found = _constant(profile, FAR if at_end else 0.0)
    offset = added([(1, found.offset), (-0.5, width)], FAR)
    left = (LaneStrip("median", width, "solid"), *found.left)
    return replace(found, left=left, offset=offset, centre_marking="solid")


def _constant(profile: Profile, s: float) -> Profile:
    left, right = (
        tuple(replace(lane, width=width_at(lane.width, s)) for lane in side)
        for side in (profile.left, profile.right)
    )
    return replace(profile, left=left, right=right, offset=width_at(profile.offset, s))


def _width(profile: Profile) -> float:
    return width_at(profile.right[profile.count[0] - 1].width, 0.0)


def _with_lane(profile: Profile, width: CubicProfile, is_left: bool) -> Profile:
    """Returns the cross-section with one more lane, outside all lanes on the right or, if ``is_left``, inside
    them. The lane inside moves the line between the directions to the left."""
    if is_left:
        lane = LaneStrip("driving", width, "broken")
        offset = added([(1, profile.offset), (1, width)], FAR)
        return replace(profile, right=(lane, *profile.right), offset=offset)
    count = profile.count[0]
    outer = profile.right[count - 1]
    inner = [*profile.right[: count - 1], replace(outer, marking="broken")]
    return replace(profile, right=(*inner, replace(outer, width=width), *profile.right[count:]))
