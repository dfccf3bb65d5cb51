"""A driver that sees, without anything learnt: it looks for the white lines and steers to the middle between.

    roadgpt run "a winding road" -n 3 --driver examples/vision/lane_finder.py:LaneFinder
    SPEED_KMH=40 roadgpt run ...                                    faster than its 25 km/h

For each picture: white pixels below the horizon; where they lie on the ground, if the ground is flat and the
car stands on it level (inverse perspective); the circular arc whose parallels fit those near one of the
lane's three lines, as they were seen before; pure pursuit of a point of it. Where the road ahead rises or
falls, its lines seem to spread or to come together; as much as they do so evenly, it is allowed for. What a
crest hides it cannot see. Besides the picture it looks at speed and yaw rate.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pace import WHEELBASE, SpeedControl

from roadgpt.drive import Camera, Command

FARTHEST, WIDEST = 14.0, 9.0  # m ahead and aside, of what is believed
AROUND = 1.2  # rad of a bend, at most
WHITE, GREY = 140, 45  # of 255: least brightness of a line, most difference of its colours
GATE = 0.6, 0.05  # m from where a line should be, and more per metre ahead
INSET = 0.175  # m from the carriageway's edge to the middle of an edge line
TRUST = 6.0  # m ahead, from where a pixel says less
BEFORE = np.array([0.3, 5.0, 150.0, 50.0])
"""How much what was seen before weighs, by the numbers of a LaneArc, against metres of line."""
DIFFERENCE = np.array([1e-4, 1e-5, 1e-6, 1e-5])  # for derivatives
ROUNDS = 3
NEAREST, HEADWAY = 5.0, 0.45  # m and s to the point that is pursued
TO_REAR = 1.47  # m from the centre of gravity to the rear axle
STEP = 0.02  # s

Floats = NDArray[np.float64]
Image = NDArray[np.uint8]


class LaneArc(NamedTuple):
    """The lane's middle as the car sees it: an arc from beside its centre of gravity on."""

    aside: float = 0.0
    """m to the left."""
    turned: float = 0.0
    """rad to the left, against the car."""
    bend: float = 1e-4
    """1/m, positive to the left; never nothing."""
    spread: float = 0.0
    """1/m: how much wider the lane seems to be with each metre."""

    def moved(self, way: float, turn: float) -> "LaneArc":
        """After the car has gone some metres and turned by some radians to the left."""
        aside = self.aside + way * math.sin(self.turned)
        return LaneArc(aside, self.turned + way * self.bend - turn, self.bend, self.spread)

    def at(self, way: float) -> tuple[float, float]:
        """The point of the middle after so many metres: m ahead and to the left of the car."""
        along, left = math.sin(self.bend * way) / self.bend, (1 - math.cos(self.bend * way)) / self.bend
        sin, cos = math.sin(self.turned), math.cos(self.turned)
        return along * cos - left * sin, self.aside + along * sin + left * cos

    def across(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Of points: m to the left of the middle, as wide as the lane seems there; rad around the bend."""
        sin, cos = math.sin(self.turned), math.cos(self.turned)
        ahead, left = cos * x + sin * (y - self.aside), cos * (y - self.aside) - sin * x
        off = (1 - np.hypot(self.bend * ahead, 1 - self.bend * left)) / self.bend
        around = np.arctan2(abs(self.bend) * ahead, 1 - self.bend * left)
        return off / (1 + self.spread * ahead), around


class LaneFinder:
    """Finds the lane in the picture, and follows its middle."""

    name = "lane_finder"
    camera = Camera(height=100, field_of_view=0.825, down=0.248)
    """The competition's camera, turned downwards: less sky, the same road."""

    def __init__(self, speed_kmh: float | None = None) -> None:
        """At this speed; see `SpeedControl`."""
        self.pace = SpeedControl(speed_kmh)
        self._ground = FlatGround(self.camera)

    def start(self, road, world, seed):
        """Forgets the road before; looks at nothing but the signs with the speed limit."""
        del road, seed
        self._limit, self._image = world.limits.speed_limit, None
        half = world.section.lane_width / 2
        self._lines = (INSET - half, half, 3 * half - INSET)
        self.lane = LaneArc()

    def steer(self, view):
        """Looks at each new picture; in between the lane is moved on by what the car did."""
        self.lane = self.lane.moved(view.speed * STEP, view.yaw_rate * STEP)
        if view.image is not self._image:
            self._image = view.image
            self.lane = self._ground.lane_in(view.image, self.lane, self._lines)
        x, y = self.lane.at(max(NEAREST, HEADWAY * view.speed))
        bend = 2 * y / ((x + TO_REAR) ** 2 + y**2)
        pedals = self.pace.pedals(view.speed, max(abs(bend), abs(self.lane.bend)), self._limit)
        return Command(math.atan(WHEELBASE * bend), *pedals)


class FlatGround:
    """Where each pixel of a camera lies on flat ground."""

    def __init__(self, camera: Camera) -> None:
        """Worked out once."""
        focal = camera.height / 2 / math.tan(camera.field_of_view / 2)
        right = (np.arange(camera.width) + 0.5 - camera.width / 2) / focal
        down = (np.arange(camera.height) + 0.5 - camera.height / 2) / focal
        sin, cos = math.sin(camera.down), math.cos(camera.down)
        falls = (sin + cos * down)[:, None]  # of a ray, per its length before the camera
        with np.errstate(divide="ignore"):
            reach = np.where(falls > 0.0, camera.up / falls, np.inf)
        self.ahead: Floats = camera.ahead + np.where(falls > 0, reach, 0) * (cos - sin * down[:, None])
        self.aside: Floats = -np.where(falls > 0, reach, np.inf) * right[None]
        self.ahead = np.broadcast_to(self.ahead, self.aside.shape)
        near = (falls > 0) & (self.ahead < FARTHEST)
        self.is_near = near & (np.abs(self.aside) < WIDEST)
        self.size = np.where(near, reach, 0.0) ** 3 / (camera.up * focal**2)
        """m^2 of ground in a pixel."""
        self.size = np.broadcast_to(self.size, self.aside.shape)

    def white(self, image: Image) -> NDArray[np.bool_]:
        """Pixels ``(height, width)`` that may be of a line."""
        red, green, blue = image[..., 0], image[..., 1], image[..., 2]
        darkest = np.minimum(np.minimum(red, green), blue)
        brightest = np.maximum(np.maximum(red, green), blue)
        return self.is_near & (darkest > WHITE) & (brightest - darkest < GREY)

    def lane_in(self, image: Image, before: LaneArc, lines: tuple[float, ...]) -> LaneArc:
        """The lane in a picture.

        Args:
            image: bytes, red first.
            before: the lane as it should be by what was seen before.
            lines: where its lines are: edge line, dashes, the other edge line; m to the left of its middle.
        """
        seen = self.white(image)
        x, y = self.ahead[seen], self.aside[seen]
        weight = self.size[seen] / 0.15 / (1 + (x / TRUST) ** 2)  # m of a line
        lane = before
        for _ in range(ROUNDS):
            off, around = lane.across(x, y)
            line = np.take(lines, np.abs(off[:, None] - lines).argmin(axis=1))
            known = (np.abs(off - line) < GATE[0] + GATE[1] * x) & (around < AROUND)
            kx, ky, error = x[known], y[known], (off - line)[known]
            slopes = np.empty((4, len(kx)))
            for place, step in enumerate(DIFFERENCE):
                other = LaneArc(*(np.array(lane) + step * (np.arange(4) == place)))
                slopes[place] = (other.across(kx, ky)[0] - off[known]) / step
            weighed = slopes * weight[known]
            pull = weighed @ error + BEFORE * (np.array(lane) - before * np.array([1, 1, 1, 0]))
            lane = LaneArc(*(np.array(lane) - np.linalg.solve(weighed @ slopes.T + np.diag(BEFORE), pull)))
            if abs(lane.bend) < 1e-4:
                lane = lane._replace(bend=1e-4)
        return lane

    def marked(self, image: Image, lane: LaneArc) -> Image:
        """The picture with white pixels in red and the lane's middle in blue: what the driver sees."""
        out = image.copy()
        out[self.white(image)] = (230, 30, 30)
        off, around = lane.across(self.ahead, np.where(self.is_near, self.aside, 0.0))
        out[self.is_near & (np.abs(off) < 0.08 + 0.01 * self.ahead) & (around < AROUND)] = (30, 90, 255)
        return out
