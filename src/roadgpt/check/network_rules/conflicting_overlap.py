"""Requires that roads overlap only inside junctions, whatever their heights.

Carriageways are compared as polygons. Folds and loops of one road are found as in the rule ``no_overlap`` for
single roads. Connecting roads of one junction may overlap; roads of one roundabout are compared by the rule
``ring_too_small``. Source: as for ``no_overlap``; an overlap outside junctions would be a crossing that no
connection describes.
"""

from roadgpt.check.finding import Finding
from roadgpt.check.footprint import Overlap, footprint
from roadgpt.check.network_places import owner_of, road_finding, station_near
from roadgpt.check.rules.no_overlap import overlap_with_itself
from roadgpt.network import Network, Route
from roadgpt.road import World


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each pair of roads or junctions that overlap, and each road that overlaps itself."""
    shapes, found = footprint(network), []
    worst: dict[tuple[str, str], Overlap] = {}
    for each in shapes.overlaps:
        ring = network.roundabout_of.get(each.one.id)
        if ring is not None and ring is network.roundabout_of.get(each.other.id):
            continue
        names = owner_of(network, each.one), owner_of(network, each.other)
        if names not in worst or each.area > worst[names].area:
            worst[names] = each
    for (one, other), each in worst.items():
        near = f"near ({each.x:.0f}, {each.y:.0f})"
        sentence = f"{near}: {one} and {other} overlap outside a junction; move them apart"
        on_route = [station_near(route, member, each.x, each.y) for member in (each.one, each.other)]
        s = max((s for s in on_route if s is not None), default=None)
        found.append(Finding("conflicting_overlap", sentence, s, each.x, each.y))
    for member in shapes.folded:
        own = overlap_with_itself(member.road, world)[0]
        if own is not None:
            s = float(member.road.sample().s[own[0]])
            found.append(road_finding("conflicting_overlap", route, member, s, own[1]))
    return tuple(found)
