"""Defines what a driver gets, and what it returns, at every control step."""

from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from roadgpt.road import Road, World


class View(NamedTuple):
    """The present state of the car and its road; a new View is made for every control step (20 ms), so a
    driver may keep it.

    The position is that of the car's centre of gravity.
    """

    time: float
    """Seconds since the start."""
    x: float
    """Metres."""
    y: float
    """Metres."""
    z: float
    """Metres, height of the centre of gravity (about half a metre above the road)."""
    heading: float
    """Radians, 0 along +x, positive to the left, in (-pi, pi]."""
    speed: float
    """Metres per second, never negative."""
    yaw_rate: float
    """Radians per second, positive to the left."""
    s: float
    """Metres along the centre line."""
    t: float
    """Metres to the left of the centre line; the middle of the right lane is ``-world.lane_width / 2``."""
    road: "Road"
    world: "World"
    steer: float
    """Radians, the present angle of the front wheels, left positive."""
    dt: float
    """Seconds to the next control step."""
    vx: float
    """Metres per second, forward along the car; negative when it rolls back."""
    vy: float
    """Metres per second, to the car's left."""
    image: Any = None
    """The driver's camera image, shape (height, width, 3), uint8; None if the driver has no attribute
    ``camera``."""


class CameraSpec(NamedTuple):
    """The camera that a driver asks for with an attribute ``camera``; the defaults are those of the
    competition."""

    width: int = 320
    """Pixels."""
    height: int = 160
    field_of_view: float = 1.22
    """Radians, from the top of the image to the bottom."""
    ahead: float = 0.3
    """Metres ahead of the centre of gravity."""
    up: float = 1.3
    """Metres above the road."""
    down: float = 0.05
    """Radians by which the camera is tilted downwards."""
    every: int = 2
    """Control steps from one image to the next; 2 gives 25 images a second. BeamNG gives an image at every
    step."""


class Command(NamedTuple):
    """The driver's answer, which holds until the next control step."""

    steer: float
    """Radians at the front wheels, left positive; the car turns its wheels at a limited rate."""
    throttle: float = 0.0
    """0 to 1."""
    brake: float = 0.0
    """0 to 1."""
