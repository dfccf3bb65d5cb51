"""Builds junctions whose arms meet at one point: T- and Y-junctions, crossroads and stars.

The node is the point at which the reference lines of all arms meet. Each arm ends at a contact before the
node, so far away that the kerbs to both neighbouring arms have room. A connecting road leads from one contact
to another: its reference line consists of lines, an arc and clothoids, and begins and ends on the reference
lines of the two arms.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from roadgpt.brief.junctions import Control
from roadgpt.geometry.curve import wrapped
from roadgpt.network.building import Builder, Stub, connecting_road
from roadgpt.network.crossing_lanes import LaneWay, lane_ways
from roadgpt.network.network import Arm, Connection, Junction, Kind, LaneLink
from roadgpt.network.turning import STRAIGHT, curve_between, tangent_length
from roadgpt.road.profile import Marking

NEAREST = 2.0  # m, from the node to a contact
OPPOSITE = math.radians(2.0)  # two arms within this angle of a straight line have no kerb between them


@dataclass(frozen=True)
class Mouth:
    """The direction and the widths of an arm, from which a junction is laid out."""

    direction: float
    """The heading in radians out of the junction."""
    width_in: float
    """Total width in metres of all lanes that lead into the junction."""
    width_out: float
    """Total width in metres of all lanes that lead out of the junction."""


def setbacks(mouths: Sequence[Mouth], kerb: float) -> list[float]:
    """Returns the distance in metres from the node to the contact of each arm, at least ``NEAREST``. The arms
    are given counter-clockwise; ``kerb`` is the smallest radius in metres of a kerb between two of them.
    """
    found = [NEAREST] * len(mouths)
    for i, mouth in enumerate(mouths):
        j = (i + 1) % len(mouths)
        gap = (mouths[j].direction - mouth.direction) % (2 * math.pi)
        if gap >= math.pi - OPPOSITE:
            continue
        # traffic that turns right here keeps to the kerb, at most these widths from the reference line
        tangent = (kerb + max(mouth.width_in, mouths[j].width_out)) * tangent_length(math.pi - gap)
        for arm, own, theirs in (
            (i, mouths[j].width_out, mouth.width_in),
            (j, mouth.width_in, mouths[j].width_out),
        ):
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
    """Adds a junction and its connecting roads to a network that has the roads of all stubs; returns the
    junction.

    ``node`` is the point in metres at which the reference lines would meet. ``distances`` are those in metres
    from the node to the contacts of the stubs, ``controls`` the signs or lights. All three sequences are in
    counter-clockwise order. ``kerb`` is the requested radius in metres, which is only stored: ``distances``
    decide how much room there is.
    """
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
    """Adds a connecting road from one arm to another; returns the connection.

    The reference lines of the two ``ends`` meet at ``node``, which lies ``distances`` metres from their
    contacts. ``way`` has at least one pair of lanes, ``between`` is the marking between two lanes.
    """
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
