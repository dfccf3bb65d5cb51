"""Defines the Line: how drivers, actors, the traffic and the verdict look at a way on the ground.

A Line is the middle of a lane, a way straight across a road, or one that a car has driven. Its station ``s``
is in metres along it, its offset ``t`` in metres to its left. Before its begin and after its end it goes
straight on, up or down as there."""

import math
from bisect import bisect_right
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import groupby
from typing import Any, Self

import numpy as np
from scipy.spatial import cKDTree

from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import LEAST_STRETCH, Array
from roadgpt.network.lanes import lanes_of
from roadgpt.network.road_or_route import is_route
from roadgpt.road import Road, World
from roadgpt.road.speed_profile import GRAVITY

SPACING = 0.5  # m between the points of a line
GRIP, EASE = 7.0, 3.0  # m/s^2: the most sideways in a bend, and with what actors slow down before it
GAINS = 2.0  # m/s^2, with which they gain speed behind it
SIDEWAYS, SLOWING = 0.75, 0.66  # shares of the friction circle that both take at most
SMOOTHED = 9  # points that a curvature and a slope are averaged over
LEAST_GRIP = 0.1  # m/s^2, with which one counts where there is less; ours


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes along a Line, and across it; metres, radians, m/s."""

    along: Array
    t: Array
    heading: Array
    """Against that of the line."""
    size: Array
    """Lengths and widths, (..., 2)."""
    velocity: Array
    """Along and across, (..., 2)."""

    def __getitem__(self, rows: Any) -> "Boxes":
        return Boxes(*(part[rows] for part in vars(self).values()))

    @property
    def reach(self) -> tuple[Array, Array]:
        """Half of what the box covers along and across."""
        c, s = np.abs(np.cos(self.heading)), np.abs(np.sin(self.heading))
        length, width = self.size[..., 0] / 2, self.size[..., 1] / 2
        return length * c + width * s, length * s + width * c


@dataclass(frozen=True, eq=False)
class Line:
    """A line on the ground, and the strip along it."""

    points: Array
    """Shape (n, 4): x, y, z and heading (unwrapped) about every SPACING metres."""
    width: Array | float = 0.0
    """The width of the strip, at each point where it is not the same everywhere."""
    road_stations: Array | None = None
    """Of a line along the tested car's road, the stations of the points on it."""
    friction: Array | float = 1.0
    """The friction, at each point where it is not the same everywhere."""
    aside: Array | None = None
    """How far the points are to the left of the lane of the first one, by changes of lanes; None: nowhere."""
    meets: tuple[float, float] | None = None
    """Where the line meets the tested car's: the station along this one, and along the tested car's road."""

    @classmethod
    def through(cls, xyz: Array, width: Array | float = 0.0, road_stations: Array | None = None) -> Self:
        """Returns the line through points ``(n, 3)``; each heading is that from the point before to that
        behind."""
        dx, dy = np.gradient(xyz[:, :2], axis=0).T
        return cls(np.column_stack([xyz, np.unwrap(np.arctan2(dy, dx))]), width, road_stations)

    @cached_property
    def stations(self) -> Array:
        """The stations of the points in metres, from 0 to ``length``."""
        steps = np.hypot(*np.diff(self.points[:, :2], axis=0).T)
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def length(self) -> float:
        """Length in metres."""
        return float(self.stations[-1])

    @cached_property
    def curvature(self) -> Array:
        """The curvature of the line at its points in 1/m, positive to the left."""
        return np.asarray(np.gradient(self.points[:, 3], self.stations))

    def from_road(self, s: float) -> float:
        """Returns the station along the line of a station of the tested car's road."""
        assert self.road_stations is not None
        return float(np.interp(s, self.road_stations, self.stations))

    def to_road(self, s: float) -> float:
        """Returns the station of the tested car's road of a station along the line."""
        assert self.road_stations is not None
        return float(np.interp(s, self.stations, self.road_stations))

    def width_at(self, s: Array | float) -> Array:
        """Returns widths of the strip in metres."""
        return np.asarray(np.interp(s, self.stations, np.broadcast_to(self.width, self.stations.shape)))

    def pose(self, s: float, t: float = 0.0) -> tuple[float, float, float, float]:
        """Returns x, y, z and heading at a station and an offset."""
        x, y, z, heading, *_ = self._at(s)
        beyond = s - min(max(s, 0.0), self.length)
        if beyond:
            inside = self._at(s - beyond - math.copysign(SPACING, beyond))
            z += abs(beyond) / SPACING * (z - inside[2])
        cos, sin = math.cos(heading), math.sin(heading)
        return x + beyond * cos - t * sin, y + beyond * sin + t * cos, z, heading

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.points[:, :2])

    @cached_property
    def _frames(self) -> Array:
        """x, y, heading, station and curvature of each point; the line is straight before and behind it."""
        bends = np.r_[0.0, self.curvature[1:-1], 0.0]
        return np.column_stack([self.points[:, [0, 1, 3]], self.stations, bends])

    def locate(self, x: Array | float, y: Array | float) -> tuple[Array, Array]:
        """Returns the stations and offsets of places, as seen from the nearest points of the line and
        corrected for its curvature there; NaN of NaN."""
        places = np.stack([x, y], axis=-1)
        near = self._tree.query(np.where(np.isnan(places), 0.0, places))[1]
        x0, y0, heading, s, bend = self._frames[near].T
        c, n, dx, dy = np.cos(heading), np.sin(heading), x - x0, y - y0
        ahead, t = dx * c + dy * n, dy * c - dx * n
        stretch = np.maximum(1 - bend * t, LEAST_STRETCH)
        return s + ahead / stretch, t - bend * ahead**2 / (2 * stretch)

    def boxes(self, states: Array, size: Array, slip: Array | float = 0.0) -> Boxes:
        """Returns boxes from their states (n, 5): x, y, z, heading and speed. ``slip`` is that of their
        motion against their heading."""
        x, y, _, heading, speed = states.T
        along, t = self.locate(x, y)
        way = wrap_angle(heading - np.interp(along, self.stations, self.points[:, 3]))
        velocity = speed[:, None] * np.stack([np.cos(way + slip), np.sin(way + slip)], axis=-1)
        return Boxes(along, t, way, np.broadcast_to(size, (len(x), 2)), velocity)

    def holds(self, boxes: Boxes) -> Any:
        """Whether a box reaches into the strip."""
        return np.abs(boxes.t) - boxes.reach[1] < self.width_at(boxes.along) / 2

    @cached_property
    def _rows(self) -> list[list[float]]:
        """The points with the curvature of the line there, the square of the greatest speed, along the line
        and against it, from which one still slows down for the bends, the radius of the friction circle and
        the part of gravity that pulls back along the line, both in m/s^2."""
        s, bends = self.stations, self.curvature
        slope = np.arctan(_smoothed(np.gradient(self.points[:, 2], s)))
        circle, falls = GRAVITY * np.cos(slope) * self.friction, GRAVITY * np.sin(slope)
        fastest = np.minimum(GRIP, SIDEWAYS * circle) / np.maximum(_smoothed(np.abs(bends)), 1e-6)
        ease = np.clip(SLOWING * circle - np.abs(falls), LEAST_GRIP, EASE)
        rise = np.concatenate([[0.0], np.cumsum(2 * ease[1:] * np.diff(s))])
        along = np.minimum.accumulate((fastest + rise)[::-1])[::-1] - rise
        against = np.minimum.accumulate(fastest - rise) + rise
        columns = [self.points, bends, along, against, circle, falls]
        rows: list[list[float]] = np.column_stack(columns).tolist()
        return rows

    @cached_property
    def _places(self) -> list[float]:
        return [*map(float, self.stations)]

    def _at(self, s: float) -> list[float]:
        places = self._places
        n = min(max(bisect_right(places, s) - 1, 0), len(places) - 2)
        share = min(max((s - places[n]) / (places[n + 1] - places[n]), 0.0), 1.0)
        before, after = self._rows[n : n + 2]
        return [a + share * (b - a) for a, b in zip(before, after, strict=True)]

    def before(self, end: float, speed: float, seconds: float) -> float:
        """Returns how many metres before a station somebody is so many seconds earlier who drives along the
        line with this speed, or as fast as its bends allow."""
        fastest = np.sqrt([row[5] for row in self._rows])
        if fastest[self.stations <= end].min(initial=math.inf) >= speed or seconds <= 0 or speed <= 0:
            return speed * seconds
        s = np.linspace(0.0, end, int(max(end, SPACING) / SPACING) + 2)
        square = np.minimum(np.interp(s, self.stations, fastest), speed) ** 2
        gains = 2 * min(GAINS, SLOWING * min(row[7] for row in self._rows))
        pace = np.sqrt(np.minimum.accumulate(square - gains * s) + gains * s)
        times = np.concatenate([[0.0], np.cumsum((2 * np.diff(s) / (pace[1:] + pace[:-1]))[::-1])])
        return float(np.interp(seconds, times, end - s[::-1])) + speed * max(seconds - float(times[-1]), 0.0)

    def bend(self, s: float, t: float, forward: int) -> tuple[float, float]:
        """Returns how many metres somebody drives ``t`` metres to the left of the line per metre of it, and
        the greatest speed there in m/s, along the line or, with ``forward`` -1, against it."""
        bend, along, against = self._at(s)[4:7]
        stretch = max(1.0 - bend * t, LEAST_STRETCH) if 0.0 < s < self.length else 1.0
        return stretch, math.sqrt((along if forward > 0 else against) * stretch)

    def to_lane(self, s: float) -> float:
        """Returns how far to the left the middle of the nearest lane is, where the line changes lanes."""
        if self.aside is None:
            return 0.0
        here, kept = float(np.interp(s, self.stations, self.aside)), np.abs(np.diff(self.aside)) < 1e-6
        middles = self.aside[:-1][kept]
        return float(middles[np.abs(middles - here).argmin()]) - here

    def room(self, s: float, v: float, aside: float = 0.0) -> tuple[float, float, float]:
        """Returns what the friction circle leaves at a station in m/s^2 for a change of speed, beside what
        the bend takes at a speed and ``aside``; what it leaves sideways beside the bend; and how much gravity
        pulls back along the line."""
        bend, _, _, circle, falls = self._at(s)[4:]
        taken = v * v * abs(bend)
        left = math.sqrt(max(circle**2 - (taken + aside) ** 2, 0.0))
        return left, max(circle - taken, LEAST_GRIP), falls


@lru_cache(maxsize=4)
def driven_line(road: Road, world: World) -> Line:
    """Returns the middle of the lane that the tested car is to follow; the same Line for the same road."""
    s, profile = np.linspace(0.0, road.length, max(int(road.length / SPACING), 1) + 1), world.profile_of(road)
    line = Line.through(road.at(s, profile.middle(s)), profile.width(s), s)
    aside, legs = np.zeros(len(s)), enumerate(road.legs if is_route(road) else ())
    for _, group in groupby(legs, key=lambda each: each[1].road):
        (first, leg), *more = group
        if is_route(road) and more:  # the lane is changed on this road
            own = (s >= road.starts[first]) & (s <= road.starts[more[-1][0] + 1])
            left = lanes_of(road.network)[leg].locate(*line.points[own, :2].T)[1]
            aside[own] += left
            aside[own.nonzero()[0][-1] + 1 :] += left[-1]
    friction = np.array([world.friction_at(each) for each in s.tolist()])
    return replace(line, friction=friction, aside=aside if aside.any() else None)


def _smoothed(values: Array) -> Array:
    padded = np.pad(values, SMOOTHED // 2, mode="edge")
    return np.convolve(padded, np.full(SMOOTHED, 1 / SMOOTHED), "valid")
