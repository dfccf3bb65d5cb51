"""Builds roundabouts with one or two lanes, for traffic on the right.

The reference line of the ring is the edge of the central island; the ring is driven counter-clockwise, with
its lanes on the right of this line. A road with one lane joins the outer lane of the ring. Each arm leads
towards the centre and has a junction of its own, its mouth: the part of the ring at the arm. Through a mouth,
one connecting road leads along the ring, one from the ring to the arm, and one from the arm to the ring."""

import math
from collections.abc import Sequence
from itertools import pairwise

from roadgpt.brief.junctions import Control
from roadgpt.errors import UsageError
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.network.building import Builder, Stub, connecting_road, one_way
from roadgpt.network.network import Arm, Connection, Junction, LaneLink, RoadEnd, Roundabout
from roadgpt.network.pose import curve_between
from roadgpt.road import Road
from roadgpt.road.profile import Marking

WIDTH = 5.0  # m, of the circulatory roadway with one lane
WIDTH_OF_TWO = 9.0  # m, of a circulatory roadway with two lanes
MOST_LANES = 2
NARROW_WIDTH = 4.5  # m, of the circulatory roadway of a mini roundabout
MINI = 8.0  # m, largest radius of the island of a mini roundabout, with an outer diameter of 25 m
MOUTH = 9.5  # m along the ring, from the middle of a mouth to either end
SMALLEST_MOUTH = 4.4  # m; with a shorter one, kerbs between the arms have radii below 3 m
BETWEEN = 2.0  # m along the ring, between two mouths
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
    """Returns the least angle in radians between two neighbouring arms."""
    return min((b - a) % (2 * math.pi) for a, b in pairwise([*directions, directions[0]]))


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
    centre: tuple[float, float, float],
    radius: float,
    stubs: Sequence[Stub],
    controls: Sequence[Control],
    kerb: float,
    lanes: int = 1,
    crosswalk: bool = False,
) -> Roundabout:
    """Adds a roundabout to a network that has the roads of all stubs; returns the roundabout.

    The ``centre`` and the ``radius`` of the island, at least ``smallest_radius``, are in metres. The stubs
    are in counter-clockwise order, and so are their signs or lights; each ends ``contact_distance`` from the
    centre. ``kerb`` is the requested radius in metres, which is only stored. Raises UsageError if a road has
    more lanes in one direction than the ring."""
    if any(max(len(stub.into), len(stub.out_of)) > lanes for stub in stubs):
        said = "one lane" if lanes == 1 else f"{lanes} lanes"
        raise UsageError(
            f"a roundabout with {said} joins roads with {said} in each direction, and a road has more; "
            "change one of them"
        )
    directions = [stub.direction for stub in stubs]
    width, half = ring_width(radius, lanes), mouth_of(radius, directions) / radius
    count = len(stubs)
    numbers = [builder.number() for _ in stubs]
    ring = []
    for i in range(count):  # from the mouth of arm i to the next mouth
        gap = (directions[(i + 1) % count] - directions[i]) % (2 * math.pi)
        ring.append(
            builder.add(_arc(centre, radius, directions[i] + half, gap - 2 * half, width, lanes, "broken"))
        )
    found = Roundabout(tuple(numbers), tuple(ring), centre, radius, width)
    for i, stub in enumerate(stubs):
        before, after = RoadEnd(ring[i - 1], "end"), RoadEnd(ring[i], "start")
        connections = _mouth(builder, found, numbers[i], stub, (before, after), half, lanes)
        arms = (
            Arm(stub.end, stub.direction, controls[i], crosswalk),
            Arm(after, stub.direction + half + math.pi / 2),
            Arm(before, stub.direction - half - math.pi / 2),
        )
        builder.junctions.append(Junction(numbers[i], "roundabout", arms, connections, centre, kerb))
    builder.roundabouts.append(found)
    return found


def _arc(
    centre: tuple[float, float, float],
    radius: float,
    start: float,
    angle: float,
    width: float,
    lanes: int,
    between: Marking = "none",
) -> Road:
    """Returns a piece of the ring from direction ``start`` through ``angle``, both in radians."""
    x, y, z = centre
    plan = PieceCurve(
        x + radius * math.cos(start),
        y + radius * math.sin(start),
        start + math.pi / 2,
        (Piece(angle * radius, 1 / radius, 1 / radius),),
    )
    profile = one_way([(width / lanes, width / lanes)] * lanes, plan.length, between=between)
    return Road(plan, GradeProfile.level(plan.length, z), profile=profile)


def _mouth(
    builder: Builder,
    ring: Roundabout,
    junction: int,
    stub: Stub,
    ends: tuple[RoadEnd, RoadEnd],
    half: float,
    lanes: int,
) -> tuple[Connection, ...]:
    """Adds the connecting roads of one mouth: along the ring, off the ring, and onto the ring."""
    before, after = ends
    x, y, z = ring.centre
    at, turn = stub.direction, math.pi / 2 - half
    # the reference line of the arm and the tangent of the ring at an end of the mouth meet here
    meeting = ring.radius / math.cos(half)
    far, each = contact_distance(ring.radius, lanes), ring.width / lanes
    to_ring, to_arm = ring.radius * math.tan(half), far - meeting
    along = builder.add(_arc(ring.centre, ring.radius, at - half, 2 * half, ring.width, lanes), junction)
    links = tuple(LaneLink(n, n, n) for n in range(-1, -1 - lanes, -1))
    made = [Connection(along, before, after, links)]
    if stub.out_of:
        start = (x + ring.radius * math.cos(at - half), y + ring.radius * math.sin(at - half), z)
        pieces = curve_between(to_ring, to_arm, -turn)
        count = len(stub.out_of)
        widths = [(each, width) for width in stub.out_of.widths]
        offset = (-(lanes - count) * each, -stub.out_of.edge)
        off = connecting_road(start, at - half + math.pi / 2, pieces, widths, offset)
        links = tuple(LaneLink(n - lanes, -1 - k, stub.out_of.ids[k]) for k, n in _outermost(count))
        made.append(Connection(builder.add(off, junction), before, stub.end, links))
    if stub.into:
        start = (x + far * math.cos(at), y + far * math.sin(at), z)
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
