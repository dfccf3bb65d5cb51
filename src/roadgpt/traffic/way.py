"""Defines the Way: a line on the ground that an actor follows."""

import math
from bisect import bisect_right
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby
from typing import TYPE_CHECKING, Self

import numpy as np

from roadgpt.geometry.curve import LEAST_STRETCH
from roadgpt.network import is_route
from roadgpt.network.lanes import lanes_of
from roadgpt.road.speed_profile import GRAVITY
from roadgpt.traffic.actor import FloatArray

if TYPE_CHECKING:
    from roadgpt.road import Road, World

SPACING = 0.5  # m between the points of a way
GRIP, EASE = 7.0, 3.0  # m/s^2: the most sideways in a bend, and with what actors slow down before it
GAINS = 2.0  # m/s^2, with which they gain speed behind it
SIDEWAYS, SLOWING = 0.75, 0.66  # shares of the friction circle that both take at most
SMOOTHED = 9  # points that a curvature and a slope are averaged over
LEAST_GRIP = 0.1  # m/s^2, with which one counts where there is less; ours


@dataclass(frozen=True, eq=False)
class Way:
    """A line on the ground that an actor follows, such as the middle of a lane, or straight across a road."""

    points: FloatArray
    """Shape (n, 4): x, y, z and heading (unwrapped) about every SPACING metres."""
    meets: tuple[float, float] | None = None
    """Where the way meets the tested car's: the station along this way, and along the tested car's road."""
    road_stations: FloatArray | None = None
    """For the way along the tested car's own lane: the stations of the points along the tested car's road."""
    friction: FloatArray | float = 1.0
    """The friction, at each point where it is not the same everywhere."""
    aside: FloatArray | None = None
    """How far the points are to the left of the lane of the first one, by changes of lanes; None: nowhere."""

    @classmethod
    def through(cls, xyz: FloatArray, road_stations: FloatArray | None = None) -> Self:
        """Returns the way through points ``(n, 3)``; each heading is that from the point before to that
        behind."""
        dx, dy = np.gradient(xyz[:, :2], axis=0).T
        return cls(np.column_stack([xyz, np.unwrap(np.arctan2(dy, dx))]), None, road_stations)

    @classmethod
    def along(cls, road: "Road", world: "World") -> Self:
        """Returns the middle of the lane that the tested car is to follow."""
        s = np.linspace(0.0, road.length, max(int(road.length / SPACING), 1) + 1)
        way = cls.through(road.at(s, world.profile_of(road).middle(s)), s)
        aside, legs = np.zeros(len(s)), enumerate(road.legs if is_route(road) else ())
        for _, group in groupby(legs, key=lambda each: each[1].road):
            (first, leg), *more = group
            if is_route(road) and more:  # the lane is changed on this road
                own = (s >= road.starts[first]) & (s <= road.starts[more[-1][0] + 1])
                left = lanes_of(road.network)[leg].locate(*way.points[own, :2].T)[1]
                aside[own] += left
                aside[own.nonzero()[0][-1] + 1 :] += left[-1]
        friction = np.array([world.friction_at(each) for each in s.tolist()])
        return replace(way, friction=friction, aside=aside if aside.any() else None)

    @cached_property
    def stations(self) -> FloatArray:
        """The stations of the points in metres, from 0 to ``length``."""
        steps = np.hypot(*np.diff(self.points[:, :2], axis=0).T)
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def length(self) -> float:
        """Length in metres."""
        return float(self.stations[-1])

    def from_road(self, s: float) -> float:
        """Returns the station along the way of a station of the tested car's road."""
        assert self.road_stations is not None
        return float(np.interp(s, self.road_stations, self.stations))

    def to_road(self, s: float) -> float:
        """Returns the station of the tested car's road of a station along the way."""
        assert self.road_stations is not None
        return float(np.interp(s, self.stations, self.road_stations))

    @cached_property
    def _rows(self) -> list[list[float]]:
        """The points with the curvature of the way there, the square of the greatest speed, along the way and
        against it, from which one still slows down for the bends, the radius of the friction circle and the
        part of gravity that pulls back along the way, both in m/s^2."""
        s, bends = self.stations, np.gradient(self.points[:, 3], self.stations)
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

    def pose(self, s: float, t: float = 0.0) -> tuple[float, float, float, float]:
        """Returns x, y, z and heading at a station, ``t`` metres to the left of the way. Before its begin
        and after its end it goes straight on, up or down as there."""
        x, y, z, heading, *_ = self._at(s)
        beyond = s - min(max(s, 0.0), self.length)
        if beyond:
            inside = self._at(s - beyond - math.copysign(SPACING, beyond))
            z += abs(beyond) / SPACING * (z - inside[2])
        cos, sin = math.cos(heading), math.sin(heading)
        return x + beyond * cos - t * sin, y + beyond * sin + t * cos, z, heading

    def locate(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, ...]:
        """Returns the stations of places, how far they are to the left, and the heading there, as seen from
        the nearest points of the way."""
        dx, dy = (n - np.reshape(to, (-1, 1)) for n, to in zip(self.points.T, (x, y), strict=False))
        nearest = (dx**2 + dy**2).argmin(axis=1)
        heading = self.points[nearest, 3]
        dx, dy = x - self.points[nearest, 0], y - self.points[nearest, 1]
        c, s = np.cos(heading), np.sin(heading)
        return self.stations[nearest] + dx * c + dy * s, dy * c - dx * s, heading

    def boxes(self, rows: FloatArray) -> tuple[FloatArray, ...]:
        """Returns how boxes lie to the way, from their states, lengths and widths ``(n, 7)``: station, place
        to its left, half of what they take along and across it, and speed along it and to the left."""
        x, y, _, heading, speed, length, width = rows.T
        s, left, ahead = self.locate(x, y)
        cos, sin = np.cos(heading - ahead), np.sin(heading - ahead)
        half, wide = length * abs(cos) + width * abs(sin), width * abs(cos) + length * abs(sin)
        return s, left, half / 2, wide / 2, speed * cos, speed * sin

    def before(self, end: float, speed: float, seconds: float) -> float:
        """Returns how many metres before a station somebody is so many seconds earlier who drives along the
        way with this speed, or as fast as its bends allow."""
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
        """Returns how many metres somebody drives ``t`` metres to the left of the way per metre of it, and
        the greatest speed there in m/s, along the way or, with ``forward`` -1, against it."""
        bend, along, against = self._at(s)[4:7]
        stretch = max(1.0 - bend * t, LEAST_STRETCH) if 0.0 < s < self.length else 1.0
        return stretch, math.sqrt((along if forward > 0 else against) * stretch)

    def room(self, s: float, v: float, aside: float = 0.0) -> tuple[float, float, float]:
        """Returns what the friction circle leaves at a station in m/s^2 for a change of speed, beside what
        the bend takes at a speed and ``aside``; what it leaves sideways beside the bend; and how much gravity
        pulls back along the way."""
        bend, _, _, circle, falls = self._at(s)[4:]
        taken = v * v * abs(bend)
        left = math.sqrt(max(circle**2 - (taken + aside) ** 2, 0.0))
        return left, max(circle - taken, LEAST_GRIP), falls


def _smoothed(values: FloatArray) -> FloatArray:
    padded = np.pad(values, SMOOTHED // 2, mode="edge")
    return np.convolve(padded, np.full(SMOOTHED, 1 / SMOOTHED), "valid")
