"""Rehearses a scene with the tested car as the test robot drives it: in the middle of its lane, at the speed
of the scene, whatever is in its way. Only the others are simulated, which takes a few hundredths of a second,
and the same seed gives the same result."""

from itertools import count
from typing import TYPE_CHECKING

from roadgpt.network.line import driven_line
from roadgpt.road.road import GOAL, START
from roadgpt.traffic import begin
from roadgpt.traffic.actor import SIZES, STEP, Size, TestedCar
from roadgpt.traffic.traffic import Traffic

if TYPE_CHECKING:
    from roadgpt.road import Road, World

LASTS, SLOWEST = 120.0, 1.0  # s, after which a drive among others that is slower in m/s is over


def rehearsed(
    road: "Road", world: "World", seed: int, size: Size = SIZES["car"], ahead: float = 0.0
) -> Traffic | None:
    """Returns the others after the rehearsal, who tell what happened; None if there are none. The middle of
    the tested car's box, of a ``size``, is ``ahead`` metres before its centre of gravity."""
    traffic, way, v = begin(road, world, seed), driven_line(road, world), world.first_speed
    if traffic is None:
        return None
    first = way.from_road(min(START, road.length / 2))
    for n in count():
        time = n * STEP
        s = way.to_road(first + v * time)
        if s > road.length - GOAL or (time > LASTS and v < SLOWEST):
            break
        x, y, _, heading = way.pose(first + v * time + ahead)
        t = float(world.profile_of(road).middle(s))
        traffic.advance(TestedCar(x, y, heading, v, s, t, size.length, size.width))
    return traffic
