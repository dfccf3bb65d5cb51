"""Converts the state of a car, as BeamNG reports it, to a pose on the road. BeamNG reports the position of
a reference node of the car; the pose is that of the centre of gravity."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from roadgpt.compiled import compiled
from roadgpt.drive.drive import Box, FloatArray
from roadgpt.drive.lane_position import LanePolygon
from roadgpt.drive.sampled_road import SampledRoad, locate_on, sample_road
from roadgpt.errors import SimulationError
from roadgpt.road import Road, World

LOCK = 0.6  # rad, lock angle of the front wheels if it was not measured
# Distance of the front axle from the middle of the box as a share of the length, and distance between the
# outer edges of the front tyres as a share of the width. BeamNG does not report wheels, so these are the
# shares of RoadGPT's own car.
AXLE, TYRES = 0.31, 0.97
SIZES = (1.0, 12.0), (0.5, 4.0)  # m, length and width that a car can have


class CarGeometry(NamedTuple):
    """The geometry of a car, measured once while the car is at rest. Positions are relative to the
    centre of gravity: metres ahead, to the left and up."""

    node: tuple[float, float, float]
    """Position of the reference node; BeamNG reports the position of this node as the car's position."""
    rear: float
    front: float
    half: float
    """Half the width of the car, metres."""
    under: float
    """Height of the underside of the car's box, metres relative to the centre of gravity; negative."""
    height: float
    """Height of the centre of gravity above the road, metres."""

    @classmethod
    def measured(
        cls,
        state: Mapping[str, Any],
        gravity: Sequence[float],
        corners: Mapping[str, Sequence[float]],
        ground: FloatArray,
    ) -> "CarGeometry":
        """Returns the geometry of a car that is at rest on the point ``ground``: its state as BeamNG reports
        it, its centre of gravity, and the corners of its bounding box."""
        frame = frame_of(state)
        centre = np.asarray(gravity, float)
        node = frame @ (np.asarray(state["pos"], float) - centre)
        box = np.array([frame @ (np.asarray(corner, float) - centre) for corner in corners.values()])
        (rear, _, under), (front, _, _) = box.min(axis=0), box.max(axis=0)
        half = float(np.ptp(box[:, 1])) / 2
        fits = SIZES[0][0] <= front - rear <= SIZES[0][1] and SIZES[1][0] <= 2 * half <= SIZES[1][1]
        if not (fits and np.isfinite(box).all() and np.abs(node).max() < SIZES[0][1]):
            raise SimulationError(
                f"BeamNG reports a {front - rear:.1f} m by {2 * half:.1f} m car; check ROADGPT_BEAMNG_MODEL"
            )
        height = float(frame[2] @ (centre - ground))
        place = (float(node[0]), float(node[1]), float(node[2]))
        return cls(place, float(rear), float(front), half, float(under), height)

    def box(self, lock: float) -> Box:
        """Returns the geometry as a Box, with the angle of the front wheels at full lock in radians."""
        length, width, ahead = self.front - self.rear, 2 * self.half, (self.front + self.rear) / 2
        wheels = (ahead + AXLE * length, TYRES * width)
        return Box(length, width, ahead, lock, *wheels, height=self.height, under=-self.under)

    @property
    def underside(self) -> FloatArray:
        """The lower corners of the car's box, shape (4, 3), metres, counter-clockwise as seen from above."""
        a, b, h, u = self.rear, self.front, self.half, self.under
        return np.array([[a, -h, u], [b, -h, u], [b, h, u], [a, h, u]])


def frame_of(state: Mapping[str, Any]) -> FloatArray:
    """Returns the car's unit vectors ahead, to the left and up as rows, from the state that BeamNG
    reports."""
    ahead, up = np.asarray(state["dir"], float), np.asarray(state["up"], float)
    size = float(np.linalg.norm(ahead))
    if not (np.isfinite(ahead).all() and np.isfinite(up).all() and size > 0.1):
        raise SimulationError("BeamNG's physics became unstable: the car has no direction any more")
    ahead = ahead / size
    left = np.cross(up, ahead)
    left = left / max(float(np.linalg.norm(left)), 1e-9)
    return np.array([ahead, left, np.cross(ahead, left)])


class CarSample(NamedTuple):
    """The state of the car at one time."""

    time: float
    x: float
    y: float
    z: float
    heading: float
    pitch: float
    roll: float
    vx: float
    vy: float
    vz: float
    speed: float
    yaw_rate: float
    steer: float
    """Steering input, -1 to 1, as BeamNG reports it."""
    throttle: float
    """Throttle, 0 to 1; ``brake`` has the same range."""
    brake: float
    s: float = math.nan
    """Station in metres. The fields ``s``, ``t`` and ``outside`` are NaN until the drive sets them."""
    t: float = math.nan
    """Offset from the centre line in metres."""
    outside: float = math.nan
    """Share of the car outside its lane, 0 to 1."""


class RoadTracker:
    """Locates the car on the road: station, offset, and share outside the lane."""

    def __init__(self, road: Road, world: World, body: CarGeometry) -> None:
        self._sampled: SampledRoad = sample_road(road)
        self._lane = LanePolygon.along(road, world)
        self._underside = body.underside
        self._near = 0.0

    def place(self, x: float, y: float) -> tuple[float, float, float]:
        """Returns the station and the offset of a point, and the height of the road there."""
        sampled = self._sampled
        s, t, height = station_of(sampled.table, sampled.first, sampled.step, x, y, self._near)
        self._near = s
        return s, t, height

    def outside(self, now: CarSample, s: float) -> float:
        """Returns the share of the car's box that is outside the lane, 0 to 1; ``s`` is the car's station."""
        ch, sh = math.cos(now.heading), math.sin(now.heading)
        cp, sp = math.cos(now.pitch), math.sin(now.pitch)
        cr, sr = math.cos(now.roll), math.sin(now.roll)
        ahead = np.array([ch * cp, sh * cp])
        level, upright = np.array([-sh, ch]), np.array([-ch * sp, -sh * sp])
        left, up = cr * level + sr * upright, cr * upright - sr * level
        corners = self._underside @ np.array([ahead, left, up]) + [now.x, now.y]
        return float(self._lane.outside(corners, s))


@compiled
def station_of(
    table: FloatArray, first: float, step: float, x: float, y: float, s: float
) -> tuple[float, float, float]:
    """Returns station and offset of a point near station s, and the height of the road there."""
    at, t, height, _, _, _ = locate_on(table, first, step, x, y, s)
    return at, t, height


def car_sample(
    state: Mapping[str, Any],
    electrics: Mapping[str, Any],
    body: CarGeometry,
    lift: float,
    since: CarSample | None,
    time: float,
) -> CarSample:
    """Returns the sample for a state that BeamNG reports; ``since`` is the previous one, if any."""
    frame = frame_of(state)
    ahead, left, up = frame
    position = np.asarray(state["pos"], float) - np.asarray(body.node) @ frame
    heading = math.atan2(ahead[1], ahead[0])
    turned = 0.0
    if since is not None and time > since.time:
        turned = math.remainder(heading - since.heading, math.tau) / (time - since.time)
    arm = -np.asarray(body.node) @ frame
    velocity = np.asarray(state["vel"], float) + turned * np.array([-arm[1], arm[0], 0.0])
    level = np.array([-math.sin(heading), math.cos(heading), 0.0])
    if not (np.isfinite(position).all() and np.isfinite(velocity).all()):
        raise SimulationError("BeamNG's physics became unstable: the car has no position any more")
    return CarSample(
        time,
        float(position[0]),
        float(position[1]),
        float(position[2]) - lift,
        heading,
        math.asin(min(max(float(ahead[2]), -1.0), 1.0)),
        -math.asin(min(max(float(up @ level), -1.0), 1.0)),
        float(velocity @ ahead),
        float(velocity @ left),
        float(velocity @ up),
        float(np.linalg.norm(velocity)),
        turned,
        _number(electrics, "steering_input"),
        _number(electrics, "throttle_input"),
        _number(electrics, "brake_input"),
    )


def interpolate_samples(a: CarSample, b: CarSample, share: float) -> CarSample:
    """Interpolates between samples ``a`` and ``b`` at a fraction (0 to 1) of the time between them."""
    values = [p + share * (q - p) for p, q in zip(a, b, strict=True)]
    values[4] = a.heading + share * math.remainder(b.heading - a.heading, math.tau)
    return CarSample(*values)


def _number(values: Mapping[str, Any], name: str) -> float:
    value = values.get(name, 0.0)
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else 0.0
