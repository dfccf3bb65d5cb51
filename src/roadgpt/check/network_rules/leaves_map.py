"""Requires the carriageways of all roads of a network to lie inside the map, without touching its border.

The map extends from 0 to ``map_size`` along x and y. As in the rule ``inside_map`` for single roads,
shoulders may extend beyond it. A carriageway that comes within 11 mm of the border counts as touching it."""

import numpy as np

from roadgpt.check.finding import Finding, owner_of, station_on
from roadgpt.check.footprint import SLACK, footprint
from roadgpt.network import Network, Route
from roadgpt.road import World


def inspect(network: Network, route: Route | None, world: World) -> tuple[Finding, ...]:
    """Reports each road, junction or roundabout that leaves the map, with its point farthest outside."""
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
