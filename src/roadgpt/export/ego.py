"""The car that files speak of: a saloon, where it starts, how fast it may go, and a drive in other words.

Sizes of BeamNG's ETK 800, a mid-size saloon, as the simulator has them.
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
PULL = 2.0  # m/s^2, of driving off and slowing down: what ISO 15622 allows cruise control to speed up
STEP = 0.5  # m between the places for which a speed is planned


@dataclass(frozen=True)
class EgoVehicle:
    """In metres and kilograms; heights above the ground."""

    length: float = 4.70
    width: float = 1.86
    height: float = 1.44
    mass: float = 1700.0
    front_axle: float = 1.36
    """Ahead of the centre of gravity."""
    rear_axle: float = -1.47
    middle: float = -0.10
    """Of the length, ahead of the centre of gravity."""
    gravity_height: float = 0.56
    track: float = 1.58
    wheel: float = 0.66
    """Diameter."""
    lock: float = 0.62
    """Radians, of the front wheels."""


CAR = EgoVehicle()


def start_of(road: Road) -> float:
    """Station of the car's centre of gravity when a drive begins."""
    return min(START, road.length / 2)


def goal_of(road: Road) -> float:
    """Station at which a drive is over, past its start."""
    return max(road.length - GOAL, (start_of(road) + road.length) / 2)


class SpeedProfile(NamedTuple):
    """How fast a calm driver goes, from a standing start; arrays of one length."""

    s: Array
    """Stations along the road, metres."""
    speed: Array
    """m/s."""
    time: Array
    """Seconds since the start, at a constant acceleration between the stations."""


def calm_speeds(road: Road, world: World, s: Array) -> Array:
    """Speeds in m/s that suit a calm driver at stations ``s``: the limit, or what the bend allows."""
    bend = np.maximum(np.abs(road.curvature(s)), 1e-9)
    sideways = min(COMFORT, GRIP * world.friction * GRAVITY)
    return np.asarray(np.minimum(world.speed_limit, np.sqrt(sideways / bend)))


def calm_speed(road: Road, world: World) -> float:
    """The speed in m/s that a calm driver may hold all along: that of the tightest bend, or the limit."""
    return float(calm_speeds(road, world, road.sample().s).min())


def calm_profile(road: Road, world: World, start: float) -> SpeedProfile:
    """How a calm driver drives the middle of the right lane: off from rest, slower for bends in time.

    Args:
        road: where.
        world: speed limit, friction, width of the lane.
        start: station where the drive begins, metres.
    """
    count = max(2, int(np.ceil((road.length - start) / STEP)) + 1)
    s = np.linspace(start, road.length, count)
    step, bend = float(s[1] - s[0]), road.curvature(s)
    grip = GRIP * world.friction
    pull = min(PULL / GRAVITY, grip)
    limits = DrivingLimits(min(COMFORT / GRAVITY, grip), pull, pull, world.speed_limit)
    speed = lane_speed(bend, 0.0, step, world, limits)
    stretch = np.maximum(1 + bend * world.lane_width / 2, 0.0)
    along = step * (stretch[1:] + stretch[:-1]) / 2
    # the plan's first station lies one step behind rest
    speed = np.minimum(speed, np.sqrt(2 * pull * GRAVITY * np.r_[0.0, np.cumsum(along)]))
    return SpeedProfile(s, speed, np.r_[0.0, np.cumsum(2 * along / (speed[1:] + speed[:-1]))])


def on_the_ground(poses: Poses, ahead: float) -> Array:
    """Points ``(n, 3)`` on the ground under the car, ``ahead`` of its centre of gravity."""
    h, p, r = poses.heading, poses.pitch, poses.roll
    forward = np.stack([np.cos(h) * np.cos(p), np.sin(h) * np.cos(p), np.sin(p)], axis=-1)
    left = np.stack([-np.sin(h), np.cos(h), np.zeros_like(h)], axis=-1)
    level_up = np.cross(forward, left)
    up = level_up * np.cos(r)[:, None] - left * np.sin(r)[:, None]
    centre = np.stack([poses.x, poses.y, poses.z], axis=-1)
    return np.asarray(centre + ahead * forward - CAR.gravity_height * up)
