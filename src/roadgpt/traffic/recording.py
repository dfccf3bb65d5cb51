"""Reads recordings of how others moved: tables (.csv), and files that plug-ins of the kind ``recordings``
read, each named after the ending of its files.

A table has one row for each actor and moment, in any order, with the columns of ``RecordedRow``. The "Ego" of
any is the tested car and is not replayed.

An actor is there from its first to its last moment; before and after, too, where it then stands still."""

import csv
import io
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import zip_longest
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import BaseModel, Field, ValidationError

from roadgpt import plugins
from roadgpt.errors import UsageError, advice_on
from roadgpt.language.names import ActorKind
from roadgpt.network import network_of
from roadgpt.reading import read_bytes
from roadgpt.road import Road, World
from roadgpt.traffic.actor import (
    SIZES,
    SPEED,
    STEP,
    STILL,
    TESTED,
    Actor,
    FloatArray,
    Size,
    Tracks,
    Z,
    rounded,
)

MOST_STATES = 2_000_000  # ten samples a second for each actor: 20 actors for almost three hours
FOR_EVER = 1e7  # s, later than any moment of a recording
LISTED = 5  # names that a sentence lists
Number = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]
Side = Annotated[float, Field(gt=0, le=100)]


class RecordedRow(BaseModel):
    """An actor at one moment, as a row of a table says it."""

    time: Number
    """Seconds since the start of the drive."""
    id: Annotated[str, Field(min_length=1)]
    kind: ActorKind
    x: Number
    """Position in metres of the middle of the box, as ``y``."""
    y: Number
    heading: Number
    speed: Number
    """m/s, negative in reverse."""
    length: Side | None = None
    """Metres, as ``width`` and ``height``; without it, the usual size of the kind."""
    width: Side | None = None
    height: Side | None = None


COLUMNS = tuple(name for name, field in RecordedRow.model_fields.items() if field.is_required())
Found = tuple[dict[str, tuple[Actor, FloatArray]], dict[str, list[str]]]
"""Actors and their tracks by name, and names of what was not used by the reasons why."""


@dataclass(frozen=True)
class Recording:
    """Actors, and how each of them moved, as a file has them."""

    actors: tuple[Actor, ...]
    tracks: tuple[FloatArray, ...]
    """For each, of shape (n, 6): time and the columns of a state, by rising time; its height is NaN where the
    file gives none. It is there from the first to the last of these times, and moves evenly between two."""
    remarks: tuple[str, ...] = ()
    """Sentences about what was not used."""

    @property
    def end(self) -> float:
        """The last time in seconds at which anything is recorded."""
        return max(float(rows[rows[:, 0] < FOR_EVER, 0].max()) for rows in self.tracks)

    def on(self, road: Road, world: World) -> Tracks:
        """Returns the tracks on a road, which gives the heights where the file has none."""
        time = STEP * np.arange(math.ceil(self.end / STEP - 1e-6) + 1)
        states = np.full((len(time), len(self.tracks), 5), np.nan)
        for number, rows in enumerate(self.tracks):
            if np.isnan(rows[:, 1 + Z]).any():
                rows = rows.copy()
                rows[:, 1 + Z] = heights(road, world, rows[:, 1:3])
            is_there = (time >= rows[0, 0] - 1e-6) & (time <= rows[-1, 0] + 1e-6)
            own = [np.interp(time[is_there], rows[:, 0], column) for column in rows[:, 1:].T]
            states[is_there, number] = np.column_stack(own)
        return Tracks(self.actors, rounded(states))


def heights(road: Road, world: World, points: FloatArray) -> FloatArray:
    """Returns the heights in metres of points ``(n, 2)`` on the road of the network whose centre line is
    nearest, as seen from above."""
    from scipy.spatial import cKDTree

    roads = [member.road for member in network_of(road, world).roads]
    lines = [each.sample().points[:, :2] for each in roads]
    of_road = np.repeat(np.arange(len(roads)), [len(line) for line in lines])
    nearest = of_road[cKDTree(np.concatenate(lines)).query(points)[1]]
    out = np.empty(len(points))
    for number in np.unique(nearest):
        own, member = nearest == number, roads[number]
        out[own] = member.at(*member.locate(*points[own].T))[:, 2]
    return out


def read_recording(path: Path) -> Recording:
    """Reads a file. Raises UsageError if it cannot be used."""
    its = path.stat() if path.is_file() else None
    return _read(path) if its is None else _read(path, its.st_size, its.st_mtime_ns)


@lru_cache(maxsize=2)  # the roads of a folder of runs are driven with the same file
def _read(path: Path, *_state: int) -> Recording:
    ending = path.suffix[1:]
    if ending != "csv" and ending not in plugins.names("recordings"):
        raise UsageError(
            f"{path} is no recording of others; give a table (.csv) or an OpenSCENARIO file (.xosc)"
        )
    try:
        content = read_bytes(path, what="a recording of others")
        found, told = _table(content) if ending == "csv" else _by_plugin(ending, content)
    except UsageError as error:
        raise UsageError(f"{path}: {error}" if str(path) not in str(error) else str(error)) from error
    except OSError as error:
        raise UsageError(f"{path} cannot be read ({error.strerror}); give the path of a recording") from error
    kept = {name: each for name, each in found.items() if each[1][-1:, 0] >= 0}
    told["left out, because gone before time 0"] = [name for name in found if name not in kept]
    remarks = [f"{why}: {_listed(names)}" for why, names in told.items() if names]
    if not kept:
        raise UsageError("; ".join((f"{path}: nobody in it can be replayed", *remarks)))
    actors, tracks = zip(*kept.values(), strict=True)
    recording = Recording(actors, tracks, tuple(f"{path.name}: {remark}" for remark in remarks))
    if len(actors) * recording.end / STEP > MOST_STATES:
        raise UsageError(f"{path}: its actors and seconds are too many to be replayed; cut out a part")
    return recording


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:LISTED]) + (f" and {len(names) - LISTED} more" if len(names) > LISTED else "")


def _staying(rows: FloatArray, before: bool = True, after: bool = True) -> FloatArray:
    """Returns the rows of a track and, if somebody stands at its ends, those of the times before and after
    it."""
    stands = np.abs(rows[[0, -1], 1 + SPEED]) < STILL
    if before and stands[0]:
        rows = np.vstack([[-FOR_EVER, *rows[0, 1:]], rows])
    if after and stands[1]:
        rows = np.vstack([rows, [FOR_EVER, *rows[-1, 1:]]])
    return rows


def _by_plugin(ending: str, content: bytes) -> Found:
    found, told = plugins.find("recordings", ending)(content)
    return {who.name: (who, _staying(rows, before=False, after=stays)) for who, rows, stays in found}, told


def _table(content: bytes) -> Found:
    try:
        text = io.StringIO(content.decode("utf-8-sig"), newline="")
        lines = [[cell.strip() for cell in line] for line in csv.reader(text) if any(map(str.strip, line))]
    except (UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"it is not a table as text ({error}); save it as CSV in UTF-8") from error
    header = lines[0] if lines else []
    if missing := [name for name in COLUMNS if name not in header]:
        raise UsageError(f"its first line does not name the columns {', '.join(missing)}; add them")
    tracks = defaultdict[str, list[list[float]]](list)
    actors: dict[str, Actor] = {}
    for number, line in enumerate(lines[1:], 2):
        cells = zip_longest(header, line, fillvalue="")
        given = {name: cell for name, cell in cells if cell or name in COLUMNS}
        try:
            row = RecordedRow.model_validate(given)
        except ValidationError as error:
            column = str(error.errors()[0]["loc"][0])
            said = f"row {number}: {column} is '{given.get(column, '')[:40]}'"
            raise UsageError(f"{said}; {advice_on(error.errors()[0])}") from error
        usual = SIZES[row.kind]
        size = Size(row.length or usual.length, row.width or usual.width, row.height or usual.height)
        actor = actors.setdefault(row.id, Actor(row.id, row.kind, size))
        if row.kind != actor.kind:
            raise UsageError(f"row {number}: {row.id} is a {row.kind} and was a {actor.kind}")
        tracks[row.id].append([row.time, row.x, row.y, math.nan, row.heading, row.speed])
    tested = [name for name in actors if name.casefold() == TESTED.casefold()]
    found = {name: (actors[name], _sorted(tracks[name], name)) for name in actors if name not in tested}
    unused = [name for name in header if name not in RecordedRow.model_fields]
    return found, {"not replayed, because it is the tested car": tested, "columns that are not used": unused}


def _sorted(values: list[list[float]], name: str) -> FloatArray:
    rows = np.array(sorted(values))
    rows[:, 4] = np.unwrap(rows[:, 4])
    if twice := np.flatnonzero(np.diff(rows[:, 0]) <= 0).tolist():
        raise UsageError(f"{name} has two rows at {rows[twice[0], 0]:g} s; leave one of them out")
    return _staying(rows)
