"""The road is longer than 20 m: the SBFT competition's least length."""

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.road import Road, World


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Says how long the road is, where that is too short."""
    if road.length > world.min_length:
        return ()
    wanted = f"a road is longer than {world.min_length:g} m"
    return (Finding("too_short", f"the road is {road.length:.1f} m long, and {wanted}"),)
