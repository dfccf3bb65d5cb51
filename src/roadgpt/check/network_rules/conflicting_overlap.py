"""Requires that roads overlap only inside junctions, whatever their heights.

Carriageways are compared as polygons. Folds and loops of one road are found as in the rule ``no_overlap`` for
single roads. Connecting roads of one junction may overlap; roads of one roundabout are compared by the rule
``ring_too_small``. Source: as for ``no_overlap``; an overlap outside junctions would be a crossing that no
connection describes."""

from roadgpt.check.finding import Finding, owner_of, road_finding, station_near
from roadgpt.check.footprint import footprint
from roadgpt.check.rules.no_overlap import overlap_with_itself
from roadgpt.network import Network, NetworkRoad, Route
from roadgpt.road import World


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each pair of roads or junctions that overlap, and each road that overlaps itself."""
    shapes, found = footprint(network), []
    worst: dict[tuple[str, str], tuple[NetworkRoad, NetworkRoad, float, float, float]] = {}
    for each in shapes.overlaps:
        one, other, area, *_ = each
        ring = network.roundabout_of.get(one.id)
        if ring is not None and ring is network.roundabout_of.get(other.id):
            continue
        names = owner_of(network, one), owner_of(network, other)
        if names not in worst or area > worst[names][2]:
            worst[names] = each
    for names, (*members, _, x, y) in worst.items():
        sentence = (
            f"near ({x:.0f}, {y:.0f}): {' and '.join(names)} overlap outside a junction; move them apart"
        )
        on_route = [station_near(route, member, x, y) for member in members]
        s = max((s for s in on_route if s is not None), default=None)
        found.append(Finding("conflicting_overlap", sentence, s, x, y))
    for member in shapes.folded:
        own = overlap_with_itself(member.road, world)[0]
        if own is not None:
            s = float(member.road.sample().s[own[0]])
            found.append(road_finding("conflicting_overlap", route, member, s, own[1]))
    return tuple(found)
