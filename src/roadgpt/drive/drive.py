"""Defines the Drive: the motion of one car with one driver on one road, as columns of numbers."""

import io
import json
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.scene import Event
from roadgpt.errors import SimulationError, UsageError, needed
from roadgpt.language.names import ActorKind, What
from roadgpt.reading import arrays_in, json_of, strictly
from roadgpt.road import Road, World

if TYPE_CHECKING:
    from pandas import DataFrame

    from roadgpt.traffic import Tracks

FloatArray = NDArray[np.float64]
Mishap = Literal["fell", "rolled", "crashed", "sank"]
"""What ends a drive beside the road: the car falls off a road that floats or off a bridge, rolls over, is
stopped by a slope, or drives into water."""
Ended = Literal["goal", "over", "out_of_lane", Mishap, "stuck", "timeout", "collision"]
COLUMNS = {
    "time": "s, since the start",
    "x": "m, centre of gravity",
    "y": "m, centre of gravity",
    "z": "m, centre of gravity",
    "heading": "rad, 0 along +x, left positive",
    "pitch": "rad, nose up positive, against the horizon",
    "roll": "rad, left side up positive (the car leans to its right), against the horizon",
    "vx": "m/s, forward along the car",
    "vy": "m/s, to the car's left",
    "vz": "m/s, towards the car's roof",
    "yaw_rate": "rad/s, left positive",
    "speed": "m/s",
    "ax": "m/s^2, forward along the car, gravity not counted",
    "ay": "m/s^2, to the car's left, gravity not counted",
    "steer": "rad, angle of the front wheels, left positive",
    "throttle": "0..1, as commanded",
    "brake": "0..1, as commanded",
    "s": "m, along the centre line",
    "t": "m, left of the centre line; with superelevation along the surface, of the point under the car",
    "outside": "0..1, share of the car's box outside its lane",
}
"""Names of the columns in their order, each with its unit and meaning."""
TOLD = ("missed", "limited", "stopped")  # of others: tuples of texts
RARE = ("handovers", "moves", "lights", "tasks", *TOLD)  # of a header, only where they are not empty
UNHEEDED = "unheeded"
OTHERS = "others"
"""Array of the states of others: whole numbers (samples, actors, 5); NaN, once GONE, of who is away."""
PER_UNIT = np.array([1e3, 1e3, 1e3, 1e4, 1e3])  # of these numbers in a m, m, m, rad, m/s
GONE = -(2**62)
LARGEST, UNPACKED = 50_000_000, 200_000_000  # bytes of the file, and of its content: seven hours of driving
# Version of the file format; increased when code for the old version would misread the new one.
FORMAT = 2
HARDEST = 300.0  # m/s^2: 30 g, more than a car survives in one piece
SLACK = 0.5  # m, tolerance for samples that were taken slightly before or after their time stamps
FASTEST = 200.0  # m/s; the fastest production cars reach 135, a car that falls 100 m reaches 44
STANDING = 20.0  # m; if the speeds amount to a longer distance than this ...
SHARE = 1 / 3  # ... the car must have moved at least this share of that distance
FAILED = ", so the simulation failed, which says nothing about the driver; drive the road again"


SCRIPT, PEDALS, RUN_IN = "the script", "the script's pedals", "the run-in's robot"
"""Who drives instead of the driver where a scene has the wheel, or the pedals alone, and before its event."""
RETURNS = 2.0  # s from when the script lets the wheel go, after which the lane counts again


class Box(NamedTuple):
    """The outline of the car, and the position and largest steering angle of its front wheels.

    The defaults describe RoadGPT's saloon. They are used for fields that are missing in a file from an older
    version."""

    length: float
    """Length in metres."""
    width: float
    """Width in metres."""
    ahead: float = 0.0
    """Distance in metres from the centre of gravity forward to the middle of the box; negative if the
    middle is behind."""
    lock: float = 0.6
    """Angle of the front wheels at full lock in radians; 0.5 to 0.7 for saloons."""
    axle: float = 1.36
    """Distance in metres from the centre of gravity forward to the front axle."""
    tyres: float = 1.805
    """Distance in metres between the outer edges of the two front tyres."""
    height: float = 0.56
    """Height in metres of the centre of gravity above the road."""
    under: float = 0.42
    """Height in metres of the centre of gravity above the underside of the car."""


class Handover(NamedTuple):
    """A part of a drive, from ``start`` to ``end`` in seconds, in which the driver had handed over; ``by``
    names whoever drove, such as "reference"."""

    start: float
    end: float
    by: str


class LaneMove(NamedTuple):
    """How the tested car was made to change lanes: between the stations ``start`` and ``end`` in metres its
    lane moves ``by`` metres to the left."""

    start: float
    end: float
    by: float


class GivenTask(NamedTuple):
    """What a scene told the car to do, and its driver was to do itself."""

    did: str
    """In words."""
    what: What
    start: float
    """When it was to begin, in seconds, and ``end``, by when it was to be done."""
    end: float
    goal: float
    """The speed to come to in m/s, or by how many metres to the left the lane moved."""
    at: float | None = None
    """The station in metres before which the front was to stop, or from which on it was to be in its new
    lane."""


class Columns(Mapping[str, FloatArray]):
    """Maps names to read-only arrays of equal length."""

    __slots__ = ("_arrays",)

    def __init__(self, arrays: Mapping[str, FloatArray]) -> None:
        kept = {}
        for name, values in arrays.items():
            column = np.array(values, dtype=np.float64)
            column.setflags(write=False)
            kept[name] = column
        self._arrays = kept

    def __getitem__(self, name: str) -> FloatArray:
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Columns, (self._arrays,))


@dataclass(frozen=True, eq=False)
class Drive:
    """The recorded drive of one driver on one road: poses every 20 ms, the seed, and how the drive ended.

    ``drive["x"]`` is a column of shape (n,); COLUMNS lists the columns and their units."""

    driver: str
    simulator: str
    seed: int
    columns: Columns
    ended: Ended
    car: Box
    handovers: tuple[Handover, ...] = ()
    """When the driver had handed over, in order; empty if it drove all the way itself."""
    others: "Tracks | None" = None
    """How the others on the road moved, from the start of the drive to its end; None if nobody else was
    there."""
    lights: bool = False
    """Whether traffic lights on the way ran: those of ``roadgpt.traffic.lights`` with the seed of the drive.
    Else they stayed green."""
    missed: tuple[str, ...] = ()
    """What of the scene had not happened when the drive ended, in sentences."""
    limited: tuple[str, ...] = ()
    """What others did with less than their actions ask for, because the road gives no more, in sentences."""
    stopped: tuple[str, ...] = ()
    """Names of the others whom a contact with the tested car made brake."""
    moves: tuple[LaneMove, ...] = ()
    """How the lane that it is to keep to moved, in order."""
    unheeded: FloatArray | None = None
    """What the driver commanded while the script had the wheel or the pedals: steer, throttle and brake,
    shape (n - 1, 3), NaN elsewhere; None if the script had neither."""
    tasks: tuple[GivenTask, ...] = ()
    """What the scene told the driver to do itself, in order."""
    history: tuple[Event, ...] = ()
    """What the scene prescribes of its actors and of the tested car, each with whether, when and where it
    happened; empty in drives of older versions."""

    def __repr__(self) -> str:
        way = f"{self['s'][-1]:.1f} m in {self.duration:.2f} s, {len(self)} steps"
        return f"Drive({self.driver} in {self.simulator}, seed {self.seed}, {way}, ended by {self.ended})"

    def __getitem__(self, name: str) -> FloatArray:
        return self.columns[name]

    def __len__(self) -> int:
        return len(self.columns["time"])

    def followed(self, road: Road, world: World) -> Road:
        """Returns a road with the lane that the car was to keep to, where it was made to change lanes."""
        if not self.moves:
            return road
        profile = replace(world.profile_of(road), aside=0.0)
        for each in self.moves:
            profile = profile.moved(*each)
        return road.with_profile(profile)

    @property
    def duration(self) -> float:
        """Duration in seconds of simulated time."""
        return float(self.columns["time"][-1])

    @property
    def lane_steps(self) -> int:
        """Number of steps, from the first on, at which the verdict checks whether the car is in its lane.

        All steps count, except the last step if the car reached the goal or was stuck at that step: the SBFT
        competition checks for the goal first, then for motion, then for the lane."""
        return max(len(self) - 1, 1) if self.ended in ("goal", "over", "stuck") else len(self)

    @cached_property
    def counts(self) -> NDArray[np.bool_]:
        """At which steps the verdict checks whether the car is in its lane, shape (n,): those of
        ``lane_steps`` but for those at which the script steers, or did RETURNS seconds before, or the car
        was where it has reversed since then into another lane."""
        time, found = self["time"], np.arange(len(self)) < self.lane_steps
        for each in self.handovers:
            if each.by == SCRIPT:
                found &= ~((time > each.start) & (time <= each.end + RETURNS))
        for task in self.tasks:
            if task.what == "change_lane":
                found &= ~((time > task.start) & (time <= task.end + RETURNS))
        if any(later.start < move.end for move, later in pairwise(self.moves)):
            found &= self["s"] < np.minimum.accumulate(self["s"][::-1])[::-1] + SLACK
        return found

    @property
    def max_outside(self) -> float:
        """Largest share of the car's box outside its lane, 0..1, over the steps at which that counts."""
        return float(self.columns["outside"][self.counts].max(initial=0.0))

    def handed_to(self, step: int) -> str | None:
        """Returns the name of whoever drove up to this step in the driver's place; None for the driver."""
        time = self["time"][step] - 5e-4  # stored times are rounded to a millisecond
        return next((each.by for each in self.handovers if each.start < time <= each.end), None)

    @property
    def shares(self) -> dict[str, float]:
        """Share of the way, 0 to 1, that each drove, by name, the driver first; empty if the driver never
        handed over."""
        if not self.handovers:
            return {}
        way = np.hypot(np.diff(self["x"]), np.diff(self["y"]))
        by = np.array([self.handed_to(step) or self.driver for step in range(1, len(self))])
        names, whole = dict.fromkeys([self.driver, *(each.by for each in self.handovers)]), way.sum() or 1.0
        return {name: float(way[by == name].sum() / whole) for name in names}

    @property
    def middles(self) -> FloatArray:
        """The middle of the car's box (x, y) in plan and its heading at every step, shape (n, 3)."""
        heading, ahead = np.unwrap(self["heading"]), self.car.ahead
        x, y = self["x"] + ahead * np.cos(heading), self["y"] + ahead * np.sin(heading)
        return np.stack([x, y, heading], axis=-1)

    def corners(self, step: int) -> FloatArray:
        """Returns the four corners of the car's box in plan at one step, shape (4, 2), counter-clockwise.

        The corners are for pictures and assume level ground; the column ``outside`` takes pitch and roll into
        account."""
        from roadgpt.geometry.boxes import corners  # only pictures load it

        *middle, heading = self.middles[step]
        return corners(np.array(middle), heading, np.array([self.car.length, self.car.width]))

    def to_frame(self) -> "DataFrame":
        """Returns the columns as a pandas DataFrame with a row for each step of 0.02 s; ``COLUMNS`` says the
        unit of each: metres, seconds and radians. Raises UsageError if pandas is not installed."""
        frame: DataFrame = needed("pandas", "a table").DataFrame({**self.columns})
        return frame

    def to_bytes(self) -> bytes:
        """Returns the drive as a compressed .npz file; the same Drive gives the same bytes."""
        header, states = packed(self)
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w") as archive:
            add_array(archive, "header", np.array(json.dumps({"format": FORMAT, **header}, sort_keys=True)))
            for name, column in self.columns.items():
                add_array(archive, name, column)
            if states is not None:
                add_array(archive, OTHERS, states)
            if self.unheeded is not None:
                add_array(archive, UNHEEDED, self.unheeded)
        return buffer.getvalue()

    @classmethod
    def load(cls, path: Path | str) -> "Drive":
        """Reads a Drive from an .npz file that contains the result of ``to_bytes``.

        Raises:
            UsageError: there is no such file, or it does not hold a Drive."""
        try:
            arrays = arrays_in(Path(path), "a drive", UNPACKED, most=LARGEST)
            return _checked(json_of(str(arrays.pop("header"))), arrays)
        except UsageError:
            raise
        except FileNotFoundError as error:
            raise UsageError(f"there is no drive at {path}: check the path") from error
        except Exception as error:  # of a broken file, zipfile, its decoders, numpy and json raise anything
            raise UsageError(
                f"{path} is not a drive saved by this version of roadgpt ({error}): drive the road again"
            ) from error


def _checked(header: Any, arrays: Mapping[str, NDArray[Any]]) -> Drive:
    if header["format"] != FORMAT:
        raise ValueError(f"its format is {header['format']}, not {FORMAT}")
    arrays = dict(arrays)
    states = arrays.pop(OTHERS) if OTHERS in header else None
    unheeded = arrays.pop(UNHEEDED, None)
    if set(arrays) != set(COLUMNS):
        raise ValueError(f"columns missing or unknown: {', '.join(sorted(set(arrays) ^ set(COLUMNS)))}")
    if any(array.ndim != 1 for array in arrays.values()):
        raise ValueError("a column is a list of numbers")
    if len({len(array) for array in arrays.values()}) != 1 or not len(arrays["time"]):
        raise ValueError("columns are of one length, and not empty")
    if unheeded is not None and unheeded.shape != (len(arrays["time"]) - 1, 3):
        raise ValueError("what the driver commanded has three numbers for each step")
    drive = unpacked(header, Columns({name: arrays[name] for name in COLUMNS}), states)
    return replace(drive, unheeded=unheeded)


def packed(drive: Drive) -> tuple[dict[str, Any], NDArray[np.float64] | None]:
    """Returns what a Drive has beside its columns, as JSON data, and the states of others as whole numbers,
    from which ``unpacked`` makes an equal Drive."""
    header: dict[str, Any] = {name: getattr(drive, name) for name in ("driver", "simulator", "seed", "ended")}
    header["car"] = drive.car._asdict()
    header |= {name: found for name in RARE if (found := getattr(drive, name))}
    header |= {"history": [vars(each) for each in drive.history]} if drive.history else {}
    if drive.others is None:
        return header, None
    header[OTHERS] = [[each.name, each.kind, each.size] for each in drive.others.actors]
    return header, np.asarray(np.rint(drive.others.states * PER_UNIT) + 0.0)


def unpacked(header: Any, columns: Columns, states: NDArray[Any] | None) -> Drive:
    """Returns the Drive of ``packed``, with its columns; raises ValueError if it is broken."""
    if header["ended"] not in get_args(Ended):
        raise ValueError(f"no drive ends with '{header['ended']}'")
    missed, limited, stopped = (strictly(tuple[str, ...], header.get(name, ())) for name in TOLD)
    return Drive(
        driver=str(header["driver"]),
        simulator=str(header["simulator"]),
        seed=int(header["seed"]),
        columns=columns,
        ended=header["ended"],
        car=Box(**{name: float(value) for name, value in header["car"].items()}),
        handovers=strictly(tuple[Handover, ...], header.get("handovers", ())),
        moves=strictly(tuple[LaneMove, ...], header.get("moves", ())),
        tasks=strictly(tuple[GivenTask, ...], header.get("tasks", ())),
        others=None if states is None else _tracks(header[OTHERS], states, float(columns["time"][-1])),
        lights=bool(header.get("lights", False)),
        missed=missed,
        limited=limited,
        stopped=stopped,
        history=_history(header["history"]) if "history" in header else (),
    )


def _history(events: Any) -> tuple[Event, ...]:
    return strictly(tuple[Event, ...], events)


def _tracks(actors: Any, states: NDArray[Any], duration: float) -> "Tracks":
    from roadgpt.traffic import STEP, Actor, Size, Tracks

    rows = strictly(tuple[tuple[str, ActorKind, tuple[float, float, float]], ...], actors)
    is_gone = (states == GONE) | np.isnan(states)
    is_whole = states.dtype in (np.int64, np.float64)
    is_whole &= bool((is_gone | ((np.rint(states) == states) & np.isfinite(states))).all())
    if not is_whole or states.ndim != 3 or states.shape[1:] != (len(rows), len(PER_UNIT)):
        raise ValueError("others have five whole numbers for each sample and actor")
    if len(states) * STEP < duration:
        raise ValueError("others have a sample every 0.1 s until the end")
    if len({name for name, *_ in rows}) < len(rows) or min([1.0, *(min(size) for _, _, size in rows)]) <= 0:
        raise ValueError("others have different names, and sizes above 0")
    if (is_gone.any(axis=2) != is_gone.all(axis=2)).any():
        raise ValueError("an actor is there as a whole, or not")
    found = tuple(Actor(name, kind, Size(*size)) for name, kind, size in rows)
    return Tracks(found, np.where(is_gone, np.nan, states / PER_UNIT))


def add_array(archive: zipfile.ZipFile, name: str, values: NDArray[Any], level: int | None = None) -> None:
    """Adds an array to an archive of NumPy, with a fixed date: its bytes do not depend on the clock."""
    entry = io.BytesIO()
    np.lib.format.write_array(entry, values, version=(1, 0), allow_pickle=False)
    info = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
    archive.writestr(info, entry.getvalue(), zipfile.ZIP_DEFLATED, level)


def check_motion(drive: Drive) -> None:
    """Raises SimulationError if the recorded positions and speeds of a drive are impossible for a car: not
    finite, with jumps, or not at the speed that it reports.

    Between two samples, a car travels at most ``speed * dt + 1/2 HARDEST dt^2 + SLACK``, where ``speed`` is
    the larger of the speeds at the two samples, but at most FASTEST."""
    place = np.stack([drive[name] for name in ("x", "y", "z")], axis=-1)
    time, speed = drive["time"], np.abs(drive["speed"])
    if not (np.isfinite(place).all() and np.isfinite(time).all() and np.isfinite(speed).all()):
        raise SimulationError(
            f"{drive.simulator} reported a position, a time or a speed that is not a finite number{FAILED}"
        )
    way = np.linalg.norm(np.diff(place, axis=0), axis=1)
    dt = np.maximum(np.diff(time), 0.0)
    fast = np.minimum(np.maximum(speed[1:], speed[:-1]), FASTEST)
    over = way - (fast * dt + HARDEST * dt**2 / 2 + SLACK)
    if len(over) and over.max() > 0:
        step = int(np.argmax(over > 0))
        raise SimulationError(
            f"{drive.simulator} moved the car by {way[step]:.1f} m within {np.diff(time)[step]:.2f} s, "
            f"{drive['s'][step]:.0f} m along the road and at {speed[step] * 3.6:.0f} km/h: no car can do that"
            f"{FAILED}"
        )
    told = float((np.minimum(speed[1:], speed[:-1]) * dt).sum())
    if told > STANDING and way.sum() < SHARE * told:
        raise SimulationError(
            f"{drive.simulator} reported speeds that amount to {told:.0f} m, but positions that amount to "
            f"{way.sum():.0f} m{FAILED}"
        )
