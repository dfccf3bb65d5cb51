"""Requires the road to stay on or above the level's ground: z >= -28 m on BeamNG's flat SBFT level."""

from roadgpt.brief.model import Brief
from roadgpt.check.extremes import lowest
from roadgpt.check.finding import Finding
from roadgpt.road import Road, World

ROUNDING = 1e-6  # m


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the lowest place of the road if it is below the ground of the level."""
    s, z = lowest(road.elevation, road.length)
    if z >= world.site.z_floor - ROUNDING:
        return ()
    x, y, _ = (float(v) for v in road.at(s))
    sentence = f"at s = {s:.0f} m: height {z:.1f} m is below the ground at {world.site.z_floor:g} m"
    return (Finding("below_floor", sentence, s, x, y),)
