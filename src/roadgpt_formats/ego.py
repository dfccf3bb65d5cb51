"""Plans the speeds at which files let the tested car drive, those of a calm driver, and says where it touched
the ground in a drive."""

from typing import NamedTuple

import numpy as np

from roadgpt.export.ego import CAR, Poses
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.road.speed_profile import GRAVITY, DrivingLimits, lane_speed

COMFORT = 3.0  # m/s^2, lateral, ISO 11270
GRIP = 0.5  # share of the friction that a calm driver uses
PULL = 2.0  # m/s^2, of driving off and braking: the acceleration that ISO 15622 allows cruise control
STEP = 0.5  # m between the places for which a speed is planned


class SpeedProfile(NamedTuple):
    """Planned or driven speeds, as arrays of equal length."""

    speed: Array  # speeds in m/s
    time: Array  # times in seconds since the start; the acceleration is constant between stations


def calm_speeds(road: Road, world: World, s: Array) -> Array:
    """Returns the speeds in m/s of a calm driver at stations ``s``.

    The speed is the speed limit, or lower where the lateral acceleration in a bend would be uncomfortable."""
    bend = np.maximum(np.abs(road.curvature(s)), 1e-9)
    sideways = min(COMFORT, GRIP * world.site.friction * GRAVITY)
    return np.asarray(np.minimum(world.limits.speed_limit, np.sqrt(sideways / bend)))


def calm_speed(road: Road, world: World) -> float:
    """Returns the highest constant speed in m/s at which a calm driver can drive the whole road."""
    return float(calm_speeds(road, world, road.sample().s).min())


def calm_profile(road: Road, world: World, first: float = 0.0) -> SpeedProfile:
    """Returns the speeds of a calm driver in the middle of the right lane, who begins with ``first`` m/s, or
    as fast as the road allows."""
    start = world.start_on(road)
    count = max(2, int(np.ceil((road.length - start) / STEP)) + 1)
    s = np.linspace(start, road.length, count)
    step, bend = float(s[1] - s[0]), road.curvature(s)
    grip = GRIP * world.site.friction
    pull = min(PULL / GRAVITY, grip)
    top = world.limits.speed_limit
    limits = DrivingLimits(min(COMFORT / GRAVITY, grip), pull, pull, top, first=first)
    offset = world.profile_of(road).middle(s)
    speed = lane_speed(bend, 0.0, step, offset, limits)
    stretch = np.maximum(1 - bend * offset, 0.0)
    along = step * (stretch[1:] + stretch[:-1]) / 2
    speed = np.minimum(speed, np.sqrt(first**2 + 2 * pull * GRAVITY * np.r_[0.0, np.cumsum(along)]))
    return SpeedProfile(speed, np.r_[0.0, np.cumsum(2 * along / (speed[1:] + speed[:-1]))])


def on_the_ground(poses: Poses, ahead: float) -> Array:
    """Returns, for each pose, the point on the ground ``ahead`` metres in front of the car's centre of
    gravity, as an array ``(n, 3)``."""
    h, p, r = poses.heading, poses.pitch, poses.roll
    forward = np.stack([np.cos(h) * np.cos(p), np.sin(h) * np.cos(p), np.sin(p)], axis=-1)
    left = np.stack([-np.sin(h), np.cos(h), np.zeros_like(h)], axis=-1)
    level_up = np.cross(forward, left)
    up = level_up * np.cos(r)[:, None] - left * np.sin(r)[:, None]
    centre = np.stack([poses.x, poses.y, poses.z], axis=-1)
    return np.asarray(centre + ahead * forward - CAR.gravity_height * up)
