"""Moves the others on the road: everybody besides the tested car. Main function: ``begin``."""

from typing import TYPE_CHECKING, NamedTuple

from roadgpt.traffic.actor import STEP, Actor, Size, Tracks

if TYPE_CHECKING:
    from roadgpt.road import Road, World

__all__ = ["STEP", "Actor", "Size", "Stage", "TestedCar", "Tracks"]


class Stage(NamedTuple):
    """What a mover is made with."""

    road: "Road"
    world: "World"
    seed: int


class TestedCar(NamedTuple):
    """What the others see of the tested car."""

    x: float
    """Position in metres of the middle of its box, as ``y``."""
    y: float
    heading: float
    speed: float
    s: float
    """Station in metres along the road that it drives, as ``t`` its offset to the left."""
    t: float
    length: float
    width: float
