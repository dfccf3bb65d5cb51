"""Builds merges and exits: ramps that join or leave a main road, with an additional lane of this road.

    main road  -----------+--------------------------------------
    ramp  ----------------'  node | lane for acceleration | taper

The reference lines of the main road and of the ramp meet at the node. Behind a merge, the main road has an
additional lane that ends in a taper; before an exit, it has one that begins in a taper. Traffic drives on the
right. A ramp on the left joins the innermost lanes, beside the median."""

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from roadgpt.geometry import CubicProfile
from roadgpt.network.building import Builder, Stub, width_at
from roadgpt.network.crossing import connected
from roadgpt.network.design import RampDesign
from roadgpt.network.lane_along import added
from roadgpt.network.network import Arm, Connection, Contact, Continuation, Junction, RoadEnd
from roadgpt.network.pose import NetworkPose, curve_between
from roadgpt.network.stretch import road_of
from roadgpt.road import Profile, Segment
from roadgpt.road.profile import Lane

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
    ahead = cmath.exp(-1j * ANGLE) if by_ramp else complex(1.0)
    other = complex(-1.0 if is_merge else 1.0)
    if is_merge:
        other *= cmath.exp(-1j * ANGLE) if by_ramp else cmath.exp(1j * ANGLE)
    elif not by_ramp:
        other *= cmath.exp(-1j * ANGLE)
    if ramp.is_on_left:
        ahead, other = ahead.conjugate(), other.conjugate()
    behind = CONTACT + (length if is_merge else 0.0)
    on_route = [*_steps(0.0, 1.0, node), *_steps(node, ahead, behind), node + behind * ahead]
    return on_route, [node + other * d for d in (CONTACT, CONTACT + BESIDE / 2, CONTACT + BESIDE)]


def _steps(start: complex, way: complex, length: float) -> list[complex]:
    count = max(1, int(length / 4.0))
    return [start + way * length * n / count for n in range(count)]


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
        return self._merge(going_on) if self.ramp.kind == "merge" else self._exit(going_on)

    def _merge(self, going_on: int) -> list[int]:
        by_ramp, node = self.ramp.take == "ramp", self._node
        after = _constant(self.after, 0.0)
        width = _width(after)
        length, full = length_beside(self.ramp), self.ramp.length
        lane = CubicProfile.smooth([(0.0, width), (full, width), (length, 0.0)])
        beside = self._straight(node.ahead(CONTACT), length, _with_lane(after, lane, self.ramp.is_on_left))
        self._continue(beside, going_on)
        other = self._not_taken(after, -CONTACT - BESIDE)
        main, ramp = (other, self.arrival) if by_ramp else (self.arrival, other)
        junction = self.builder.number()
        stubs = [self._stub(main, "end"), self._stub(ramp, "end"), self._stub(beside, "start")]
        own, lanes = self._lanes_beside(len(stubs[0].into))
        ways = [
            self._way(junction, stubs[0], stubs[2], list(enumerate(lanes))),
            self._way(junction, stubs[1], stubs[2], [(0, own)]),
            *self._back(junction, stubs[2], stubs[0]),
        ]
        self._close(junction, stubs[2], *(stubs[1::-1] if self.ramp.is_on_left else stubs[:2]), ways=ways)
        return [ways[1 if by_ramp else 0].road, beside]

    def _exit(self, going_on: int) -> list[int]:
        by_ramp = self.ramp.take == "ramp"
        before, length = _constant(self.before, FAR), length_beside(self.ramp)
        lane = CubicProfile.smooth([(0.0, 0.0), (self.ramp.taper, _width(before))])
        beside = self._straight(self.end, length, _with_lane(before, lane, self.ramp.is_on_left))
        self._continue(self.arrival, beside)
        other = self._not_taken(before, CONTACT)
        main, ramp = (other, going_on) if by_ramp else (going_on, other)
        junction = self.builder.number()
        stubs = [self._stub(beside, "end"), self._stub(ramp, "start"), self._stub(main, "start")]
        own, lanes = self._lanes_beside(len(stubs[2].out_of))
        ways = [
            self._way(junction, stubs[0], stubs[2], [(lane, n) for n, lane in enumerate(lanes)]),
            self._way(junction, stubs[0], stubs[1], [(own, 0)]),
            *self._back(junction, stubs[2], stubs[0]),
        ]
        self._close(junction, stubs[0], *(stubs[:0:-1] if self.ramp.is_on_left else stubs[1:]), ways=ways)
        return [beside, ways[1 if by_ramp else 0].road]

    def _lanes_beside(self, count: int) -> tuple[int, range]:
        """Returns the index of the additional lane, and those of the ``count`` lanes of the main road, beside
        each other."""
        return (0, range(1, count + 1)) if self.ramp.is_on_left else (count, range(count))

    def _straight(self, start: NetworkPose, length: float, profile: Profile) -> int:
        segment = Segment(distance=length, direction="straight")
        return self.builder.add(road_of((segment,), *start, profile, (True, True)))

    def _continue(self, before: int, after: int) -> None:
        """Lets the lanes that two roads have in common continue each other."""
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

    def _back(self, junction: int, start: Stub, end: Stub) -> list[Connection]:
        """Adds the connection for oncoming traffic, if there is any."""
        lanes = [(n, n) for n in range(min(len(start.into), len(end.out_of)))]
        return [self._way(junction, start, end, lanes)] if lanes else []

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

    def _close(self, number: int, *stubs: Stub, ways: Sequence[Connection]) -> None:
        """Adds the junction; ``stubs`` are its arms in counter-clockwise order."""
        arms = tuple(Arm(stub.end, stub.direction) for stub in stubs)
        made = Junction(number, self.ramp.kind, arms, tuple(ways), self._node.point, 0.0)
        self.builder.junctions.append(made)


def _constant(profile: Profile, s: float) -> Profile:
    """Returns the cross-section at a station in metres, as one that is the same along the whole road."""
    left, right = (
        tuple(replace(lane, width=width_at(lane.width, s)) for lane in side)
        for side in (profile.left, profile.right)
    )
    return replace(profile, left=left, right=right, offset=width_at(profile.offset, s))


def _width(profile: Profile) -> float:
    """Returns the width in metres of the rightmost lane, at the start of the road."""
    return width_at(profile.right[profile.count[0] - 1].width, 0.0)


def _with_lane(profile: Profile, width: CubicProfile, is_left: bool) -> Profile:
    """Returns the cross-section with one more lane, outside all lanes on the right or, if ``is_left``, inside
    them. The lane inside moves the line between the directions to the left."""
    if is_left:
        lane = Lane("driving", width, "broken")
        offset = added([(1, profile.offset), (1, width)], FAR)
        return replace(profile, right=(lane, *profile.right), offset=offset)
    count = profile.count[0]
    outer = profile.right[count - 1]
    inner = [*profile.right[: count - 1], replace(outer, marking="broken")]
    return replace(profile, right=(*inner, replace(outer, width=width), *profile.right[count:]))
