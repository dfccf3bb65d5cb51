"""Exports roads and routes as ASAM OpenSCENARIO XML 1.2: a scenario in which a car drives the road or route,
and a second one that replays a recorded drive.

Source: ASAM OpenSCENARIO 1.2.0, user guide and XML schema. An entity's origin is the middle of its rear axle
on the ground. Angles are right-handed, so pitch is positive nose down (ISO 8855)."""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from statistics import mean
from typing import NamedTuple

import numpy as np
from shapely.geometry import LineString

from roadgpt.brief.visibility import LOW_SUN, amount_in
from roadgpt.export.ego import CAR, Poses, Trajectories, goal_of, start_of
from roadgpt.export.exporters.opendrive import OpenDrive
from roadgpt.export.exporters.opendrive.signals import Signals
from roadgpt.export.markup import Value, XmlElement
from roadgpt.geometry.curve import Array
from roadgpt.language.names import ActorKind
from roadgpt.language.table import ROAD_USERS, WEATHER, RoadUser
from roadgpt.network import RoadEnd, legs_of, network_of, only_road
from roadgpt.road import Road, World
from roadgpt_formats.ego import SpeedProfile, calm_profile, on_the_ground
from roadgpt_formats.recorded_scenario import EGO, key_of, while_moving

DATE = "2026-01-01T00:00:00"  # the same in every file, so that the same road gives the same bytes; midnight
MIDNIGHT = -0.5  # rad, elevation of the sun at night, well below that of any twilight
KEPT = 0.02  # m/s, or s: tolerance of the simplified speeds
PATIENCE = 60.0  # s beyond the planned duration, after which a player stops
STANDS = 0.01  # m; a car that has moved less is taken as standing
DECIMALS = 6
NEAR, LASTS = 0.1, 0.1  # m and s; who stays within this distance for this time creeps or rests
EVENLY = 0.01  # m, from where it would be if it moved evenly meanwhile
REAR, FRONT = -0.3, 0.3  # usual places of axles as shares of a vehicle's length, from its middle


class OpenScenario:
    """ASAM OpenSCENARIO 1.2 with OpenDRIVE: the car follows its lane or route, or replays its recorded
    drive."""

    name = "openscenario"
    suffix = ".xosc"
    holds_junctions = True
    needs_route = True
    holds_others = True

    def doubts(self, road: Road, world: World) -> Iterator[str]:
        """Says which weather the standard has in another form, or not."""
        falls = [air.kind for air in world.scene.weather if WEATHER[air.kind].falls]
        for air in world.scene.weather:
            row = WEATHER[air.kind]
            written = row.falls.category if row.falls else "fog"
            if air.kind in falls[1:]:
                yield f"a scene has one precipitation, so {air.kind} is left out"
            elif written != air.kind:
                yield f"the standard has no {air.kind}, so it is written as {written}"

    def save(
        self,
        road: Road,
        path: Path,
        world: World,
        poses: Poses | None = None,
        placed: Trajectories | None = None,
    ) -> None:
        """Writes the scenario, and beside it NAME.xodr (the road) and NAME.route.json (the lanes to drive).

        If ``poses`` is not None, a second scenario, NAME.drive.xosc, replays this drive. The others repeat
        in both what they did in it; without a drive they are where they begin, and keep their speed."""
        stem = path.name.removesuffix(self.suffix)
        map_ = path.with_name(stem + OpenDrive.suffix)
        OpenDrive().save(road, map_, world)
        path.write_bytes(scenario(road, world, map_.name, poses, placed).to_text().encode())
        if poses is not None:
            text = replay(road, world, poses, map_.name).to_text()
            path.with_name(f"{stem}.drive{self.suffix}").write_bytes(text.encode())


def scenario(
    road: Road, world: World, map_: str, poses: Poses | None = None, placed: Trajectories | None = None
) -> XmlElement:
    """Returns a scenario in which the car slows down for bends, and drives to the end of the road or of the
    route. ``map_`` is the path of the OpenDRIVE file, relative to the scenario. The others and the lights do
    what they did in a drive, if there was one, else ``placed`` says where others begin. The car begins as
    fast as in the drive, or as it would among these others, and among others drives as fast as it did.

    The waypoints of a route are its start, the middle of each lane between the first and the last, and its
    end. The scenario also ends if the car drives for too long."""
    # stations are those of the rear axle
    start = max(world.start_on(road) + CAR.rear_axle, 0.0)
    near = road.length - (goal_of(road) + CAR.rear_axle)
    middles = [mean(both) for both in pairwise(road.starts)]
    waypoints = [_on_route(road, world, s) for s in (start, *middles[1:-1], road.length)]
    told = "A car drives the right lane from the start of the road to its end."
    measured = {"coordinateSystem": "road", "relativeDistanceType": "longitudinal"}
    also: dict[str, XmlElement] = {}
    if only_road(road, world) is None:
        told = "A car drives a route through a network of roads."
        measured = {"coordinateSystem": "entity", "relativeDistanceType": "euclidianDistance"}
        # a route that turns back ends beside its start
        driven = XmlElement("TraveledDistanceCondition", {"value": round(road.length / 2, DECIMALS)})
        also["half of it is driven"] = _of_ego(driven)
    if poses is not None:
        placed, end = poses.others, float(poses.time[-1] - poses.time[0])
    others = [] if placed is None else [*_moved(placed, end if poses is not None else 0.0)]
    if others:
        told = f"{told[:-1]}, among {len(others)} others."
    if poses is not None and others:
        plan = SpeedProfile(np.maximum(poses.speed, 0.0), poses.time - poses.time[0])
    else:
        rolls = world.first_speed if others or world.scene.speed is not None else 0.0
        plan = calm_profile(road, world, rolls if poses is None else float(poses.speed[0]))
    root, actions, story = _frame(road, world, map_, told, others)
    if poses is not None and poses.lights:
        _lights(root, Signals(network_of(road, world)).lights, poses)
    _start(actions, waypoints[0], round(float(plan.speed[0]), DECIMALS))
    assigned = actions.add("PrivateAction").add("RoutingAction").add("AssignRouteAction")
    points = assigned.add("Route", {"name": "to the end", "closed": "false"})
    for waypoint in waypoints:
        points.add("Waypoint", {"routeStrategy": "shortest"}).extended(waypoint)
    _event(_act(story, "drive"), "drive").add("PrivateAction").extended(_profile(plan))
    distance: dict[str, Value] = {"value": round(near, DECIMALS), "freespace": "false", "rule": "lessThan"}
    reached = XmlElement("DistanceCondition", {**distance, **measured}).extended(waypoints[-1])
    for other in others:
        _repeat(root, story, other)
    most = round(float(plan.time[-1]) + PATIENCE, DECIMALS)
    _stop(root, {"the end is near": _of_ego(reached), **also}, {"too long": _after(most)})
    return root


def _on_route(road: Road, world: World, s: float) -> XmlElement:
    legs = legs_of(road, world)
    number = min(max(bisect_right(road.starts, s) - 1, 0), len(legs) - 1)
    leg = legs[number]
    first = next(n for n in range(number, -1, -1) if n == 0 or legs[n - 1].road != leg.road)
    member = network_of(road, world).road(leg.road)
    along = min(s - road.starts[first], member.road.length)
    is_along = member.profile.leads_along(leg.lane)
    place = {"s": along if is_along else member.road.length - along, "offset": 0}
    lane: dict[str, Value] = {"roadId": str(leg.road), "laneId": str(leg.lane), **place}
    return XmlElement("Position").extended(XmlElement("LanePosition", lane))


def _of_ego(condition: XmlElement) -> XmlElement:
    out = XmlElement("ByEntityCondition")
    out.add("TriggeringEntities", {"triggeringEntitiesRule": "any"}).add("EntityRef", {"entityRef": EGO})
    return out.extended(XmlElement("EntityCondition").extended(condition))


def replay(road: Road, world: World, poses: Poses, map_: str) -> XmlElement:
    """Returns a scenario in which the car, and the others who were on the road, replay a recorded drive as
    trajectories with time stamps. ``map_`` is the path of the OpenDRIVE file, relative to the scenario."""
    time = np.round(poses.time - poses.time[0], DECIMALS) + 0.0
    ground = on_the_ground(poses, CAR.rear_axle)
    exact = np.column_stack([ground, poses.heading, -poses.pitch, poses.roll])
    rows = np.asarray(np.round(exact, DECIMALS) + 0.0, float)
    told = "A car repeats its recorded drive."
    others = [] if poses.others is None else [*_moved(poses.others, float(time[-1]))]
    if others:
        told = f"A car repeats its recorded drive among {len(others)} others."
    root, actions, story = _frame(road, world, map_, told, others)
    if poses.lights:
        _lights(root, Signals(network_of(road, world)).lights, poses)
    _start(actions, _in_world(rows[0]), round(float(poses.speed[0]), DECIMALS))
    begin = _drives_off(ground)
    maneuver = _act(story, "repeat", rule="greaterOrEqual" if others else "greaterThan")
    if others:
        _follow_in_parts(maneuver, "repeat", time, rows)
    else:
        _follow(maneuver, "repeat", time[begin:], np.vstack([rows[:1], rows[begin + 1 :]]))
    for other in others:
        _repeat(root, story, other)
    _stop(root, {"the drive is over": _after(float(time[-1]))})
    return root


def _lights(root: XmlElement, ids: Mapping[RoadEnd, int], poses: Poses) -> None:
    """Adds the controllers of the lights that ran; controllers and lights have their ids in the OpenDRIVE
    file. A state says of the red, the yellow and the green lamp whether it is on, as players read it."""
    (network,) = (child for child in root.children if child.name == "RoadNetwork")
    signals = network.add("TrafficSignals")
    for junction, phases in poses.lights.items():
        controller = signals.add("TrafficSignalController", {"name": str(junction), "delay": 0})
        for number, (lasts, shown) in enumerate(phases, 1):
            told: dict[str, Value] = {"name": f"phase {number}", "duration": round(lasts, DECIMALS)}
            phase = controller.add("Phase", told)
            for arm, colour in shown.items():
                lamps = ";".join("on" if lamp == colour else "off" for lamp in ("red", "yellow", "green"))
                phase.add("TrafficSignalState", {"trafficSignalId": str(ids[arm]), "state": lamps})


def _follow(maneuver: XmlElement, name: str, time: Array, rows: Array, priority: str = "override") -> None:
    """Adds the event in which an entity follows a trajectory through poses at these times, from the first of
    them on."""
    action = _event(maneuver, name, float(time[0]), priority).add("PrivateAction")
    follow = action.add("RoutingAction").add("FollowTrajectoryAction")
    trajectory = follow.add("TrajectoryRef").add("Trajectory", {"name": "drive", "closed": "false"})
    line = trajectory.add("Shape").add("Polyline")
    for moment, row in zip(time.tolist(), rows, strict=True):
        line.add("Vertex", {"time": moment}).extended(_in_world(row))
    timing: dict[str, Value] = {"domainAbsoluteRelative": "absolute", "scale": 1, "offset": 0}
    follow.add("TimeReference").add("Timing", timing)
    follow.add("TrajectoryFollowingMode", {"followingMode": "position"})


class Moved(NamedTuple):
    """How one of the others moved while it was there."""

    name: str
    kind: ActorKind
    size: Array
    """Length, width and height in metres."""
    time: Array
    rows: Array
    """Pose of the reference point at each time, shape (n, 6): x, y, z, heading, pitch and roll."""
    speed: float
    """The first speed in m/s."""
    stays: bool
    """Whether it is there until the drive is over."""

    @property
    def ahead(self) -> float:
        """Distance in metres from the reference point, a vehicle's rear axle, to the middle of the box."""
        return -REAR * float(self.size[0]) if ROAD_USERS[self.kind].group == "vehicle" else 0.0


def _moved(others: Trajectories, end: float) -> Iterator[Moved]:
    """Yields how each of the others moved until ``end``; who comes, goes and comes again is several, and who
    comes for less than a sample's time is left out."""
    step = others.time[1] if len(others.time) > 1 else 1.0
    for number, (name, kind) in enumerate(zip(others.names, others.kinds, strict=True)):
        states = others.states[:, number]
        is_there = ~np.isnan(states[:, 0]) & (others.time < end + step - 1e-6)
        edges = np.flatnonzero(np.diff(np.r_[False, is_there, False]))
        for again, (first, last) in enumerate(edges.reshape(-1, 2)):
            said = name if again == 0 else f"{name}, {again + 1}"
            if last - first < 2 and first > 0:
                continue
            time, own = others.time[first:last], states[first:last]
            stays = bool(time[-1] >= end - 1e-6)
            moved = Moved(said, kind, others.sizes[number], time, own, _first_speed(time, own), stays)
            yield moved._replace(rows=_reference(own, moved.ahead))


def _first_speed(time: Array, states: Array) -> float:
    if len(time) < 2:
        return float(states[0, 4])
    dx, dy = (states[1, :2] - states[0, :2]) / (time[1] - time[0])
    return float(dx * np.cos(states[0, 3]) + dy * np.sin(states[0, 3]))


def _reference(states: Array, ahead: float) -> Array:
    """Returns the poses of a reference point from states of the middle of the box, which is ``ahead`` of it.
    The pitch is that of the way: heights over places, and of who stands the pitch before or after."""
    x, y, z, heading, _ = states.T
    c, s = np.cos(heading), np.sin(heading)
    pitch = np.zeros(len(states))
    if len(states) > 1:
        along = np.gradient(x) * c + np.gradient(y) * s
        falls = -np.arctan2(np.gradient(z) * np.sign(along), np.abs(along))
        pitch = while_moving(falls, np.abs(along) > STANDS)
    back = ahead * np.cos(pitch)
    columns = x - back * c, y - back * s, z + ahead * np.sin(pitch), heading, pitch, np.zeros(len(states))
    return np.asarray(np.round(np.column_stack(columns), DECIMALS) + 0.0, float)


def _follow_in_parts(maneuver: XmlElement, name: str, time: Array, rows: Array) -> None:
    """Adds events in which an entity follows a trajectory through poses, and others in which it creeps or
    stands, with two poses each: a player may move or leave out poses that are close together in a trajectory
    of more, as esmini does within 0.1 m."""
    slow = _slow_parts(time, rows[:, :3])
    places = sorted({0, *(place for each in slow for place in each), len(time) - 1})
    for number, (first, last) in enumerate(pairwise(places)):
        kept = [first, last] if (first, last) in slow else range(first, last + 1)
        _follow(
            maneuver, name if number == 0 else f"{name}, {number + 1}", time[kept], rows[kept], "parallel"
        )


def _slow_parts(time: Array, places: Array) -> list[tuple[int, int]]:
    """Returns the first and the last number of the poses of each time of at least LASTS in which an entity
    stays within NEAR and moves evenly, within EVENLY."""

    def is_uneven(last: int) -> bool:
        share = (time[first : last + 1] - time[first]) / (time[last] - time[first])
        evenly = places[first] + share[:, None] * (places[last] - places[first])
        return bool((np.linalg.norm(places[first : last + 1] - evenly, axis=1) > EVENLY).any())

    found, first = [], 0
    while first < len(time) - 1:
        is_far = np.linalg.norm(places[first:] - places[first], axis=1) > NEAR
        last = first + int(np.argmax(is_far) if is_far.any() else len(is_far)) - 1
        if time[last] - time[first] > LASTS - 1e-6:
            last = first + bisect_left(range(first + 1, last + 1), True, key=is_uneven)
        if time[last] - time[first] > LASTS - 1e-6:
            found.append((first, last))
        first = last if found and found[-1] == (first, last) else first + 1
    return found


def _repeat(root: XmlElement, story: XmlElement, other: Moved) -> None:
    """Adds what one of the others does: it is there from the start or comes later, stands or follows its
    trajectory, and may leave."""
    (board,) = (child for child in root.children if child.name == "Storyboard")
    time, rows = np.round(other.time, DECIMALS), other.rows
    is_first, moves = time[0] == 0.0, bool(np.linalg.norm(rows[:, :3] - rows[0, :3], axis=1).max() > STANDS)
    if is_first:
        actions = board.children[0].children[0].add("Private", {"entityRef": other.name})
        _start(actions, _in_world(rows[0]), round(other.speed, DECIMALS))
    if is_first and other.stays and not moves:
        return
    maneuver = _act(story, other.name, other.name, "greaterOrEqual")
    if not is_first:
        added = _event(maneuver, f"{other.name} comes", float(time[0]), "parallel").add("GlobalAction")
        entity = added.add("EntityAction", {"entityRef": other.name})
        entity.add("AddEntityAction").extended(_in_world(rows[0]))
    if len(time) > 1:
        _follow_in_parts(maneuver, other.name, time, rows)
    if not other.stays:
        gone = _event(maneuver, f"{other.name} goes", float(time[-1]), "parallel").add("GlobalAction")
        gone.add("EntityAction", {"entityRef": other.name}).add("DeleteEntityAction")


def _drives_off(ground: Array) -> int:
    """Returns the index of the last pose in which the car still stands at its start; 0 if it never moves.

    The car waits until then, and the trajectory begins there: players may merge poses that are close
    together, as esmini does within 0.1 m, and a standing car would then move at once."""
    away = np.linalg.norm(ground - ground[0], axis=1) > STANDS
    return max(int(np.argmax(away)) - 1, 0)


def _frame(
    road: Road, world: World, map_: str, description: str, others: Sequence[Moved] = ()
) -> tuple[XmlElement, XmlElement, XmlElement]:
    root = XmlElement("OpenSCENARIO")
    told: dict[str, Value] = {"date": DATE, "description": description, "author": "RoadGPT"}
    root.add("FileHeader", {"revMajor": 1, "revMinor": 2, **told})
    root.add("CatalogLocations")
    root.add("RoadNetwork").add("LogicFile", {"filepath": map_})
    entities = root.add("Entities")
    size, rear = (CAR.length, CAR.width, CAR.height), CAR.rear_axle
    axles = CAR.front_axle - rear, CAR.track
    saloon = _body("saloon", replace(ROAD_USERS["car"], mass=CAR.mass), size, CAR.middle - rear, axles, 7.0)
    entities.add("ScenarioObject", {"name": EGO}).extended(saloon)
    for other in others:
        length, width, _ = (round(float(value), 3) for value in other.size)
        axles = (FRONT - REAR) * length, 0.85 * width
        body = _body(other.kind, ROAD_USERS[other.kind], other.size, other.ahead, axles)
        # in esmini, angles else change only near the vertices
        body.children[-1].add("Property", {"name": "plineInterpolation", "value": "segment"})
        entities.add("ScenarioObject", {"name": other.name}).extended(body)
    board = root.add("Storyboard")
    actions = board.add("Init").add("Actions")
    _environment(actions.add("GlobalAction").add("EnvironmentAction"), road, world)
    return root, actions.add("Private", {"entityRef": EGO}), board.add("Story", {"name": "drive"})


def _environment(action: XmlElement, road: Road, world: World) -> None:
    """Adds friction, and the weather and light of the scene. Azimuths of the sun count clockwise from
    north, which is +y; those of a low sun are ahead of the car at its start."""
    environment = action.add("Environment", {"name": "road"})
    environment.add("RoadCondition", {"frictionScaleFactor": world.site.friction})
    scene = world.scene
    if scene.clock or scene.light == "night":
        time = DATE.replace("00:00", scene.clock, 1) if scene.clock else DATE
        environment.add("TimeOfDay", {"animation": "false", "dateTime": time})
    if not (scene.weather or scene.light):
        return
    weather = environment.add("Weather")
    if scene.light:
        azimuth = (math.pi / 2 - float(road.heading(start_of(road)))) % (2 * math.pi)
        sun = (azimuth, LOW_SUN) if scene.light == "low_sun" else (0.0, MIDNIGHT)
        weather.add("Sun", {"azimuth": round(sun[0], DECIMALS), "elevation": round(sun[1], DECIMALS)})
    hazes = [amount_in(air) for air in scene.weather if not WEATHER[air.kind].falls]
    if hazes:
        weather.add("Fog", {"visualRange": min(hazes)})
    for air in scene.weather:
        if falls := WEATHER[air.kind].falls:
            told: dict[str, Value] = {"precipitationType": falls.category}
            weather.add("Precipitation", {**told, "precipitationIntensity": amount_in(air)})
            break  # the standard has one


def _body(
    name: str,
    row: RoadUser,
    size: Iterable[float],
    middle: float,
    axles: tuple[float, float],
    pull: float = 10.0,
) -> XmlElement:
    """Returns a body with its origin on the ground, at the middle of a vehicle's rear axle, from which the
    middle of the box is ``middle`` metres ahead. ``axles`` are their distance and their width."""
    length, width, height = (round(float(value), 3) for value in size)
    role: dict[str, Value] = {"role": row.role} if row.role else {}
    out = XmlElement(row.body, {"name": name, key_of(row.body): row.category, "mass": row.mass, **role})
    box = out.add("BoundingBox")
    box.add("Center", {"x": round(middle, 6), "y": 0, "z": round(height / 2, 6)})
    box.add("Dimensions", {"width": width, "length": length, "height": height})
    if row.body == "Vehicle":
        out.add("Performance", {"maxSpeed": 70, "maxAcceleration": pull, "maxDeceleration": 10})
        both, (ahead, across) = out.add("Axles"), axles
        each = {"wheelDiameter": CAR.wheel, "trackWidth": round(across, 6), "positionZ": CAR.wheel / 2}
        both.add("FrontAxle", {"maxSteering": CAR.lock, **each, "positionX": round(ahead, 6)})
        both.add("RearAxle", {"maxSteering": 0, **each, "positionX": 0})
    out.add("Properties")
    return out


def _act(story: XmlElement, name: str, who: str = EGO, rule: str = "greaterThan") -> XmlElement:
    """Adds an act that begins at once, and returns its maneuver."""
    act = story.add("Act", {"name": f"{name} act"})
    group = act.add("ManeuverGroup", {"name": f"{name} group", "maximumExecutionCount": 1})
    group.add("Actors", {"selectTriggeringEntities": "false"}).add("EntityRef", {"entityRef": who})
    maneuver = group.add("Maneuver", {"name": f"{name} maneuver"})
    act.extended(_trigger("StartTrigger", {f"{name} begin": _after(0.0, rule)}))
    return maneuver


def _event(maneuver: XmlElement, name: str, begin: float = 0.0, priority: str = "override") -> XmlElement:
    """Adds an event that begins at a time in seconds, and returns its action."""
    told: dict[str, Value] = {"name": f"{name} event", "priority": priority, "maximumExecutionCount": 1}
    event = maneuver.add("Event", told)
    action = event.add("Action", {"name": name})
    rule = "greaterThan" if priority == "override" else "greaterOrEqual"
    event.extended(_trigger("StartTrigger", {f"{name} now": _after(begin, rule)}))
    return action


def _stop(root: XmlElement, *groups: Mapping[str, XmlElement]) -> None:
    (board,) = (child for child in root.children if child.name == "Storyboard")
    board.extended(_trigger("StopTrigger", *groups))


def _trigger(name: str, *groups: Mapping[str, XmlElement]) -> XmlElement:
    """Returns a trigger that fires as soon as all conditions of at least one group hold."""
    out = XmlElement(name)
    for conditions in groups:
        group = out.add("ConditionGroup")
        for said, condition in conditions.items():
            told: dict[str, Value] = {"name": said, "delay": 0, "conditionEdge": "none"}
            group.add("Condition", told).extended(condition)
    return out


def _after(seconds: float, rule: str = "greaterThan") -> XmlElement:
    value: dict[str, Value] = {"value": seconds, "rule": rule}
    return XmlElement("ByValueCondition").extended(XmlElement("SimulationTimeCondition", value))


def _start(actions: XmlElement, place: XmlElement, speed: float) -> None:
    actions.add("PrivateAction").add("TeleportAction").extended(place)
    action = actions.add("PrivateAction").add("LongitudinalAction").add("SpeedAction")
    shape: dict[str, Value] = {"dynamicsShape": "step", "value": 0, "dynamicsDimension": "time"}
    action.add("SpeedActionDynamics", shape)
    action.add("SpeedActionTarget").add("AbsoluteTargetSpeed", {"value": speed})


def _profile(profile: SpeedProfile) -> XmlElement:
    """Returns the action that follows the planned speeds, with few entries, within KEPT of the plan."""
    graph = LineString(np.column_stack([profile.time, profile.speed])).simplify(KEPT)
    time, speed = np.array(graph.coords).T
    out = XmlElement("LongitudinalAction")
    action = out.add("SpeedProfileAction", {"followingMode": "position"})
    for duration, value in zip(np.diff(time, prepend=0.0).tolist(), speed.tolist(), strict=True):
        entry: dict[str, Value] = {"speed": round(value, DECIMALS), "time": round(duration, DECIMALS)}
        action.add("SpeedProfileEntry", entry)
    return out


def _in_world(row: Array) -> XmlElement:
    place = XmlElement("WorldPosition", dict(zip("xyzhpr", row.tolist(), strict=True)))
    return XmlElement("Position").extended(place)
