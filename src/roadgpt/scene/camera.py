"""Poses and cameras: where a picture is taken from."""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.export.ego import CAR
from roadgpt.geometry.curve import Array

Mount = Literal["bonnet", "chase", "above"]

LARGEST = 4096  # pixels, a side
NARROWEST, WIDEST = math.radians(5), math.radians(150)


class Pose(NamedTuple):
    """Where a car is, and what is seen of how it is driven; a drive has columns of these names.

    Positions are those of the centre of gravity in metres, angles in radians: heading 0 along +x and
    counter-clockwise, pitch positive nose up, roll positive left side up.
    """

    x: float
    y: float
    z: float
    heading: float
    pitch: float = 0.0
    roll: float = 0.0
    steer: float = 0.0
    """rad, of the front wheels, left positive."""
    speed: float = 0.0
    """m/s."""
    brake: float = 0.0
    """0..1."""
    wheel: float = 0.0
    """rad that the wheels have rolled."""


class Place(NamedTuple):
    """Of a camera on its car."""

    ahead: float
    """m ahead of the centre of gravity."""
    up: float
    """m above the ground under the car."""
    tilt: float
    """rad against the car, upwards positive."""


MOUNTS: dict[str, Place] = {
    "bonnet": Place(0.72, 1.28, -0.060),
    "chase": Place(-8.4, 2.95, -0.17),
    "above": Place(0.0, 34.0, -math.pi / 2),
}
"""Over the bonnet and fixed to the body; behind the car and level; above it, its nose at the top."""


class Eye(NamedTuple):
    """A camera in the world: a pinhole."""

    position: Array
    """(3,), metres."""
    axes: Array
    """(3, 3): unit vectors to the right, downwards and forward as rows."""
    focal: float
    """Pixels."""


@dataclass(frozen=True)
class Camera:
    """A pinhole camera with square pixels, mounted to a car.

    Raises:
        UsageError: the picture or the field of view has a size that no camera has, or the mount is unknown.
    """

    width: int = 640
    """Pixels."""
    height: int = 360
    field_of_view: float = math.radians(70)
    """rad, horizontal."""
    mount: Mount = "bonnet"
    place: Place | None = None
    """Where it sits, if not where MOUNTS says."""

    def __post_init__(self) -> None:
        if not (1 <= self.width <= LARGEST and 1 <= self.height <= LARGEST):
            raise UsageError(
                f"a picture of {self.width} by {self.height} pixels cannot be drawn; give 1 to {LARGEST} each"
            )
        if not NARROWEST <= self.field_of_view <= WIDEST:
            raise UsageError(
                f"a camera cannot see {math.degrees(self.field_of_view):.4g} degrees; give 5 to 150"
            )
        if self.mount not in MOUNTS:
            raise UsageError(f"a camera cannot be mounted '{self.mount}'; say {', '.join(MOUNTS)}")

    @property
    def focal(self) -> float:
        """Focal length, pixels."""
        return self.width / 2 / math.tan(self.field_of_view / 2)

    def eye(self, pose: Pose) -> Eye:
        """The camera in the world, on a car at a pose."""
        place = self.place or MOUNTS[self.mount]
        if self.mount == "bonnet":
            axes = axes_of(pose.heading, pose.pitch, pose.roll)
        else:
            axes = axes_of(pose.heading, pose.pitch if self.mount == "chase" else 0.0, 0.0)
        forward, left, up = axes
        position = np.array([pose.x, pose.y, pose.z]) + place.ahead * forward
        position = position + (place.up - CAR.gravity_height) * up
        sin, cos = math.sin(place.tilt), math.cos(place.tilt)
        looking = np.array([-left, sin * forward - cos * up, cos * forward + sin * up])
        return Eye(position, looking, self.focal)


def axes_of(heading: float, pitch: float, roll: float) -> Array:
    """Forward, left and up of a body, as rows of (3, 3)."""
    ch, sh, cp, sp = math.cos(heading), math.sin(heading), math.cos(pitch), math.sin(pitch)
    cr, sr = math.cos(roll), math.sin(roll)
    return np.array(
        [
            [ch * cp, sh * cp, sp],
            [-sh * cr - ch * sp * sr, ch * cr - sh * sp * sr, cp * sr],
            [-ch * sp * cr + sh * sr, -sh * sp * cr - ch * sr, cp * cr],
        ]
    )
