"""Makes films of one or two drives, from behind the car or from a hood camera. Main function: ``write``.

The frames depend only on the Run and the settings. Threads draw the frames, and PyAV encodes them."""

import math
import os
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from matplotlib.font_manager import FontProperties, findfont
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from scipy.signal import lfilter

from roadgpt.errors import RoadGPTError, UsageError, explained, to_install
from roadgpt.export.ego import CAR, goal_of, start_of
from roadgpt.geometry.curve import Array
from roadgpt.network import refuse_without_route
from roadgpt.report import canvas
from roadgpt.run import Run
from roadgpt.run.atomic import whole_file
from roadgpt.scene import Camera, Mount, Pose, Scenery
from roadgpt.traffic.actor import bodies
from roadgpt.verdict import percent, severity
from roadgpt.verdict.oracle import margins
from roadgpt_formats.ego import calm_speed

COLUMNS = ("x", "y", "z", "heading", "pitch", "roll", "steer", "speed", "brake")
STEP = 0.02  # s, time step of a trip along a road that was not driven
TURN_LAG, TILT_LAG = 0.30, 0.45  # s by which the camera behind the car lags behind its heading and pitch
STEEPEST = 0.35  # rad, largest pitch of the camera behind the car, even if the car tumbles
LONGEST = 3600.0  # s


Readout = tuple[float, float, float | None, float]
"""The numbers that a picture displays: the speed in m/s; the distance along the road in metres; the margin in
metres by which the car could be shifted sideways before it fails, None without a drive; and the share of the
car that is outside its lane."""


@dataclass(frozen=True, eq=False)
class Trip:
    """The motion of car and camera; arrays have shape ``(n,)``, one value for each of ``n`` ascending
    times."""

    time: Array
    columns: dict[str, Array]
    """The quantities named in COLUMNS, and ``wheel``, the angle by which the wheels have rolled, rad."""
    followed: dict[str, Array]  # ``heading`` and ``pitch`` of the camera behind the car, rad
    s: Array
    margin: Array | None
    outside: Array | None  # share of the car that is outside its lane

    @classmethod
    def of(cls, run: Run) -> "Trip":
        """Returns the motion of a Run's drive, or of a camera along its road at a calm speed."""
        if run.road is None:
            raise UsageError(f"there is no road to film: {run.description}")
        if run.drive is None:
            time, columns, s = _ride(run)
            margin = outside = None
        else:
            drive = run.drive
            if len(drive) < 2 or not all(np.isfinite(column).all() for column in drive.columns.values()):
                raise UsageError("the drive has no motion that could be filmed; drive the road again")
            columns = {name: np.asarray(drive[name]) for name in COLUMNS}
            rolled = np.r_[0.0, np.cumsum(drive["vx"][1:] * np.diff(drive["time"]))]
            columns["wheel"] = rolled / (CAR.wheel / 2)
            margin = margins(run.road, drive, run.world)
            time, s, outside = drive["time"], drive["s"], drive["outside"]
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
        return float(self.columns["speed"][at]), float(self.s[at]), margin, outside


def _lagging(values: Array, share: float) -> Array:
    share = min(1.0, share)
    return np.asarray(lfilter([share], [1.0, share - 1.0], values, zi=[values[0] * (1 - share)])[0])


def _ride(run: Run) -> tuple[Array, dict[str, Array], Array]:
    road = run.road
    assert road is not None
    speed = calm_speed(road, run.world)
    way = goal_of(road) - start_of(road)
    if way / speed > LONGEST:
        raise UsageError(f"a film of {way / speed / 60:.0f} minutes is too long; give a shorter road")
    time = np.arange(0.0, max(way / speed, 2 * STEP), STEP)
    s = np.minimum(start_of(road) + speed * time, road.length)
    profile = run.world.profile_of(road)
    place, heading, grade = road.at(s, profile.middle(s)), road.heading(s), road.grade(s)
    level = np.zeros_like(s)
    columns = {
        "x": place[:, 0], "y": place[:, 1], "z": place[:, 2] + CAR.gravity_height,
        "heading": heading, "pitch": np.arctan(grade), "roll": profile.superelevation(s), "steer": level,
        "speed": np.full_like(s, speed), "brake": level, "wheel": level,
    }  # fmt: skip
    return time, columns, s


Frame = NDArray[np.uint8]
TITLE, TEXT, SMALL, LARGE = 13, 12, 10, 27  # pixels in a picture 360 high
EDGE, LINE = 10, 17  # likewise: from the border, and from line to line
LEAST = 0.5  # of all sizes, in small pictures
WHOLE = 2.0  # m of margin that fill its bar
WHITE, PALE, TROUGH, DIM = "#ffffff", "#ced4da", "#464c52", "#00000091"  # text can be read on what is dimmed


@cache
def _font(size: int, weight: str = "normal") -> ImageFont.FreeTypeFont:
    file = findfont(FontProperties(family="DejaVu Sans", weight=weight))
    return ImageFont.truetype(file, size, layout_engine=ImageFont.Layout.BASIC)


View = Literal["chase", "bonnet", "both"]
Watch = Callable[[Iterator[Frame], int], Iterator[Frame]]
"""Takes all frames and their number, and yields the frames; used to show progress."""
MOST = 2  # roads in one film
HOLD = 2.0  # s that the last picture stays, with the outcome
SEAM = 4  # pixels between two pictures
SLOWEST, FASTEST = 1, 120  # frames per second
SMALLEST, LARGEST = 64, 3840  # pixels, a side of a picture
FIELDS: dict[str, float] = {"chase": math.radians(62), "bonnet": math.radians(72)}
ENCODER = "libx264"
QUALITY, PRESET = 20, "veryfast"  # x264's scale, on which smaller is better


@dataclass(frozen=True)
class Settings:
    """The size, speed and length of a film."""

    width: int = 640  # width of each picture in the film, pixels
    height: int = 360
    fps: int = 25
    begin: float = 0.0  # seconds from the start of the drive to the start of the film
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
    scene: Scenery
    trip: Trip
    camera: Camera

    def draw(self, time: float) -> Frame:
        """Returns the picture ``(height, width, 3)`` at ``time`` seconds; after the drive, the last one."""
        now = min(time, self.trip.duration)
        car = self.trip.car(now)
        pose = self.trip.follower(now) if self.camera.mount == "chase" else car
        drive = self.run.drive
        tracks = None if drive is None else drive.others
        others = [] if tracks is None else bodies(tracks.actors, tracks.at(now))
        picture = Image.fromarray(
            self.scene.render(self.camera, pose, car=None if drive is None else car, others=others)
        )
        brush = ImageDraw.Draw(picture, "RGBA")  # colours with an opacity are blended
        self._title(brush)
        self._numbers(brush, self.trip.readout(now))
        if time >= self.trip.duration:
            self._outcome(brush)
        return np.array(picture)

    @property
    def _scale(self) -> float:
        """Factor for the sizes of text and its distances from the edges; 1 in a picture of 640 by 360."""
        return max(LEAST, min(self.camera.height / 360, self.camera.width / 440))

    def _size(self, pixels: int) -> int:
        return max(7, round(pixels * self._scale))

    def _title(self, brush: ImageDraw.ImageDraw) -> None:
        u, size = self._scale, self._size(TITLE)
        wide = (self.camera.width - 2 * EDGE * u) / canvas.POINTS
        rows = canvas.fitted(self.run.title, wide, size, True, 2).split("\n")
        brush.rectangle((0, 0, self.camera.width, (9 + LINE * len(rows)) * u), DIM)
        for k, row in enumerate(rows):
            brush.text((EDGE * u, LINE * (k + 1) * u), row, WHITE, _font(size, "bold"), "ls")

    def _numbers(self, brush: ImageDraw.ImageDraw, readout: Readout) -> None:
        (metres_per_second, s, margin, outside), u = readout, self._scale
        bold = _font(self._size(LARGE), "bold")
        text, small = _font(self._size(TEXT)), _font(self._size(SMALL))
        wide, high = 148 * u, (78 if margin is not None else 52) * u
        x, y = EDGE * u, self.camera.height - EDGE * u - high
        left, right = x + 8 * u, x + 62 * u
        brush.rectangle((x, y, x + wide, y + high), DIM)
        brush.text((left, y + 45 * u), f"at {s:.0f} of {self.run.length:.0f} m", PALE, text, "ls")
        if margin is None:  # the speed of the camera has no meaning
            brush.text((left, y + 24 * u), "not driven", WHITE, _font(self._size(TITLE), "bold"), "ls")
            return
        brush.text((right, y + 29 * u), f"{metres_per_second * 3.6:.0f}", WHITE, bold, "rs")
        brush.text((right + 6 * u, y + 29 * u), "km/h", PALE, text, "ls")
        colour = canvas.SEVERE[severity(outside)] if margin > 0 else canvas.VERMILLION
        said = f"margin {margin:.1f} m" if margin > 0 else "out of its lane"
        if outside > 0 and margin > 0:
            said += f", {percent(outside)} out"
        brush.text((left, y + 61 * u), said, WHITE, small if outside > 0 else text, "ls")
        share = float(np.clip(margin / WHOLE, 0.0, 1.0)) if margin > 0 else 1.0
        for part, shade in ((1.0, TROUGH), (share, colour)):
            brush.rectangle((left, y + 67 * u, left + (wide - 16 * u) * part, y + 71 * u), shade)

    def _outcome(self, brush: ImageDraw.ImageDraw) -> None:
        u, size, outcome = self._scale, self._size(TEXT), canvas.outcome_of(self.run)
        room = min(self.camera.width - 2 * EDGE * u, 420 * u) - 28 * u
        rows = canvas.fitted(self.run.description, room / canvas.POINTS, size, lines=3).split("\n")
        text, bold = _font(size), _font(self._size(LARGE), "bold")
        if bold.getlength(outcome) > room:
            bold = _font(size, "bold")
        colour = canvas.OUTCOMES.get(outcome, canvas.INK)
        wide = max(bold.getlength(outcome), *map(text.getlength, rows)) + 28 * u
        middle, y = self.camera.width / 2, self.camera.height * 0.155
        left, right = middle - wide / 2, middle + wide / 2
        brush.rectangle((left, y, right, y + (52 + LINE * len(rows)) * u), WHITE)
        brush.rectangle((left, y, right, y + 38 * u), colour)
        brush.text((middle, y + 29 * u), outcome, canvas.LETTERS.get(colour, WHITE), bold, "ms")
        for k, row in enumerate(rows):
            brush.text((middle, y + (38 + 5 + LINE * (k + 0.75)) * u), row, canvas.INK, text, "ms")


@dataclass(frozen=True, eq=False)
class Film:
    """A film of one or two roads: its Panes, in rows, and the times of its frames in seconds."""

    rows: tuple[tuple[Pane, ...], ...]
    settings: Settings
    times: tuple[float, ...]

    @classmethod
    def of(cls, runs: Sequence[Run], view: View = "chase", settings: Settings | None = None) -> "Film":
        """Returns a film of one or two Runs."""
        if not 1 <= len(runs) <= MOST:
            raise UsageError(f"a film shows one road or two side by side; {len(runs)} are given")
        if view not in get_args(View):
            raise UsageError(f"there is no view '{view}'; say {', '.join(get_args(View))}")
        settings = settings or Settings()
        trips = [Trip.of(run) for run in runs]
        scenes = [Scenery.of(run.road, run.world) for run in runs if run.road is not None]
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


def write(
    runs: Sequence[Run], path: Path | str, view: View | str = "chase", settings: Settings | None = None,
    watch: Watch | None = None,
) -> Path:  # fmt: skip
    """Films one drive, or two side by side, into an MP4 file, and returns the path; each frame is at the same
    time after the start. Without a drive, the camera moves along the road at a calm speed. ``view`` is
    "chase" (from behind), "bonnet" (from the hood camera) or "both"; ``watch`` may wrap the frames."""
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
    if len(pictures) == 1:
        return pictures[0]
    shape = list(pictures[0].shape)
    shape[axis] = SEAM
    seam = np.full(shape, 16, np.uint8)
    parts = [part for picture in pictures for part in (seam, picture)][1:]
    return np.ascontiguousarray(np.concatenate(parts, axis=axis))


def encoder() -> Any:
    """Returns the module ``av`` (PyAV)."""
    try:
        import av
    except ImportError as error:
        raise UsageError(f"films need PyAV; say {to_install('film')}") from error
    if ENCODER not in av.codecs_available:
        raise UsageError(
            f"PyAV is installed without {ENCODER}, which writes films; install it from its wheels: "
            "python -m pip install --force-reinstall --only-binary av av"
        )
    return av


def write_film(frames: Iterable[Frame], path: Path, fps: int, about: str = "") -> None:
    """Writes frames into a file with the title ``about``; the file appears only when it is complete. The
    width and height of the frames must be even numbers of pixels."""
    av = encoder()
    with explained(RoadGPTError, f"cannot write {path}", "name another --out"):
        path.parent.mkdir(parents=True, exist_ok=True)
        with (
            whole_file(path) as draft,
            av.open(str(draft), "w", format="mp4", options={"movflags": "+faststart"}) as file,
        ):
            file.metadata["title"] = about
            _encode(av, file, frames, fps)


def _encode(av: Any, file: Any, frames: Iterable[Frame], fps: int) -> None:
    stream = None
    for n, frame in enumerate(frames):
        if stream is None:
            options = {"crf": str(QUALITY), "preset": PRESET}
            stream = file.add_stream(ENCODER, rate=fps, options=options)
            stream.height, stream.width = frame.shape[:2]
            stream.pix_fmt = "yuv420p"
        picture = av.VideoFrame.from_ndarray(frame, format="rgb24")
        picture.pts, picture.time_base = n, Fraction(1, fps)
        file.mux(stream.encode(picture))
    if stream is not None:
        file.mux(stream.encode(None))
