"""Computes the poses of car and camera, and the numbers that a film displays, for any time of a drive."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from roadgpt.errors import UsageError
from roadgpt.export.ego import CAR, calm_speed, goal_of, start_of
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.run import Run
from roadgpt.scene import Pose
from roadgpt.verdict.margin import margins

COLUMNS = ("x", "y", "z", "heading", "pitch", "roll", "steer", "speed", "brake")
STEP = 0.02  # s, time step of a trip along a road that was not driven
TURN_LAG, TILT_LAG = 0.30, 0.45  # s by which the camera behind the car lags behind its heading and pitch
STEEPEST = 0.35  # rad, largest pitch of the camera behind the car, even if the car tumbles
LONGEST = 3600.0  # s


class Readout(NamedTuple):
    """The numbers that a picture of a film displays."""

    speed: float
    """Speed, m/s."""
    s: float
    """Distance along the road, m."""
    margin: float | None
    """Margin in metres: how far the car could be shifted sideways before it fails; None without a drive."""
    outside: float = 0.0
    """Share of the car that is outside its lane."""


@dataclass(frozen=True, eq=False)
class Trip:
    """The motion of car and camera; arrays have shape ``(n,)``, one value for each of ``n`` ascending
    times.
    """

    time: Array
    columns: dict[str, Array]
    """The quantities named in COLUMNS, and ``wheel``, the angle by which the wheels have rolled, rad."""
    followed: dict[str, Array]
    """``heading`` and ``pitch`` of the camera behind the car, rad."""
    s: Array
    margin: Array | None
    outside: Array | None
    """Share of the car that is outside its lane."""

    @classmethod
    def of(cls, run: Run) -> "Trip":
        """Returns the motion of a Run's drive. If there is no drive, the camera moves along the road at a
        calm speed.

        Raises:
            UsageError: the Run has no road, or its drive has fewer than two steps or numbers that are not
                finite.
        """
        if run.road is None:
            raise UsageError(f"there is no road to film: {run.description}")
        if run.drive is None:
            return cls._made(*_ride(run.road, run.world), None, None)
        drive = run.drive
        if len(drive) < 2 or not all(np.isfinite(column).all() for column in drive.columns.values()):
            raise UsageError("the drive has no motion that could be filmed; drive the road again")
        columns = {name: np.asarray(drive[name]) for name in COLUMNS}
        rolled = np.r_[0.0, np.cumsum(drive["vx"][1:] * np.diff(drive["time"]))]
        columns["wheel"] = rolled / (CAR.wheel / 2)
        margin = margins(run.road, drive, run.world)
        return cls._made(drive["time"], columns, drive["s"], margin, drive["outside"])

    @classmethod
    def _made(
        cls, time: Array, columns: dict[str, Array], s: Array, margin: Array | None, outside: Array | None
    ) -> "Trip":
        columns["heading"] = np.unwrap(columns["heading"])
        step = float(np.median(np.diff(time)))
        pitch = np.clip(columns["pitch"], -STEEPEST, STEEPEST)
        followed = {
            "heading": _lagging(columns["heading"], step / TURN_LAG),
            "pitch": _lagging(pitch, step / TILT_LAG),
        }
        return cls(time, columns, followed, s, margin, outside)

    @property
    def duration(self) -> float:
        """Duration in seconds."""
        return float(self.time[-1])

    def car(self, time: float) -> Pose:
        """Returns the pose of the car at a time in seconds; poses between two steps are interpolated."""
        return Pose(**{name: float(np.interp(time, self.time, c)) for name, c in self.columns.items()})

    def follower(self, time: float) -> Pose:
        """Returns the pose that the camera behind the car follows: the car's pose without roll, with a
        heading and a pitch that lag behind the car's."""
        late = {name: float(np.interp(time, self.time, c)) for name, c in self.followed.items()}
        return self.car(time)._replace(**late, roll=0.0)

    def readout(self, time: float) -> Readout:
        """Returns the numbers to display at a time in seconds."""
        at = int(np.clip(np.searchsorted(self.time, time + 1e-6) - 1, 0, len(self.time) - 1))
        margin = None if self.margin is None else float(self.margin[at])
        outside = 0.0 if self.outside is None else float(self.outside[at])
        return Readout(float(self.columns["speed"][at]), float(self.s[at]), margin, outside)


def _lagging(values: Array, share: float) -> Array:
    """Returns values smoothed by a first-order low-pass filter with this coefficient."""
    share = min(1.0, share)
    return np.asarray(lfilter([share], [1.0, share - 1.0], values, zi=[values[0] * (1 - share)])[0])


def _ride(road: Road, world: World) -> tuple[Array, dict[str, Array], Array]:
    """Returns a ride along the middle of the driven lane at a constant speed, from the start to the goal."""
    speed = calm_speed(road, world)
    way = goal_of(road) - start_of(road)
    if way / speed > LONGEST:
        raise UsageError(f"a film of {way / speed / 60:.0f} minutes is too long; give a shorter road")
    time = np.arange(0.0, max(way / speed, 2 * STEP), STEP)
    s = np.minimum(start_of(road) + speed * time, road.length)
    profile = world.profile_of(road)
    place, heading, grade = road.at(s, profile.middle(s)), road.heading(s), road.grade(s)
    level = np.zeros_like(s)
    columns = {
        "x": place[:, 0], "y": place[:, 1], "z": place[:, 2] + CAR.gravity_height,
        "heading": heading, "pitch": np.arctan(grade), "roll": profile.superelevation(s), "steer": level,
        "speed": np.full_like(s, speed), "brake": level, "wheel": level,
    }  # fmt: skip
    return time, columns, s
