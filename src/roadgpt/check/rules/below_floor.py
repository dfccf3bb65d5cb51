"""Requires the road to stay on or above the level's ground: z >= -28 m on BeamNG's flat SBFT level."""

from roadgpt.brief.model import Brief
from roadgpt.check.extremes import lowest
from roadgpt.check.finding import Finding, findings_at
from roadgpt.road import Road, World

ROUNDING = 1e-6  # m


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the lowest place of the road if it is below the ground of the level."""
    return findings_at("below_floor", road, low_place(road, world))


def low_place(road: Road, world: World) -> tuple[float, str] | None:
    """Returns the station in metres of the lowest place, and what is wrong there; None if the rule is met."""
    s, z = lowest(road.elevation, road.length)
    if z >= world.site.z_floor - ROUNDING:
        return None
    return s, f"height {z:.1f} m is below the ground at {world.site.z_floor:g} m"
