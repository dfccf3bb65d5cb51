"""Makes films of one or two drives, from behind the car or from a hood camera. Main function: ``film_of``.

The frames depend only on the Run and the settings. Threads draw the frames, and PyAV encodes them.
"""

import math
import os
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.network import refuse_without_route
from roadgpt.report.film.encoding import encoder, write_film
from roadgpt.report.film.glyphs import Frame
from roadgpt.report.film.overlay import Overlay
from roadgpt.report.film.trip import Trip
from roadgpt.run import Run
from roadgpt.scene import Camera, Mount, Scene

__all__ = ["Film", "Settings", "View", "film_of", "split_film"]

View = Literal["chase", "bonnet", "both"]
Watch = Callable[[Iterator[Frame], int], Iterator[Frame]]
"""Takes all frames and their number, and yields the frames; used to show progress."""

MOST = 2  # roads in one film
HOLD = 2.0  # s that the last picture stays, with the outcome
SEAM = 4  # pixels between two pictures
SLOWEST, FASTEST = 1, 120  # frames per second
SMALLEST, LARGEST = 64, 3840  # pixels, a side of a picture
FIELDS: dict[str, float] = {"chase": math.radians(62), "bonnet": math.radians(72)}


@dataclass(frozen=True)
class Settings:
    """The size, speed and length of a film.

    Raises:
        UsageError: a number is out of range.
    """

    width: int = 640
    """Width of each picture in the film, pixels."""
    height: int = 360
    fps: int = 25
    begin: float = 0.0
    """Seconds from the start of the drive to the start of the film."""
    seconds: float | None = None
    """Largest number of seconds of the drive that the film shows; None for all of it."""

    def __post_init__(self) -> None:
        sides = (self.width, self.height)
        if any(side % 2 or not SMALLEST <= side <= LARGEST for side in sides):
            raise UsageError(
                f"a film of {self.width}x{self.height} pixels cannot be made; give even numbers from "
                f"{SMALLEST} to {LARGEST}, such as 640x360"
            )
        if not SLOWEST <= self.fps <= FASTEST:
            raise UsageError(f"a film cannot have {self.fps} pictures a second; give {SLOWEST} to {FASTEST}")
        if not self.begin >= 0 or (self.seconds is not None and not self.seconds > 0):
            raise UsageError("a film begins at second 0 or later and lasts longer than nothing")


@dataclass(frozen=True, eq=False)
class Pane:
    """Renders what one camera sees at any time of a drive; several threads may call ``draw`` at once."""

    run: Run
    scene: Scene
    trip: Trip
    camera: Camera

    def draw(self, time: float) -> Frame:
        """Returns the picture at ``time`` seconds, ``(height, width, 3)``; times after the end of the drive
        give the last picture."""
        now = min(time, self.trip.duration)
        car = self.trip.car(now)
        pose = self.trip.follower(now) if self.camera.mount == "chase" else car
        frame = self.scene.render(self.camera, pose, car=None if self.run.drive is None else car)
        overlay = Overlay(self.run, self.camera.width, self.camera.height)
        overlay.lay(frame, self.trip.readout(now), time >= self.trip.duration)
        return frame


@dataclass(frozen=True, eq=False)
class Film:
    """A film of one or two roads: its Panes, in rows, and the times of its frames in seconds."""

    rows: tuple[tuple[Pane, ...], ...]
    settings: Settings
    times: tuple[float, ...]

    @classmethod
    def of(cls, runs: Sequence[Run], view: View = "chase", settings: Settings | None = None) -> "Film":
        """Returns a film of one or two Runs.

        Raises:
            UsageError: there is no Run or more than two, the view is unknown, a Run has no road, or the film
                would begin after the end of the drive.
        """
        if not 1 <= len(runs) <= MOST:
            raise UsageError(f"a film shows one road or two side by side; {len(runs)} are given")
        if view not in get_args(View):
            raise UsageError(f"there is no view '{view}'; say {', '.join(get_args(View))}")
        settings = settings or Settings()
        trips = [Trip.of(run) for run in runs]
        scenes = [Scene.of(run.road, run.world) for run in runs if run.road is not None]
        mounts: tuple[Mount, ...] = ("chase", "bonnet") if view == "both" else (view,)
        panes = [
            tuple(
                Pane(run, scene, trip, Camera(settings.width, settings.height, FIELDS[mount], mount))
                for run, scene, trip in zip(runs, scenes, trips, strict=True)
            )
            for mount in mounts
        ]
        is_wide = len(runs) == 1 and len(mounts) == 2
        rows = (panes[0] + panes[1],) if is_wide else tuple(panes)
        return cls(rows, settings, _times(max(trip.duration for trip in trips), settings))

    def __len__(self) -> int:
        return len(self.times)

    def frame(self, n: int) -> Frame:
        """Returns frame number ``n``, shape ``(height, width, 3)``, uint8."""
        time = self.times[n]
        strips = [_beside([pane.draw(time) for pane in row], axis=1) for row in self.rows]
        return _beside(strips, axis=0)

    def frames(self, threads: int | None = None) -> Generator[Frame]:
        """Yields all frames in order; threads draw the next few frames in advance."""
        count = threads or os.cpu_count() or 1
        numbers = iter(range(len(self)))
        with ThreadPoolExecutor(count) as pool:
            ahead: deque[Future[Frame]] = deque(
                pool.submit(self.frame, n) for n in islice(numbers, 2 * count)
            )
            try:
                while ahead:
                    frame = ahead.popleft().result()
                    ahead.extend(pool.submit(self.frame, n) for n in islice(numbers, 1))
                    yield frame
            finally:
                for future in ahead:
                    future.cancel()


def film_of(run: Run, path: Path | str, view: View | str = "chase", settings: Settings | None = None) -> Path:
    """Films one drive into an MP4 file, and returns the path.

    Args:
        run: the Run with the drive; if it has no drive, the camera moves along the road at a calm speed.
        path: the file, which is replaced if it exists.
        view: from behind ("chase"), from the hood camera ("bonnet"), or both side by side ("both").
        settings: size, frames per second, and which seconds of the drive.

    Raises:
        UsageError: there is nothing to film, a setting is out of range, or PyAV is missing.
        RoadGPTError: the file cannot be written.
    """
    return write([run], path, view, settings)


def split_film(
    run_a: Run, run_b: Run, path: Path | str, view: View | str = "chase", settings: Settings | None = None
) -> Path:
    """Films two drives side by side; each frame shows both at the same time after the start. See
    ``film_of``."""
    return write([run_a, run_b], path, view, settings)


def write(
    runs: Sequence[Run], path: Path | str, view: View | str = "chase", settings: Settings | None = None,
    watch: Watch | None = None,
) -> Path:  # fmt: skip
    """Films one or two Runs, and returns the path; ``watch`` may wrap the iterator of frames, for example
    to show progress.
    """
    encoder()  # before anything is drawn
    for road in (run.road for run in runs if run.road is not None):
        refuse_without_route(road, "filmed")
    film = Film.of(runs, view, settings)  # type: ignore[arg-type]
    title = " and ".join(dict.fromkeys(run.title for run in runs))
    with closing(film.frames()) as frames:
        shown = frames if watch is None else watch(frames, len(film))
        write_film(shown, Path(path), film.settings.fps, title)
    return Path(path)


def _times(duration: float, settings: Settings) -> tuple[float, ...]:
    """Returns the times of the frames; the last one is repeated if the film reaches the end of the drive."""
    if settings.begin >= duration:
        raise UsageError(f"the drive is over after {duration:.1f} s; let the film begin before that")
    wished = duration - settings.begin if settings.seconds is None else settings.seconds
    is_whole = settings.begin + wished >= duration
    last = min(settings.begin + wished, duration)
    count = max(1, int(np.floor((last - settings.begin) * settings.fps + 1e-6)))
    shown = [settings.begin + n / settings.fps for n in range(count)]
    hold = [duration] * round(HOLD * settings.fps) if is_whole else []
    return (*shown, *hold)


def _beside(pictures: list[Frame], axis: int) -> Frame:
    """Joins pictures of one size along an axis, with seams between them."""
    if len(pictures) == 1:
        return pictures[0]
    shape = list(pictures[0].shape)
    shape[axis] = SEAM
    seam = np.full(shape, 16, np.uint8)
    parts = [part for picture in pictures for part in (seam, picture)][1:]
    return np.ascontiguousarray(np.concatenate(parts, axis=axis))
