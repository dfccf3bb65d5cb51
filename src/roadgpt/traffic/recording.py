"""Reads recordings of how others moved: tables (.csv), and trajectories of ASAM OpenSCENARIO 1.x (.xosc).

A table has one row for each actor and moment, in any order, with these columns: ``time`` in seconds since the
start of the drive, ``id``, ``kind`` (one of ACTOR_KINDS), ``x`` and ``y`` of the middle of the box in metres,
``heading`` in radians, ``speed`` in m/s, negative in reverse, and optionally ``length``, ``width`` and
``height`` of the box in metres.

Of a scenario are read: the boxes and categories of entities, how long each follows a FollowTrajectoryAction
with a timed Polyline of WorldPositions, where it stands by a TeleportAction in Init, and when an EntityAction
adds or deletes it. Times of triggers are those of a SimulationTimeCondition. The entity "Ego" is the tested
car and is not replayed. Nothing else of the file is used, and no path in it is followed.

An actor is there from its first to its last moment; before and after, too, where it then stands still."""

import csv
import io
import math
import xml.etree.ElementTree as ET
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, get_args
from xml.parsers import expat

import numpy as np

from roadgpt.brief.scene import ActorKind
from roadgpt.errors import UsageError
from roadgpt.network import network_of
from roadgpt.reading import read_bytes
from roadgpt.traffic.actor import SIZES, STEP, STILL, TESTED, Actor, FloatArray, Size, Tracks, Z, rounded

if TYPE_CHECKING:
    from roadgpt.road import Road, World

ACTOR_KINDS: tuple[ActorKind, ...] = get_args(ActorKind)
COLUMNS = "time", "id", "kind", "x", "y", "heading", "speed"
SIZE_COLUMNS = Size._fields
MOST_STATES = 2_000_000  # ten samples a second for each actor: 20 actors for almost three hours
FARTHEST = 1e6  # m, of a coordinate
LARGEST = 100.0  # m, of a box
SLOWEST = 0.01  # m/s; a slower motion has no direction
LISTED = 5  # names that a sentence lists
CATEGORIES: Mapping[str, tuple[ActorKind, ...]] = {
    "car": ("car",),
    "van": ("van",),
    "truck": ("truck",),
    "bus": ("bus",),
    "motorbike": ("motorcycle",),
    "bicycle": ("bicycle",),
    "pedestrian": ("adult", "child"),
    "animal": ("animal",),
    "obstacle": ("lost_load", "cones"),
    "barrier": ("barrier",),
}
"""The kinds that an OpenSCENARIO category stands for; the name of the body says which, else it is the
first."""
BODIES = {
    "Vehicle": "vehicleCategory",
    "Pedestrian": "pedestrianCategory",
    "MiscObject": "miscObjectCategory",
}


class Track(NamedTuple):
    """How one actor moved."""

    rows: FloatArray
    """Shape (n, 6): time and the columns of a state, by rising time; its height is NaN where the file gives
    none. Between two rows it moves evenly."""
    first: float
    """The time from which on it is there, and ``last`` that until which it is."""
    last: float


@dataclass(frozen=True)
class Recording:
    """Actors, and how each of them moved, as a file has them."""

    actors: tuple[Actor, ...]
    tracks: tuple[Track, ...]
    remarks: tuple[str, ...] = ()
    """Sentences about what was not used."""

    def on(self, road: "Road", world: "World") -> Tracks:
        """Returns the tracks on a road, which gives the heights where the file has none."""
        end = max([float(track.rows[-1, 0]) for track in self.tracks])
        time = STEP * np.arange(math.ceil(end / STEP - 1e-6) + 1)
        states = np.full((len(time), len(self.tracks), 5), np.nan)
        for number, (rows, first, last) in enumerate(self.tracks):
            if np.isnan(rows[:, 1 + Z]).any():
                rows = rows.copy()
                rows[:, 1 + Z] = heights(road, world, rows[:, 1:3])
            is_there = (time >= first - 1e-6) & (time <= last + 1e-6)
            at = time[is_there]
            own = np.column_stack([np.interp(at, rows[:, 0], column) for column in rows[:, 1:].T])
            own[(at < rows[0, 0] - 1e-6) | (at > rows[-1, 0] + 1e-6), 4] = 0.0  # it stands there
            states[is_there, number] = own
        return Tracks(self.actors, rounded(states))


def heights(road: "Road", world: "World", points: FloatArray) -> FloatArray:
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
    """Reads a file, ``.csv`` or ``.xosc``. Raises UsageError if it cannot be used."""
    its = path.stat() if path.is_file() else None
    return _read(path) if its is None else _read(path, its.st_size, its.st_mtime_ns)


@lru_cache(maxsize=2)  # the roads of a folder of runs are driven with the same file
def _read(path: Path, *_state: int) -> Recording:
    readers = {".csv": _table, ".xosc": _scenario}
    reader = readers.get(path.suffix)
    if reader is None:
        raise UsageError(
            f"{path} is no recording of others; give a table (.csv) or an OpenSCENARIO file (.xosc)"
        )
    try:
        found = reader(read_bytes(path, what="a recording of others"))
    except UsageError as error:
        raise UsageError(f"{path}: {error}" if str(path) not in str(error) else str(error)) from error
    except OSError as error:
        raise UsageError(f"{path} cannot be read ({error.strerror}); give the path of a recording") from error
    if not found.actors:
        raise UsageError(" ".join((f"{path}: nobody in it can be replayed", *found.remarks[:1])))
    states = len(found.actors) * max(float(track.rows[-1, 0]) for track in found.tracks) / STEP
    if states > MOST_STATES:
        raise UsageError(f"{path}: its actors and seconds are too many to be replayed; cut out a part")
    return replace(found, remarks=tuple(f"{path.name}: {remark}" for remark in found.remarks))


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:LISTED]) + (f" and {len(names) - LISTED} more" if len(names) > LISTED else "")


def _joined(found: Mapping[str, tuple[Actor, Track]], remarks: Sequence[str]) -> Recording:
    """Returns the recording without those who are gone before time 0."""
    gone = [name for name, (_, track) in found.items() if track.last < 0 or track.first > track.rows[-1, 0]]
    kept = [value for name, value in found.items() if name not in gone]
    more = [f"left out, because gone before time 0: {_listed(gone)}"] if gone else []
    return Recording(tuple(actor for actor, _ in kept), tuple(track for _, track in kept), (*remarks, *more))


def _track(rows: FloatArray, starts: float | None = None, ends: float | None = None) -> Track:
    """Returns a track; ``starts`` and ``ends`` are when the file says that the actor comes and goes."""
    stands_first, stands_last = np.abs(rows[[0, -1], 5]) < STILL
    first = starts if starts is not None else -math.inf if stands_first else rows[0, 0]
    last = ends if ends is not None else math.inf if stands_last else rows[-1, 0]
    return Track(rows, float(first), float(last))


def _value(text: str | None) -> float:
    """Returns the number that a text is; NaN if it is none, or too large."""
    try:
        value = float(text or "")
    except ValueError:
        return math.nan
    return value if abs(value) <= FARTHEST else math.nan


def _size_of(values: Sequence[float], who: str) -> Size:
    if not all(0 < value <= LARGEST for value in values):
        raise UsageError(f"the box of {who} is {' x '.join(f'{v:g}' for v in values)} m; correct it")
    return Size(*values)


# ---- tables


def _table(content: bytes) -> Recording:
    try:
        text = content.decode("utf-8-sig")
        lines = [line for line in csv.reader(io.StringIO(text, newline="")) if any(map(str.strip, line))]
    except (UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"it is not a table as text ({error}); save it as CSV in UTF-8") from error
    header = [name.strip() for name in lines[0]] if lines else []
    if missing := [name for name in COLUMNS if name not in header]:
        raise UsageError(f"its first line does not name the columns {', '.join(missing)}; add them")
    unused = [name for name in header if name not in (*COLUMNS, *SIZE_COLUMNS)]
    rows: dict[str, list[list[float]]] = defaultdict(list)
    actors: dict[str, Actor] = {}
    for number, line in enumerate(lines[1:], 2):
        row = dict(zip(header, map(str.strip, line), strict=False))
        if not (name := row.get("id")):
            raise UsageError(f"row {number} has no id; add it")
        if name not in actors:
            actors[name] = _actor_of(row, number, name)
        if row.get("kind") != actors[name].kind:
            raise UsageError(f"row {number}: {name} is a {row.get('kind')} and was a {actors[name].kind}")
        values = [_cell(row, column, number) for column in ("time", "x", "y", "heading", "speed")]
        rows[name].append([*values[:3], math.nan, *values[3:]])
    remarks = [f"columns that are not used: {_listed(unused)}"] if unused else []
    if TESTED.casefold() in map(str.casefold, actors):
        remarks.append(f"{TESTED} is not replayed, because it is the tested car")
    found = {
        name: (actor, _sorted_track(rows[name], name))
        for name, actor in actors.items()
        if name.casefold() != TESTED.casefold()
    }
    return _joined(found, remarks)


def _actor_of(row: Mapping[str, str], number: int, name: str) -> Actor:
    kind = row.get("kind", "")
    if kind not in ACTOR_KINDS:
        raise UsageError(f"row {number}: '{kind[:40]}' is no kind; give one of {', '.join(ACTOR_KINDS)}")
    usual = SIZES[kind]
    size = [
        _cell(row, column, number) if row.get(column) else getattr(usual, column) for column in SIZE_COLUMNS
    ]
    return Actor(name, kind, _size_of(size, name))


def _cell(row: Mapping[str, str], column: str, number: int) -> float:
    if math.isnan(value := _value(row.get(column))):
        raise UsageError(f"row {number}: {column} is '{row.get(column, '')[:40]}', which is no usable number")
    return value


def _sorted_track(values: list[list[float]], name: str) -> Track:
    rows = np.array(sorted(values))
    rows[:, 4] = np.unwrap(rows[:, 4])
    if twice := np.flatnonzero(np.diff(rows[:, 0]) <= 0).tolist():
        raise UsageError(f"{name} has two rows at {rows[twice[0], 0]:g} s; leave one of them out")
    return _track(rows)


# ---- OpenSCENARIO


class _UnknownError(Exception):
    """What of an entity is not understood, so that it is left out."""


def _scenario(content: bytes) -> Recording:
    root = _tree(content)
    if root.tag != "OpenSCENARIO" or root.find("Storyboard") is None:
        raise UsageError("it is not an OpenSCENARIO 1 scenario with a Storyboard; give one")
    story = _Story(root)
    found: dict[str, tuple[Actor, Track]] = {}
    left_out, remarks = list[str](), list[str]()
    for entity in root.iterfind("Entities/ScenarioObject"):
        name = entity.get("name", "")
        if name.casefold() == TESTED.casefold():
            remarks.append(f"{name} is not replayed, because it is the tested car")
            continue
        try:
            found[name] = _replayed(entity, name, story)
        except _UnknownError as error:
            left_out.append(f"{name} ({error})")
    if left_out:
        remarks.append(f"left out, because not understood: {_listed(left_out)}")
    if unused := [f"{what} of {name}" for name, what in sorted(story.unused) if name in found]:
        remarks.append(f"not used: {_listed(unused)}")
    if story.elsewhere:
        remarks.append(f"not used: {_listed(sorted(story.elsewhere))}")
    return _joined(found, remarks)


def _tree(content: bytes) -> ET.Element:
    """Returns the root of an XML document, which has no declarations of its own, such as entities."""

    def refuse(*_: Any) -> None:
        raise UsageError("it declares a document type, which is not read; remove the line with DOCTYPE")

    builder, parser = ET.TreeBuilder(), expat.ParserCreate()
    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = lambda tag, attributes: builder.start(tag.rpartition(":")[2], attributes)
    parser.EndElementHandler = lambda tag: builder.end(tag.rpartition(":")[2])
    try:
        parser.Parse(content, True)
        return builder.close()
    except (expat.ExpatError, UnicodeError, LookupError, ValueError, AssertionError) as error:
        raise UsageError(f"it is not well-formed XML ({error}); save it again") from error


class _Story:
    """What the entities of a scenario do, by their names."""

    def __init__(self, root: ET.Element) -> None:
        self.places: dict[str, ET.Element] = {}
        self.paths: dict[str, list[tuple[ET.Element, float | None]]] = defaultdict(list)
        self.comes: dict[str, tuple[float | None, ET.Element]] = {}
        self.goes: dict[str, float | None] = {}
        self.unused: set[tuple[str, str]] = set()
        """Names of entities, and of actions of theirs that are not understood."""
        self.elsewhere: set[str] = set()  # names of actions of nobody
        for private in root.iterfind("Storyboard/Init/Actions/Private"):
            for action in private:
                self._private(action, private.get("entityRef", ""), 0.0)
        for action in root.iterfind("Storyboard/Init/Actions/GlobalAction"):
            self._global(action, 0.0)
        for act in root.iterfind("Storyboard/Story/Act"):
            begins = _time_of(act.find("StartTrigger"))
            for group in act.iterfind("ManeuverGroup"):
                who = [each.get("entityRef", "") for each in group.iterfind("Actors/EntityRef")]
                for event in group.iterfind("Maneuver/Event"):
                    own = _time_of(event.find("StartTrigger"))
                    time = None if own is None or begins is None else max(own, begins)
                    for action in event.iterfind("Action/*"):
                        if action.tag == "GlobalAction":
                            self._global(action, time)
                        for name in who if action.tag == "PrivateAction" else ():
                            self._private(action, name, time)
                for reference in group.iterfind("CatalogReference"):
                    self.unused |= {(name, reference.tag) for name in who}

    def _private(self, action: ET.Element, name: str, time: float | None) -> None:
        for kind in action:
            follow = kind if kind.tag == "FollowTrajectoryAction" else kind.find("FollowTrajectoryAction")
            speed = kind.find("SpeedAction/SpeedActionTarget/AbsoluteTargetSpeed")
            if follow is not None:
                self.paths[name].append((follow, time))
            elif kind.tag == "TeleportAction" and time == 0.0 and name not in self.places:
                self.places[name] = kind
            elif speed is None or time != 0.0 or not (name in self.paths or _value(speed.get("value")) == 0):
                # the first speed of who follows a trajectory is that of the trajectory
                inner = [each.tag for each in kind] if kind.tag.endswith(("lAction", "gAction")) else []
                self.unused.add((name, (inner or [kind.tag])[0]))

    def _global(self, action: ET.Element, time: float | None) -> None:
        for kind in action:
            name = kind.get("entityRef", "")
            if (added := kind.find("AddEntityAction")) is not None:
                self.comes[name] = (time, added)
            elif kind.find("DeleteEntityAction") is not None:
                self.goes[name] = time
            else:
                self.elsewhere.add(kind.tag)


def _time_of(trigger: ET.Element | None) -> float | None:
    """Returns the time in seconds at which a trigger fires; None if it depends on something else than the
    time."""
    times = [0.0]
    for condition in () if trigger is None else trigger.iter("Condition"):
        time = condition.find("ByValueCondition/SimulationTimeCondition")
        if time is None or time.get("rule", "greaterThan").startswith(("less", "notEqual")):
            return None
        times.append(_value(time.get("value")) + _value(condition.get("delay", "0")))
    return None if math.isnan(sum(times)) else max(times)


def _replayed(entity: ET.Element, name: str, story: _Story) -> tuple[Actor, Track]:
    body = next((each for each in entity if each.tag in BODIES), None)
    if body is None:
        raise _UnknownError("its body is in a catalogue")
    category = body.get(BODIES[body.tag], "")
    kinds = CATEGORIES.get(category)
    if kinds is None:
        raise _UnknownError(f"a {category or body.tag}")
    size = body.find("BoundingBox/Dimensions")
    middle = body.find("BoundingBox/Center")
    if size is None or middle is None:
        raise _UnknownError("without a BoundingBox")
    box = _size_of([_number(size, each) for each in SIZE_COLUMNS], name)
    said = [each for each in kinds if each == body.get("name")]
    middling = (SIZES["adult"].height + SIZES["child"].height) / 2
    kind = said[0] if said else kinds[category == "pedestrian" and box.height < middling]
    rows = np.array([*_vertices(name, story)])
    is_moving = bool(len(rows))
    if unused := sorted(what for who, what in story.unused if who == name and not is_moving):
        raise _UnknownError(", ".join(unused))
    comes, goes = story.comes.get(name), story.goes.get(name, math.inf)
    if goes is None or (comes is not None and comes[0] is None):
        raise _UnknownError("it comes or goes by a condition that is no time")
    place = story.places.get(name) if comes is None else comes[1]
    if not is_moving:
        if place is None:
            raise _UnknownError("without a place")
        rows = np.array([[0.0, *_place(place)]])
    elif place is not None and rows[0, 0] > 0 and comes is None:
        rows = np.vstack([[0.0, *rows[0, 1:]], rows])  # it waits where it begins
    states = _states(rows, _number(middle, "x"), _number(middle, "y"))
    starts = None if comes is None else comes[0]
    return Actor(name, kind, box), _track(states, starts, None if goes == math.inf else goes)


def _number(element: ET.Element, name: str, usual: float | None = None) -> float:
    text = element.get(name)
    if text is None and usual is not None:
        return usual
    if math.isnan(value := _value(text)):
        what = "a parameter" if str(text).startswith("$") else "no usable number"
        raise _UnknownError(f"{name} of its {element.tag} is {what}")
    return value


def _place(element: ET.Element) -> tuple[float, ...]:
    """Returns x, y, z, heading and pitch of a Position; z and heading are NaN where it gives none."""
    world = element.find("Position/WorldPosition")
    if world is None:
        inner = element.find("Position/*")
        raise _UnknownError(f"a {'Position' if inner is None else inner.tag}")
    x, y = _number(world, "x"), _number(world, "y")
    return x, y, _number(world, "z", math.nan), _number(world, "h", math.nan), _number(world, "p", 0.0)


def _vertices(name: str, story: _Story) -> Iterator[tuple[float, ...]]:
    """Yields time, x, y, z, heading and pitch of an entity's trajectories."""
    before = -math.inf
    for follow, begins in story.paths.get(name, ()):
        timing, line = follow.find("TimeReference/Timing"), follow.find(".//Shape/Polyline")
        if timing is None or line is None:
            raise _UnknownError("its trajectory has no Polyline with times")
        is_relative = timing.get("domainAbsoluteRelative") == "relative"
        if is_relative and begins is None:
            raise _UnknownError("its trajectory begins by a condition that is no time")
        scale, offset = _number(timing, "scale", 1.0), _number(timing, "offset", 0.0)
        shift = offset + (begins or 0.0) * is_relative
        for vertex in line.iterfind("Vertex"):
            time = _number(vertex, "time") * scale + shift
            if time < before:
                raise _UnknownError("its trajectory goes back in time")
            if time > before:
                yield time, *_place(vertex)
            before = time


def _states(rows: FloatArray, ahead: float, aside: float) -> FloatArray:
    """Returns time, the place of the middle of the box, heading and speed, from time and place of the
    reference point, which the middle is ``ahead`` and ``aside`` of. Where no heading is given, it is that of
    the path."""
    time, x, y, z, heading, pitch = rows.T
    velocity = np.gradient(rows[:, 1:3], time, axis=0) if len(rows) > 1 else np.zeros((1, 2))
    moves = np.flatnonzero(np.hypot(*velocity.T) > SLOWEST)
    course = np.zeros(len(rows))
    if len(moves):  # who stands still looks where it goes next, or went last
        following = np.searchsorted(moves, np.arange(len(rows))).clip(max=len(moves) - 1)
        course = np.arctan2(velocity[:, 1], velocity[:, 0])[moves[following]]
    heading = np.unwrap(np.where(np.isnan(heading), course, heading))
    c, s = np.cos(heading), np.sin(heading)
    before = ahead * np.cos(pitch)
    speed = velocity[:, 0] * c + velocity[:, 1] * s
    middle = x + before * c - aside * s, y + before * s + aside * c, z - ahead * np.sin(pitch)
    return np.column_stack([time, *middle, heading, speed])
