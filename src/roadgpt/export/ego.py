"""The ego vehicle of exported files: its size, where it starts, its speeds, and how a drive is converted.

Its dimensions are those of BeamNG's ETK 800, a mid-size saloon, as in the simulator.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from roadgpt.export.poses import Poses
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.road.ends import GOAL, START
from roadgpt.road.speed_profile import GRAVITY, DrivingLimits, lane_speed

COMFORT = 3.0  # m/s^2, lateral, ISO 11270
GRIP = 0.5  # share of the friction that a calm driver uses
PULL = 2.0  # m/s^2, of driving off and braking: the acceleration that ISO 15622 allows cruise control
STEP = 0.5  # m between the places for which a speed is planned


@dataclass(frozen=True)
class EgoVehicle:
    """Dimensions of the ego vehicle in metres and kilograms. Heights are above the ground."""

    length: float = 4.70
    width: float = 1.86
    height: float = 1.44
    mass: float = 1700.0
    front_axle: float = 1.36
    """Distance ahead of the centre of gravity."""
    rear_axle: float = -1.47
    middle: float = -0.10
    """Middle of the length, ahead of the centre of gravity."""
    gravity_height: float = 0.56
    track: float = 1.58
    wheel: float = 0.66
    """Wheel diameter."""
    lock: float = 0.62
    """Greatest steering angle of the front wheels in radians."""


CAR = EgoVehicle()


def start_of(road: Road) -> float:
    """Returns the station in metres of the car's centre of gravity when a drive begins."""
    return min(START, road.length / 2)


def goal_of(road: Road) -> float:
    """Returns the station in metres at which a drive is over. It lies behind the start."""
    return max(road.length - GOAL, (start_of(road) + road.length) / 2)


class SpeedProfile(NamedTuple):
    """The speeds of a calm driver from a standing start, as arrays of equal length."""

    s: Array
    """Stations along the road in metres."""
    speed: Array
    """Speeds in m/s."""
    time: Array
    """Seconds since the start, with a constant acceleration between stations."""


def calm_speeds(road: Road, world: World, s: Array) -> Array:
    """Returns speeds in m/s that suit a calm driver at stations ``s``: the limit, or what the bend allows."""
    bend = np.maximum(np.abs(road.curvature(s)), 1e-9)
    sideways = min(COMFORT, GRIP * world.friction * GRAVITY)
    return np.asarray(np.minimum(world.speed_limit, np.sqrt(sideways / bend)))


def calm_speed(road: Road, world: World) -> float:
    """Returns the speed in m/s that a calm driver can hold everywhere on the road."""
    return float(calm_speeds(road, world, road.sample().s).min())


def calm_profile(road: Road, world: World, start: float) -> SpeedProfile:
    """Returns how a calm driver drives the middle of the right lane from rest.

    Args:
        road: The road.
        world: Speed limit, friction, width of the lane.
        start: Station in metres where the drive begins.
    """
    count = max(2, int(np.ceil((road.length - start) / STEP)) + 1)
    s = np.linspace(start, road.length, count)
    step, bend = float(s[1] - s[0]), road.curvature(s)
    grip = GRIP * world.friction
    pull = min(PULL / GRAVITY, grip)
    limits = DrivingLimits(min(COMFORT / GRAVITY, grip), pull, pull, world.speed_limit)
    offset = world.profile.middle(s)
    speed = lane_speed(bend, 0.0, step, offset, limits)
    stretch = np.maximum(1 - bend * offset, 0.0)
    along = step * (stretch[1:] + stretch[:-1]) / 2
    # the first station of the plan is one step after rest
    speed = np.minimum(speed, np.sqrt(2 * pull * GRAVITY * np.r_[0.0, np.cumsum(along)]))
    return SpeedProfile(s, speed, np.r_[0.0, np.cumsum(2 * along / (speed[1:] + speed[:-1]))])


def on_the_ground(poses: Poses, ahead: float) -> Array:
    """Returns points ``(n, 3)`` on the ground below the car, ``ahead`` metres from its centre of gravity."""
    h, p, r = poses.heading, poses.pitch, poses.roll
    forward = np.stack([np.cos(h) * np.cos(p), np.sin(h) * np.cos(p), np.sin(p)], axis=-1)
    left = np.stack([-np.sin(h), np.cos(h), np.zeros_like(h)], axis=-1)
    level_up = np.cross(forward, left)
    up = level_up * np.cos(r)[:, None] - left * np.sin(r)[:, None]
    centre = np.stack([poses.x, poses.y, poses.z], axis=-1)
    return np.asarray(centre + ahead * forward - CAR.gravity_height * up)
