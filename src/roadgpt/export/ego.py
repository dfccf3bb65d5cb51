"""The car that files speak of: a saloon, where it starts, how fast it may go, and a drive in other words.

Sizes of BeamNG's ETK 800, a mid-size saloon, as the simulator has them.
"""

import math
from dataclasses import dataclass

import numpy as np

from roadgpt.export.poses import Poses
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.road.ends import GOAL, START

GRAVITY = 9.81  # m/s^2
COMFORT = 3.0  # m/s^2, lateral, ISO 11270
GRIP = 0.5  # share of the friction that a calm driver uses


@dataclass(frozen=True)
class Car:
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


CAR = Car()


def start_of(road: Road) -> float:
    """Station of the car's centre of gravity when a drive begins."""
    return min(START, road.length / 2)


def goal_of(road: Road) -> float:
    """Station at which a drive is over, past its start."""
    return max(road.length - GOAL, (start_of(road) + road.length) / 2)


def calm_speed(road: Road, world: World) -> float:
    """The speed in m/s that a calm driver holds all along: the limit, or what the tightest bend allows."""
    tightest = float(np.abs(road.sample().curvature).max())
    sideways = min(COMFORT, GRIP * world.friction * GRAVITY)
    return min(world.speed_limit, math.sqrt(sideways / tightest) if tightest > 0 else math.inf)


def on_the_ground(poses: Poses, ahead: float) -> Array:
    """Points ``(n, 3)`` on the ground under the car, ``ahead`` of its centre of gravity."""
    h, p, r = poses.heading, poses.pitch, poses.roll
    forward = np.stack([np.cos(h) * np.cos(p), np.sin(h) * np.cos(p), np.sin(p)], axis=-1)
    left = np.stack([-np.sin(h), np.cos(h), np.zeros_like(h)], axis=-1)
    level_up = np.cross(forward, left)
    up = level_up * np.cos(r)[:, None] - left * np.sin(r)[:, None]
    centre = np.stack([poses.x, poses.y, poses.z], axis=-1)
    return np.asarray(centre + ahead * forward - CAR.gravity_height * up)
