"""Defines the poses of cars, and the cameras mounted on cars."""

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
    """The pose of a car, with its steering, speed and braking. Except for ``wheel``, the fields have the same
    names as the columns of a Drive.

    Positions are those of the centre of gravity in metres. Angles are in radians: heading counter-clockwise
    from +x, pitch positive with the nose up, roll positive with the left side up."""

    x: float
    y: float
    z: float
    heading: float
    pitch: float = 0.0
    roll: float = 0.0
    steer: float = 0.0  # angle of the front wheels in rad, left positive
    speed: float = 0.0  # speed in m/s
    brake: float = 0.0  # brake pedal, from 0 (released) to 1 (full braking)
    wheel: float = 0.0  # angle in rad by which the wheels have rotated about their axles


class CameraPlacement(NamedTuple):
    """Position and tilt of a camera on its car."""

    ahead: float  # metres ahead of the car's centre of gravity
    up: float  # metres above the ground under the car
    tilt: float  # pitch in rad relative to the car, positive upwards


MOUNTS: dict[str, CameraPlacement] = {
    "bonnet": CameraPlacement(0.72, 1.28, -0.060),
    "chase": CameraPlacement(-8.4, 2.95, -0.17),
    "above": CameraPlacement(0.0, 34.0, -math.pi / 2),
}
"""Camera placements by name: the hood camera ("bonnet") is fixed to the body; the others follow behind the
car without rolling, or look down from above with the car's nose at the top of the image."""


class CameraPose(NamedTuple):
    """A pinhole camera in world coordinates."""

    position: Array  # position in metres, shape (3,)
    axes: Array  # unit vectors to the right, downwards and forward as rows, shape (3, 3)
    focal: float  # focal length in pixels


@dataclass(frozen=True)
class Camera:
    """A pinhole camera with square pixels, mounted on a car."""

    width: int = 640  # width of the image in pixels
    height: int = 360
    field_of_view: float = math.radians(70)  # horizontal field of view in rad
    mount: Mount = "bonnet"
    placement: CameraPlacement | None = None
    """Position and tilt on the car; None for those of ``mount`` in MOUNTS."""

    def __post_init__(self) -> None:
        if not (1 <= self.width <= LARGEST and 1 <= self.height <= LARGEST):
            size = f"{self.width} by {self.height} pixels"
            raise UsageError(f"an image of {size} cannot be drawn; give 1 to {LARGEST} each")
        if not NARROWEST <= self.field_of_view <= WIDEST:
            said = f"{math.degrees(self.field_of_view):.4g} degrees"
            raise UsageError(f"the field of view of {said} is out of range: give 5 to 150")
        if self.mount not in MOUNTS:
            raise UsageError(f"there is no camera mount '{self.mount}'; choose one of {', '.join(MOUNTS)}")

    @property
    def focal(self) -> float:
        """Focal length in pixels."""
        return self.width / 2 / math.tan(self.field_of_view / 2)

    def eye(self, pose: Pose) -> CameraPose:
        """Returns the pose of the camera in world coordinates, given the pose of its car."""
        placement = self.placement or MOUNTS[self.mount]
        if self.mount == "bonnet":
            axes = axes_of(pose.heading, pose.pitch, pose.roll)
        else:
            axes = axes_of(pose.heading, pose.pitch if self.mount == "chase" else 0.0, 0.0)
        forward, left, up = axes
        position = np.array([pose.x, pose.y, pose.z]) + placement.ahead * forward
        position = position + (placement.up - CAR.gravity_height) * up
        sin, cos = math.sin(placement.tilt), math.cos(placement.tilt)
        looking = np.array([-left, sin * forward - cos * up, cos * forward + sin * up])
        return CameraPose(position, looking, self.focal)


def axes_of(heading: float, pitch: float, roll: float) -> Array:
    """Returns a car's forward, left and up unit vectors as the rows of a (3, 3) array."""
    ch, sh, cp, sp = math.cos(heading), math.sin(heading), math.cos(pitch), math.sin(pitch)
    cr, sr = math.cos(roll), math.sin(roll)
    return np.array(
        [
            [ch * cp, sh * cp, sp],
            [-sh * cr - ch * sp * sr, ch * cr - sh * sp * sr, cp * sr],
            [-ch * sp * cr + sh * sr, -sh * sp * cr - ch * sr, cp * cr],
        ]
    )
