"""Requires each roundabout to have an outer diameter of at least 13 m, and mouths that do not overlap.

A mouth is the junction at which an arm meets the ring. The diameter is measured on the pieces of the ring: it
is twice the sum of the radius of the reference line and the width of the lanes outside this line.
Source: Merkblatt für die Anlage von Kreisverkehren (FGSV, 2006): mini roundabouts have 13 m to 22 m."""

import math

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, junction_finding
from roadgpt.check.footprint import footprint
from roadgpt.geometry import PieceCurve
from roadgpt.network import Network, NetworkRoad, Roundabout
from roadgpt.road import Road, World

LEAST = 13.0  # m, outer diameter
OVERLAP = 1e-3  # m^2
ONCE = 1e-6  # rad, largest deviation of the sum of the turns of a ring's pieces from one full turn
ROUNDING = 1e-9  # m


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports each roundabout that is too small, and each one whose mouths overlap."""
    found, ring_of = [], network.roundabout_of.get
    for ring in network.roundabouts:
        first = network.junction(ring.junctions[0])
        diameter = min(_diameter(network.right_hand.road(each)) for each in ring.ring)
        if diameter < LEAST - ROUNDING:
            what = (
                f"the roundabout has an outer diameter of {diameter:.1f} m, smaller than {LEAST:g} m; give "
                "its island a larger radius"
            )
            found.append(junction_finding("ring_too_small", route, first, what))
        mouths_overlap = any(
            ring_of(one.id) is ring and ring_of(other.id) is ring and area > OVERLAP
            for one, other, area, *_ in footprint(network).overlaps
        )
        if mouths_overlap or abs(_turning(network.right_hand, ring) - 2 * math.pi) > ONCE:
            what = "the mouths of two arms overlap; turn the arms apart or give the island a larger radius"
            found.append(junction_finding("ring_too_small", route, first, what))
    return tuple(found)


def _diameter(member: NetworkRoad) -> float:
    plan = member.road.plan
    assert isinstance(plan, PieceCurve)
    bend = max(max(piece.k0, piece.k1) for piece in plan.pieces)
    width = -float(member.profile.edges(0.0).right)
    return 2 * (1 / bend + width) if bend > 0 else math.inf


def _turning(network: Network, ring: Roundabout) -> float:
    """Returns the angle in radians by which the ring turns in all, including its roads inside the mouths."""
    along = [
        each.road
        for number in ring.junctions
        for each in network.junction(number).connections
        if each.incoming.road in ring.ring and each.outgoing.road in ring.ring
    ]
    plans = [network.road(number).road.plan for number in (*ring.ring, *along)]
    return sum((p.k0 + p.k1) / 2 * p.length for plan in plans for p in plan.pieces)  # type: ignore[attr-defined]
