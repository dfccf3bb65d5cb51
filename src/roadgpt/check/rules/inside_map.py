"""Requires the whole surface of the road to lie inside the map, without touching its border.

The map extends from 0 to ``map_size`` along x and y; shoulders may extend beyond it. The carriageways of a
network count as touching the border if they come within 11 mm of it. Source: two checks of the RoadGPT thesis
(the road fits into the map, and no part of it touches the border) and one of the SBFT competition. The
competition's code accepts some roads far outside the map, because of an operator precedence error; this rule
rejects them. Findings about networks are called ``leaves_map``."""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding, owner_of, single_road, station_on
from roadgpt.check.ribbon import bulge, extent, sides
from roadgpt.network import Network
from roadgpt.road import Road, World


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports where a single road leaves the map, and whether it is larger than the map; of a network, each
    road, junction or roundabout that leaves the map, with its point farthest outside."""
    road = single_road(route)
    if road is None:
        return _of_network(network, route, world)
    samples, size = road.sample(), world.site.map_size
    offsets = network.roads[0].profile.edges(samples.s)
    low, high = extent(samples, offsets)
    if low.min() > 0 and high.max() < size:
        return ()
    edges, slack = np.stack(sides(samples, offsets), axis=1), bulge(samples, offsets)  # (n, 2 sides, 2)
    out = np.any((edges <= slack) | (edges >= size - slack), axis=2)
    first = int(out.any(axis=1).argmax())
    x, y = (float(v) for v in edges[first, int(out[first].argmax())])
    s = float(samples.s[first])
    verb = "leaves the map at" if first else "starts outside the map at"
    place = f"({round(x)}, {round(y)})"
    sentence = f"at s = {s:.0f} m: the road {verb} {place}; the map runs from 0 to {size:g} m"
    found = [Finding("inside_map", sentence, s, x, y)]
    for axis, spanned in zip("xy", np.ptp(edges, axis=(0, 1)), strict=True):
        if spanned >= size:
            wide = f"the road spans {spanned:.0f} m along {axis}, and the map is only {size:g} m wide"
            found.append(Finding("inside_map", wide))
    return tuple(found)


def _of_network(network: Network, route: Road | None, world: World) -> tuple[Finding, ...]:
    from roadgpt.check.footprint import SLACK, footprint  # not for single roads

    size, bounds = world.site.map_size, footprint(network).bounds
    beyond = np.concatenate((SLACK - bounds[:, :2], bounds[:, 2:] - (size - SLACK)), axis=1)
    worst: dict[str, tuple[float, int]] = {}
    for n in np.flatnonzero((beyond >= 0).any(axis=1)).tolist():
        name = owner_of(network, network.roads[n])
        worst[name] = max(worst.get(name, (-1.0, 0)), (float(beyond[n].max()), n))
    found = []
    for name, (far, n) in worst.items():
        side = int(beyond[n].argmax())
        edge, axis = (0.0, size)[side // 2], "xy"[side % 2]
        x, y, along = footprint(network).outermost(n, side)
        sentence = (
            f"near ({x:.0f}, {y:.0f}): {name} leaves the map by {max(far - SLACK, 0):.1f} m at "
            f"{axis} = {edge:g}; the map runs from 0 to {size:g} m"
        )
        s = station_on(route, network.roads[n], along)
        found.append(Finding("leaves_map", sentence, s, x, y))
    return tuple(found)
