"""Requires that no two parts of the surface overlap in plan view outside junctions, unless they lie in land
and one is on a bridge over the other, at least CLEARANCE higher.

Source: the SBFT competition's rule against roads that cross themselves. The surface is divided into quads
about 1 m long. A quad that is not convex shows that the surface folds: the radius of the bend is smaller than
half the road width. Without folds, quads that are closer together along the road than half a circle of the
tightest radius cannot overlap (Schur's comparison theorem), so only quads farther apart are compared. The
curved edge of the road bulges slightly beyond the straight edges of the quads, so the gap between two quads
must be more than twice this bulge.

Different roads are compared as polygons; an overlap outside junctions would be a crossing that no connection
describes. Connecting roads of one junction may overlap; roads of one roundabout are compared by the rule
``ring_too_small``. Findings about networks are called ``conflicting_overlap``."""

from functools import lru_cache

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, owner_of, road_finding, single_road, station_on
from roadgpt.check.ribbon import bulge, is_convex, near_pairs, quads_of, sides
from roadgpt.network import Network, NetworkRoad
from roadgpt.road import Road, World

NEAR = 1.5  # m between two parts, up to which their distance is measured
SURELY = 0.9  # of the tightest radius: between the samples, a bend may be a little tighter


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the first place where a single road overlaps itself, and the earlier place that it overlaps; of
    a network, each pair of roads or junctions that overlap, and each road that overlaps itself."""
    road = single_road(route)
    if road is None:
        return _in_network(network, route, world)
    found, *_ = overlap_with_itself(network.roads[0], world)
    return () if found is None else (_finding(road, *found),)


@lru_cache(maxsize=4)  # rules of other packages ask the same
def overlap_with_itself(member: NetworkRoad, world: World) -> tuple[tuple[int, str] | None, int, float]:
    """Returns three values: the index of the first sample at which the road folds or overlaps an earlier
    part, and what is wrong there (None: nothing is wrong); the index of the sample that is nearest to an
    earlier part (0 if the road folds, or no parts are close); and the metres between these two parts. The
    metres are 0 if the road folds or overlaps itself, and may be infinite above NEAR."""
    import shapely

    samples = member.road.sample()
    offsets = member.profile.edges(samples.s)
    quads = quads_of(*sides(samples, offsets))
    folded = np.flatnonzero(~is_convex(quads))
    if folded.size:
        return (int(folded[0]), "the road folds onto itself; widen the bend"), 0, 0.0
    slack = 2 * bulge(samples, offsets)
    narrowest = min(offsets.left.min(), -offsets.right.max())
    tightest = 1 / max(float(np.abs(samples.curvature).max()), 1e-9)
    radius = SURELY * tightest
    if radius < max(offsets.left.max(), -offsets.right.min()):
        radius = narrowest  # as the surface does not fold, no bend is tighter
    half_turn = np.pi * radius / max(float(samples.s[1] - samples.s[0]), 1e-9)
    shapes, nearest = shapely.polygons(quads), (np.inf, 0)
    for i, j in near_pairs(quads, reach=max(slack, NEAR), apart=max(2, int(min(half_turn, len(quads))))):
        if world.has_ground:
            from roadgpt.network.landscape import CLEARANCE

            is_level = np.abs(samples.z[i] - samples.z[j]) < CLEARANCE
            i, j = i[is_level], j[is_level]
        gap = shapely.distance(shapes[i], shapes[j])
        lies_over = gap <= slack
        if lies_over.any():
            again = int(j[lies_over].min())
            earlier = float(samples.s[int(i[lies_over & (j == again)].min())])
            return (again, f"the road overlaps itself at s = {earlier:.0f} m"), again, 0.0
        if gap.size:
            nearest = min(nearest, (float(gap.min()), int(j[gap.argmin()])))
    return None, nearest[1], nearest[0]


def _is_above(one: NetworkRoad, other: NetworkRoad) -> bool:
    """Returns whether one of two roads is CLEARANCE above the other wherever they come near each other."""
    from roadgpt.network.landscape import CLEARANCE

    points = one.road.centreline(1.0)
    s, t = other.road.locate(*points[:, :2].T)
    near = np.abs(t) < one.profile.reach + other.profile.reach
    rises = np.abs(points[near, 2] - other.road.elevation.height(s[near]))
    return bool(rises.min(initial=np.inf) >= CLEARANCE)


def _finding(road: Road, index: int, what: str) -> Finding:
    samples = road.sample()
    s, x, y = (float(v[index]) for v in (samples.s, samples.x, samples.y))
    return Finding("no_overlap", f"at s = {s:.0f} m, near ({x:.0f}, {y:.0f}): {what}", s, x, y)


def _in_network(network: Network, route: Road | None, world: World) -> tuple[Finding, ...]:
    from roadgpt.check.footprint import footprint  # not for single roads

    shapes, found = footprint(network), []
    worst: dict[tuple[str, str], tuple[NetworkRoad, NetworkRoad, float, float, float]] = {}
    for each in shapes.overlaps:
        one, other, area, *_ = each
        ring = network.roundabout_of.get(one.id)
        if ring is not None and ring is network.roundabout_of.get(other.id):
            continue
        if world.has_ground and _is_above(one, other):
            continue
        names = owner_of(network, one), owner_of(network, other)
        if names not in worst or area > worst[names][2]:
            worst[names] = each
    for names, (*members, _, x, y) in worst.items():
        sentence = (
            f"near ({x:.0f}, {y:.0f}): {' and '.join(names)} overlap outside a junction; move them apart"
        )
        on_route = [station_on(route, member, float(member.road.locate(x, y)[0])) for member in members]
        s = max((s for s in on_route if s is not None), default=None)
        found.append(Finding("conflicting_overlap", sentence, s, x, y))
    for member in shapes.folded:
        own = overlap_with_itself(member, world)[0]
        if own is not None:
            s = float(member.road.sample().s[own[0]])
            found.append(road_finding("conflicting_overlap", route, member, s, own[1]))
    return tuple(found)
