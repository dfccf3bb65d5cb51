"""Describes others on the road as ASAM OpenSCENARIO 1.x has them, for the exporter, and reads how they move.

Of a scenario are read: the boxes and categories of entities, how long each follows a FollowTrajectoryAction
with a timed Polyline of WorldPositions, where it stands by a TeleportAction in Init, and when an EntityAction
adds or deletes it. Times of triggers are those of a SimulationTimeCondition. Nothing else of the file is
used, and no path in it is followed."""

import math
import xml.etree.ElementTree as ET
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.language.table import ROAD_USERS, Size
from roadgpt.traffic.actor import Actor

EGO = "Ego"  # name of the tested car
SMALL = 1.475  # m, midway between the heights of a child and an adult
LARGEST = 100.0  # m, of a box
FARTHEST = 1e6  # m or s, of a number
SLOWEST = 0.01  # m/s; a slower motion has no direction
Timed = tuple[float, ET.Element]
"""An action and the time in seconds at which it begins; NaN if that depends on something else."""
Moves = tuple[Actor, Array, bool]
"""An entity of a scenario; how it moves, of shape (n, 6), by rising time: time; x, y and z of the middle of
the box on the ground, z NaN where it is not given; heading (unwrapped) and speed; and whether it is not
deleted after the last of these times."""


def key_of(body: str) -> str:
    """Returns the attribute of a body that holds its category."""
    return f"{body[:1].lower()}{body[1:]}Category"


def while_moving(values: Array, moves: Array) -> Array:
    """Returns values of which only those where ``moves`` holds mean something: others are those of the next
    motion, or of the last one; 0 if there is none."""
    places = np.flatnonzero(moves)
    if not len(places):
        return np.zeros(len(values))
    following = np.searchsorted(places, np.arange(len(values))).clip(max=len(places) - 1)
    return np.asarray(values[places[following]])


class _UnknownError(Exception):
    """What of an entity is not understood, so that it is left out."""


class _Builder(ET.TreeBuilder):
    def doctype(self, *_: Any) -> None:
        """Refuses declarations, such as those of XML entities."""
        raise UsageError("it declares a document type, which is not read; remove the line with DOCTYPE")


def read_moves(content: bytes) -> tuple[list[Moves], dict[str, list[str]]]:
    """Returns how the entities of a scenario move, without the tested car, and the names of what was not used
    under the reasons why. Raises UsageError if it is no scenario."""
    try:
        root = ET.fromstring(content, ET.XMLParser(target=_Builder()))  # noqa: S314
    except (ET.ParseError, LookupError, ValueError) as error:
        raise UsageError(f"it is not well-formed XML ({error}); save it again") from error
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    if root.tag != "OpenSCENARIO" or root.find("Storyboard") is None:
        raise UsageError("it is not an OpenSCENARIO 1 scenario with a Storyboard; give one")
    found, told, actions = list[Moves](), defaultdict[str, list[str]](list), _actions(root)
    unused = [*_unused(actions[""])]
    for entity in root.iterfind("Entities/ScenarioObject"):
        name = entity.get("name", "")
        if name.casefold() == EGO.casefold():
            told["not replayed, because it is the tested car"].append(name)
            continue
        try:
            found.append(_moves(entity, name, actions[name]))
            unused += [f"{action} of {name}" for action in _unused(actions[name])]
        except _UnknownError as error:
            told["left out, because not understood"].append(f"{name} ({error})")
    return found, {**told, "not used": unused}


def _actions(root: ET.Element) -> dict[str, list[Timed]]:
    """Returns the innermost actions of each entity by its name, and those of nobody under ""."""
    found = defaultdict[str, list[Timed]](list)

    def add(outer: ET.Element, names: Iterable[str], time: float) -> None:
        for holder in outer.iter():
            for action in holder:
                if action.tag.endswith("Action") and not any(each.tag.endswith("Action") for each in action):
                    for name in [holder.get("entityRef", "")] if holder.tag == "EntityAction" else names:
                        found[name].append((time, action))

    for outer in root.iterfind("Storyboard/Init/Actions/*"):
        add(outer, [outer.get("entityRef", "")], 0.0)
    for act in root.iterfind("Storyboard/Story/Act"):
        begins = _time_of(act)
        for group in act.iterfind("ManeuverGroup"):
            names = [each.get("entityRef", "") for each in group.iterfind("Actors/EntityRef")]
            for name in names:
                found[name] += [(math.nan, reference) for reference in group.iterfind("CatalogReference")]
            for event in group.iterfind("Maneuver/Event"):
                time = float(np.maximum(begins, _time_of(event)))
                for outer in event.iterfind("Action/*"):
                    add(outer, [""] if outer.tag == "GlobalAction" else names, time)
    return found


def _time_of(begun: ET.Element) -> float:
    """Returns the time at which the StartTrigger of an act or event fires."""
    times = [0.0]
    for condition in begun.iterfind("StartTrigger//Condition"):
        time = condition.find("ByValueCondition/SimulationTimeCondition")
        if time is None or time.get("rule", "greaterThan").startswith(("less", "notEqual")):
            return math.nan
        try:
            times.append(_number(time, "value") + _number(condition, "delay", 0.0))
        except _UnknownError:
            return math.nan
    return max(times)


def _unused(actions: Sequence[Timed]) -> dict[str, None]:
    """Returns the names of actions that are not understood. The first speed of who follows a trajectory is
    that of the trajectory."""
    known = {"FollowTrajectoryAction", "AddEntityAction", "DeleteEntityAction"}
    follows = any(action.tag == "FollowTrajectoryAction" for _, action in actions)

    def is_known(time: float, action: ET.Element) -> bool:
        speed = action.find("SpeedActionTarget/AbsoluteTargetSpeed")
        is_start = speed is not None and (follows or _number(speed, "value") == 0)
        return action.tag in known or (time == 0.0 and (is_start or action.tag == "TeleportAction"))

    return dict.fromkeys(action.tag for time, action in actions if not is_known(time, action))


def _moves(entity: ET.Element, name: str, actions: Sequence[Timed]) -> Moves:
    body = next((each for each in entity if each.tag in ("Vehicle", "Pedestrian", "MiscObject")), None)
    if body is None:
        raise _UnknownError("its body is in a catalogue")
    category = body.get(key_of(body.tag), "")
    kinds = [kind for kind, row in ROAD_USERS.items() if row.category == category]
    size, middle = body.find("BoundingBox/Dimensions"), body.find("BoundingBox/Center")
    if not kinds:
        raise _UnknownError(f"a {category or body.tag}")
    if size is None or middle is None:
        raise _UnknownError("without a BoundingBox")
    box = [_number(size, each) for each in ("length", "width", "height")]
    if not all(0 < each <= LARGEST for each in box):
        raise _UnknownError(f"a box of {' x '.join(f'{each:g}' for each in box)} m")
    usual = kinds[category == "pedestrian" and box[2] < SMALL]
    by_name = {action.tag: (time, action) for time, action in reversed(actions)}  # the first of each
    begins, put = by_name.get("AddEntityAction") or by_name.get("TeleportAction") or (0.0, None)
    ends, deleted = by_name.get("DeleteEntityAction", (math.inf, None))
    if math.isnan(begins + ends):
        raise _UnknownError("it comes or goes by a condition that is no time")
    rows = np.array([*_vertices(actions)])
    if not len(rows):
        if unused := ", ".join(_unused(actions)):
            raise _UnknownError(unused)
        if put is None:
            raise _UnknownError("without a place")
        rows = np.array([[begins, *_place(put)]])
    elif put is not None and rows[0, 0] > begins:
        rows = np.vstack([[begins, *rows[0, 1:]], rows])  # it waits where it begins
    if deleted is not None and rows[-1, 0] < ends:
        rows = np.vstack([rows, [ends, *rows[-1, 1:]]])
    if not len(rows := rows[rows[:, 0] <= ends]):
        raise _UnknownError("deleted before it comes")
    said = body.get("name", "")
    states = _states(rows, _number(middle, "x"), _number(middle, "y"))
    kind = next((kind for kind in kinds if kind == said), usual)
    return Actor(name, kind, Size(*box)), states, deleted is None


def _number(element: ET.Element, name: str, usual: float | None = None) -> float:
    if (text := element.get(name)) is None and usual is not None:
        return usual
    try:
        if abs(value := float(text or "")) <= FARTHEST:
            return value
    except ValueError:
        pass
    raise _UnknownError(f"{name} of its {element.tag} is '{(text or '')[:20]}'")


def _place(element: ET.Element) -> tuple[float, ...]:
    """Returns x, y, z, heading and pitch of a Position; z and heading are NaN where it gives none."""
    if (world := element.find("Position/WorldPosition")) is None:
        inner = element.find("Position/*")
        raise _UnknownError(f"a {'Position' if inner is None else inner.tag}")
    usual = {"x": None, "y": None, "z": math.nan, "h": math.nan, "p": 0.0}
    return tuple(_number(world, key, value) for key, value in usual.items())


def _vertices(actions: Sequence[Timed]) -> Iterator[tuple[float, ...]]:
    """Yields time, x, y, z, heading and pitch of an entity's trajectories."""
    before = -math.inf
    for begins, follow in actions:
        if follow.tag != "FollowTrajectoryAction":
            continue
        timing, line = follow.find("TimeReference/Timing"), follow.find(".//Shape/Polyline")
        if timing is None or line is None:
            raise _UnknownError("its trajectory has no Polyline with times")
        scale, first = _number(timing, "scale", 1.0), _number(timing, "offset", 0.0)
        if timing.get("domainAbsoluteRelative") == "relative":
            first += begins
        for vertex in line.iterfind("Vertex"):
            time = first + scale * _number(vertex, "time")
            if not time >= before:
                raise _UnknownError("its trajectory has no times, or they go back")
            if time > before:
                yield time, *_place(vertex)
            before = time


def _states(rows: Array, ahead: float, aside: float) -> Array:
    """Returns time, the place of the middle of the box, heading and speed, from time and place of the
    reference point, which the middle is ``ahead`` and ``aside`` of. Where no heading is given, it is that of
    the path."""
    time, x, y, z, heading, pitch = rows.T
    velocity = np.gradient(rows[:, 1:3], time, axis=0) if len(rows) > 1 else np.zeros((len(rows), 2))
    course = while_moving(np.arctan2(velocity[:, 1], velocity[:, 0]), np.hypot(*velocity.T) > SLOWEST)
    heading = np.unwrap(np.where(np.isnan(heading), course, heading))
    c, s = np.cos(heading), np.sin(heading)
    before = ahead * np.cos(pitch)
    speed = velocity[:, 0] * c + velocity[:, 1] * s
    middle = x + before * c - aside * s, y + before * s + aside * c, z - ahead * np.sin(pitch)
    return np.column_stack([time, *middle, heading, speed])
