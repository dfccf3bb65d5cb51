"""Requires all turns to have a radius of at least 14.326 m (47 ft), the limit of the SBFT competition.

The radius is measured on the curve of each road outside junctions and roundabouts; inside them, turns may be
tighter: see ``connection_too_tight``.
"""

from roadgpt.brief.model import Brief
from roadgpt.check.extremes import tightest
from roadgpt.check.finding import Finding, road_finding
from roadgpt.network import Network
from roadgpt.road import Road, World

ROUNDING = 1e-9  # of the limit


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the tightest place of each road whose radius is below the limit."""
    found, limit = [], world.limits.min_radius
    for member in network.roads_outside:
        s, bend = tightest(member.road)
        if abs(bend) * limit <= 1 + ROUNDING:
            continue
        what = f"radius {1 / abs(bend):.1f} m is tighter than {limit:.4g} m"
        found.append(road_finding("too_tight", route, member, s, what))
    return tuple(found)
