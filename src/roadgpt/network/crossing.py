"""Builds junctions whose arms meet at one point: T- and Y-junctions, crossroads and stars.

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

- If a lane would then lead to no arm, the lanes are divided so that no lane leads to two arms.
- If an arm has more than two lanes and no arm leads straight on to it, several lanes turn to it side by side.

The ways from one arm never cross each other."""

import math
from collections.abc import Iterator, Sequence

from roadgpt.brief.junctions import Control, Way, side_of
from roadgpt.geometry.curve import wrapped
from roadgpt.network.building import Builder, Stub, connecting_road
from roadgpt.network.network import Arm, Connection, Junction, Kind, LaneLink
from roadgpt.network.pose import STRAIGHT, curve_between, tangent_length
from roadgpt.road.profile import Marking

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
    if not exits:
        return
    turns = [side_of(_turn(stubs[start], stubs[j])) for j in exits]
    into, room = len(stubs[start].into), [len(stubs[j].out_of) for j in exits]
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
        yield j, tuple((i, beside + k) for k, i in enumerate(lanes))


def _joining(stubs: Sequence[Stub], end: int) -> set[Way]:
    """Returns the ways that lead to an arm from the others."""
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


def build_crossing(
    builder: Builder,
    kind: Kind,
    node: tuple[float, float, float],
    stubs: Sequence[Stub],
    distances: Sequence[float],
    controls: Sequence[Control],
    kerb: float,
    crosswalk: bool = False,
) -> Junction:
    """Adds a junction and its connecting roads to a network that has the roads of all stubs; returns it.

    ``node`` is the point in metres at which the reference lines would meet. ``distances`` are those in metres
    from the node to the contacts of the stubs. All sequences are in counter-clockwise order. ``kerb`` is the
    requested radius in metres, which is only stored: ``distances`` decide how much room there is."""
    number = builder.number()
    connections = []
    for i in range(len(stubs)):
        for j, way in lane_ways(stubs, i):
            ends, far = (stubs[i], stubs[j]), (distances[i], distances[j])
            connections.append(connected(builder, number, node, ends, far, way))
    arms = tuple(
        Arm(stub.end, stub.direction, control, crosswalk)
        for stub, control in zip(stubs, controls, strict=True)
    )
    junction = Junction(number, kind, arms, tuple(connections), node, kerb)
    builder.junctions.append(junction)
    return junction


def connected(
    builder: Builder,
    junction: int,
    node: tuple[float, float, float],
    ends: tuple[Stub, Stub],
    distances: tuple[float, float],
    way: LaneWay,
    between: Marking = "none",
) -> Connection:
    """Adds a connecting road from one arm to another; returns the connection. The reference lines of the two
    ``ends`` meet at ``node``, which lies ``distances`` metres from their contacts. ``way`` has at least one
    pair of lanes, ``between`` is the marking between two lanes."""
    start, end = ends
    x, y, z = node
    heading = start.direction + math.pi
    turn = wrapped(end.direction - heading)
    contact = (
        x + distances[0] * math.cos(start.direction),
        y + distances[0] * math.sin(start.direction),
        z,
    )
    pieces = curve_between(*distances, turn if abs(turn) >= STRAIGHT else 0.0)
    widths = [(start.into.widths[i], end.out_of.widths[j]) for i, j in way]
    first_in, first_out = way[0]
    offset = (-start.into.inside(first_in), -end.out_of.inside(first_out))
    road = builder.add(connecting_road(contact, heading, pieces, widths, offset, between), junction)
    lanes = tuple(LaneLink(start.into.ids[i], -1 - n, end.out_of.ids[j]) for n, (i, j) in enumerate(way))
    return Connection(road, start.end, end.end, lanes)
