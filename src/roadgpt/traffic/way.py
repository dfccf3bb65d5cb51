"""Defines the Way: a line on the ground that an actor follows."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.traffic.actor import FloatArray

if TYPE_CHECKING:
    from roadgpt.road import Road, World

SPACING = 0.5  # m between the points of a way
LEAST_STRETCH = 0.2  # lower bound of the metres beside a way per metre of it, on the inside of a bend


@dataclass(frozen=True, eq=False)
class Way:
    """A line on the ground that an actor follows, such as the middle of a lane, or straight across a road."""

    points: FloatArray
    """Shape (n, 4): x, y, z and heading (unwrapped) about every SPACING metres."""
    meets: tuple[float, float] | None = None
    """Where the way meets the tested car's: the station along this way, and along the tested car's road."""
    road_stations: FloatArray | None = None
    """For the way along the tested car's own lane: the stations of the points along the tested car's road."""

    @classmethod
    def along(cls, road: "Road", world: "World") -> "Way":
        """Returns the middle of the lane that the tested car is to follow."""
        s = np.linspace(0.0, road.length, max(int(road.length / SPACING), 1) + 1)
        xyz = road.at(s, world.profile_of(road).middle(s))
        heading = np.unwrap(np.arctan2(*np.gradient(xyz[:, :2], axis=0).T[::-1]))
        return cls(np.column_stack([xyz, heading]), road_stations=s)

    @cached_property
    def stations(self) -> FloatArray:
        """The stations of the points in metres, from 0 to ``length``."""
        steps = np.hypot(*np.diff(self.points[:, :2], axis=0).T)
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def length(self) -> float:
        """Length in metres."""
        return float(self.stations[-1])

    @cached_property
    def _curvature(self) -> FloatArray:
        return np.asarray(np.gradient(self.points[:, 3], self.stations))

    def pose(self, s: float, t: float = 0.0) -> FloatArray:
        """Returns x, y, z and heading at a station, ``t`` metres to the left of the way. Before its begin
        and after its end it goes straight on."""
        x, y, z, heading = (np.interp(s, self.stations, column) for column in self.points.T)
        beyond = s - float(np.clip(s, 0.0, self.length))
        cos, sin = np.cos(heading), np.sin(heading)
        return np.array([x + beyond * cos - t * sin, y + beyond * sin + t * cos, z, heading])

    def stretch(self, s: float, t: float) -> float:
        """Returns how many metres somebody drives ``t`` metres to the left of the way per metre of it."""
        bend = float(np.interp(s, self.stations, self._curvature, left=0.0, right=0.0))
        return max(1.0 - bend * t, LEAST_STRETCH)
