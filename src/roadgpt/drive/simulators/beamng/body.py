"""The car's body: what BeamNG tells of its reference node becomes the pose of its centre of gravity."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from roadgpt.drive.compiled import compiled
from roadgpt.drive.drive import Box, FloatArray
from roadgpt.drive.lane import Lane
from roadgpt.drive.ribbon import Ribbon, place_on, ribbon_of
from roadgpt.errors import SimulationError

if TYPE_CHECKING:
    from roadgpt.road import Road, World

LOCK = 0.6  # rad, of the front wheels, where nobody steered to find out
# Of a saloon: how far its front axle stands ahead of its box's middle, as a share of the length, and what
# its front tyres span, as a share of the width. BeamNG tells of no wheel: the embedded car's shares.
AXLE, TYRES = 0.31, 0.97
SIZES = (1.0, 12.0), (0.5, 4.0)  # m, length and width that a car can have


class Body(NamedTuple):
    """Measured once per car, while it stands; in metres ahead, left and up of the centre of gravity."""

    node: tuple[float, float, float]
    """Of the reference node, whose position BeamNG tells."""
    rear: float
    front: float
    half: float
    """Half the width."""
    under: float
    """Of the box's underside; negative."""
    height: float
    """Of the centre of gravity above the road."""

    @classmethod
    def measured(
        cls,
        state: Mapping[str, Any],
        gravity: Sequence[float],
        corners: Mapping[str, Sequence[float]],
        ground: FloatArray,
    ) -> "Body":
        """From a poll of a standing car, and the point of the road that it was put on.

        Raises:
            SimulationError: what came is no car.
        """
        frame = frame_of(state)
        centre = np.asarray(gravity, float)
        node = frame @ (np.asarray(state["pos"], float) - centre)
        box = np.array([frame @ (np.asarray(corner, float) - centre) for corner in corners.values()])
        (rear, _, under), (front, _, _) = box.min(axis=0), box.max(axis=0)
        half = float(np.ptp(box[:, 1])) / 2
        fits = SIZES[0][0] <= front - rear <= SIZES[0][1] and SIZES[1][0] <= 2 * half <= SIZES[1][1]
        if not (fits and np.isfinite(box).all() and np.abs(node).max() < SIZES[0][1]):
            raise SimulationError(
                f"BeamNG tells of a car {front - rear:.1f} m by {2 * half:.1f} m; check ROADGPT_BEAMNG_MODEL"
            )
        height = float(frame[2] @ (centre - ground))
        place = (float(node[0]), float(node[1]), float(node[2]))
        return cls(place, float(rear), float(front), half, float(under), height)

    def box(self, lock: float) -> Box:
        """As a Drive has it."""
        length, width, ahead = self.front - self.rear, 2 * self.half, (self.front + self.rear) / 2
        wheels = (ahead + AXLE * length, TYRES * width)
        return Box(length, width, ahead, lock, *wheels, height=self.height, under=-self.under)

    @property
    def underside(self) -> FloatArray:
        """The lower corners, shape (4, 3), counter-clockwise seen from above."""
        a, b, h, u = self.rear, self.front, self.half, self.under
        return np.array([[a, -h, u], [b, -h, u], [b, h, u], [a, h, u]])


def frame_of(state: Mapping[str, Any]) -> FloatArray:
    """Rows: unit vectors ahead, to the left and up, of a polled state.

    Raises:
        SimulationError: they are none, as after an accident of the physics.
    """
    ahead, up = np.asarray(state["dir"], float), np.asarray(state["up"], float)
    size = float(np.linalg.norm(ahead))
    if not (np.isfinite(ahead).all() and np.isfinite(up).all() and size > 0.1):
        raise SimulationError("BeamNG's physics broke down: the car has no direction any more")
    ahead = ahead / size
    left = np.cross(up, ahead)
    left = left / max(float(np.linalg.norm(left)), 1e-9)
    return np.array([ahead, left, np.cross(ahead, left)])


class Moment(NamedTuple):
    """The car at one sample."""

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
    """Input, -1 to 1, as BeamNG has it."""
    throttle: float
    brake: float


class Track:
    """The road under the car: stations, offsets, share outside the lane."""

    def __init__(self, road: "Road", world: "World", body: Body) -> None:
        self._ribbon: Ribbon = ribbon_of(road)
        self._lane = Lane.along(road, world)
        self._underside = body.underside
        self._near = 0.0

    def begin(self, s: float) -> None:
        """Look for the car near this station first."""
        self._near = s

    def place(self, x: float, y: float) -> tuple[float, float, float]:
        """Station, offset, height of the road there."""
        ribbon = self._ribbon
        s, t, height = station_of(ribbon.table, ribbon.first, ribbon.step, x, y, self._near)
        self._near = s
        return s, t, height

    def outside(self, now: Moment, s: float) -> float:
        """Share of the box outside the right lane."""
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
    """Station, offset and height of the road at a point, looked for near s."""
    at, t, height, _, _ = place_on(table, first, step, x, y, s)
    return at, t, height


def moment_of(
    state: Mapping[str, Any],
    electrics: Mapping[str, Any],
    body: Body,
    lift: float,
    since: Moment | None,
    time: float,
) -> Moment:
    """What a poll tells, at the centre of gravity; ``since`` is the sample before."""
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
        raise SimulationError("BeamNG's physics broke down: the car is nowhere any more")
    return Moment(
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


def between(a: Moment, b: Moment, share: float) -> Moment:
    """On the way from one sample to the next."""
    values = [p + share * (q - p) for p, q in zip(a, b, strict=True)]
    values[4] = a.heading + share * math.remainder(b.heading - a.heading, math.tau)
    return Moment(*values)


def _number(values: Mapping[str, Any], name: str) -> float:
    value = values.get(name, 0.0)
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else 0.0
