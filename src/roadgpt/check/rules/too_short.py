"""Requires a length of more than 20 m, both along the curve and as the SBFT competition measures it.

If the road is so short that the car is already at the goal when it starts, the road cannot be driven at all.
"""

from roadgpt.brief.model import Brief
from roadgpt.check.finding import Finding
from roadgpt.check.sbft import measured_length
from roadgpt.geometry import interpolate
from roadgpt.road import Road, World
from roadgpt.road.road import GOAL, SHORTEST_DRIVE, START

DOUBT = 1.0  # m: if the road is longer by this much, SBFT's measure agrees


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the length of the road if it is too short."""
    length = road.length
    if length <= SHORTEST_DRIVE:
        return (without_room(length),)
    if length > world.limits.min_length + DOUBT:
        return ()
    length = min(length, measured_length(interpolate(road.control_points())))
    if length > world.limits.min_length:
        return ()
    return (shorter_than_allowed(length, world),)


def shorter_than_allowed(length: float, world: World) -> Finding:
    """Returns the Finding for a road whose ``length`` in metres is not above the World's ``min_length``."""
    wanted = f"a road is longer than {world.limits.min_length:g} m"
    return Finding("too_short", f"the road is {length:.1f} m long, and {wanted}")


def without_room(length: float) -> Finding:
    """Returns the Finding for a road of ``length`` metres, which is too short to be driven at all."""
    sentence = (
        f"the road is {length:.1f} m long, too short to be driven: a car starts {START:g} m along a road and "
        f"has arrived {GOAL:g} m before its end"
    )
    return Finding("too_short", sentence, stops=True)
