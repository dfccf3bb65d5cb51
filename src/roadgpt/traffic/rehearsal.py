"""Rehearses a scene with the tested car as the test robot drives it: in the middle of its lane, at the speed
of the scene, whatever is in its way. Only the others are simulated, which takes a few hundredths of a second,
and the same seed gives the same result."""

from roadgpt.road import Road, World
from roadgpt.traffic import begin
from roadgpt.traffic.actor import SIZES, Size
from roadgpt.traffic.aiming import steady
from roadgpt.traffic.traffic import Traffic


def rehearsed(
    road: Road, world: World, seed: int, size: Size = SIZES["car"], ahead: float = 0.0
) -> Traffic | None:
    """Returns the others after the rehearsal, who tell what happened; None if there are none. The middle of
    the tested car's box, of a ``size``, is ``ahead`` metres before its centre of gravity."""
    traffic = begin(road, world, seed)
    if traffic is not None:
        for car in steady(road, world, size, ahead):
            traffic.advance(car)
    return traffic
