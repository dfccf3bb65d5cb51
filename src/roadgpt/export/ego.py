"""Defines the ego vehicle of exported files: its dimensions, start and goal, and poses during a drive.

The dimensions are those of BeamNG's ETK 800, a mid-size saloon, which the built-in simulator also uses."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.language.names import ActorKind
from roadgpt.network import RoadEnd
from roadgpt.road import Road
from roadgpt.road.road import GOAL, START


@dataclass(frozen=True, eq=False)
class Trajectories:
    """How the others on the road moved during a drive."""

    names: tuple[str, ...]
    kinds: tuple[ActorKind, ...]
    sizes: Array
    """Lengths, widths and heights of their boxes in metres, shape (n, 3)."""
    time: Array
    """Times of the samples in s, shape (k,), increasing."""
    states: Array
    """Shape (k, n, 5): x, y and z of the middle of the box on the ground, heading (unwrapped) and speed; NaN
    while somebody is not there. Between two samples everybody moves evenly along a straight line."""


@dataclass(frozen=True, eq=False)
class Poses:
    """Poses of a car over time. Every array has shape ``(n,)`` with n >= 2, and the times increase.

    Positions are those of the car's centre of gravity, in metres. Angles are in radians: heading 0 along +x
    and counter-clockwise, pitch positive nose up, roll positive left side up. Time is in s, speed in m/s.

    Raises:
        UsageError: The arrays differ in length or contain a number that is not finite, or the times do not
            increase."""

    time: Array
    x: Array
    y: Array
    z: Array
    heading: Array
    pitch: Array
    roll: Array
    speed: Array
    others: Trajectories | None = None
    """The others on the road, from the first of these times on; None if there was nobody."""
    lights: Mapping[int, Sequence[tuple[float, Mapping[RoadEnd, str]]]] = field(default_factory=dict)
    """The traffic lights that ran, by the id of their junction: what they show from the first of these times
    on until that begins anew, as seconds and "green", "yellow" or "red" for each arm."""

    def __post_init__(self) -> None:
        columns = [getattr(self, name) for name in self.names()]
        same = self.time.ndim == 1 and len(self.time) > 1 and {c.shape for c in columns} == {self.time.shape}
        if not (same and np.isfinite(columns).all() and (np.diff(self.time) > 0).all()):
            raise UsageError(
                "these poses cannot be exported; give arrays of one length, two values or more, all finite, "
                "with rising times"
            )

    @classmethod
    def names(cls) -> list[str]:
        """Returns the names of the arrays."""
        return [each.name for each in fields(cls) if each.name not in ("others", "lights")]

    @classmethod
    def of(cls, columns: Mapping[str, ArrayLike], others: Trajectories | None = None) -> Self:
        """Returns the poses from a mapping with one column per field of this class, such as the columns of a
        Drive.

        Other columns are ignored.

        Raises:
            UsageError: A column is missing, or the columns are not valid poses."""
        missing = [name for name in cls.names() if name not in columns]
        if missing:
            raise UsageError(f"the poses have no {', '.join(missing)}; give those columns as well")
        arrays: dict[str, Any] = {name: np.asarray(columns[name], float) for name in cls.names()}
        return cls(**arrays, others=others)

    def __len__(self) -> int:
        return len(self.time)


@dataclass(frozen=True)
class EgoVehicle:
    """Dimensions of the ego vehicle in metres, its mass in kilograms, and its greatest steering angle."""

    length: float = 4.70
    width: float = 1.86
    height: float = 1.44
    mass: float = 1700.0
    front_axle: float = 1.36
    """Position of the front axle in metres ahead of the centre of gravity; negative values are behind it."""
    rear_axle: float = -1.47
    middle: float = -0.10  # position of the middle of the car in metres ahead of the centre of gravity
    gravity_height: float = 0.56
    track: float = 1.58
    wheel: float = 0.66  # wheel diameter in metres
    lock: float = 0.62  # greatest steering angle of the front wheels in radians


CAR = EgoVehicle()


def start_of(road: Road) -> float:
    """Returns the station of the car's centre of gravity at the start of a drive, in metres."""
    return min(START, road.length / 2)


def goal_of(road: Road) -> float:
    """Returns the station in metres at which a drive ends. It is always greater than ``start_of``."""
    return max(road.length - GOAL, (start_of(road) + road.length) / 2)
