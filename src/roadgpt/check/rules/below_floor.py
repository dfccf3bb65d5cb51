"""Requires all roads to stay on or above the level's ground: z >= -28 m on BeamNG's flat SBFT level."""

from roadgpt.brief.model import Brief
from roadgpt.check.extremes import lowest
from roadgpt.check.finding import Finding, road_finding
from roadgpt.network import Network
from roadgpt.road import Road, World

ROUNDING = 1e-6  # m


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the lowest place of each road that is below the ground of the level."""
    found = []
    for member in network.roads:
        s, z = lowest(member.road.elevation, member.road.length)
        if z >= world.site.z_floor - ROUNDING:
            continue
        what = f"height {z:.1f} m is below the ground at {world.site.z_floor:g} m"
        found.append(road_finding("below_floor", route, member, s, what))
    return tuple(found)
