"""The road is longer than 20 m, on the curve itself and as the SBFT competition measures its least length."""

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.check.sbft import measured_length
from roadgpt.geometry import interpolate
from roadgpt.road import Road, World

DOUBT = 1.0  # m: longer by this much, SBFT's measure can only agree


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Says how long the road is, where that is too short."""
    length = road.length
    if length > world.min_length + DOUBT:
        return ()
    length = min(length, measured_length(interpolate(road.control_points())))
    if length > world.min_length:
        return ()
    wanted = f"a road is longer than {world.min_length:g} m"
    return (Finding("too_short", f"the road is {length:.1f} m long, and {wanted}"),)
