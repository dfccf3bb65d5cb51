"""Exports roads and routes as ASAM OpenSCENARIO XML 1.2: a scenario in which a car drives the road or route,
and a second one that replays a recorded drive.

Source: ASAM OpenSCENARIO 1.2.0, user guide and XML schema. An entity's origin is the middle of its rear axle
on the ground. Angles are right-handed, so pitch is positive nose down (ISO 8855)."""

from bisect import bisect_right
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from statistics import mean

import numpy as np
from shapely.geometry import LineString

from roadgpt.export.ego import CAR, Poses, SpeedProfile, calm_profile, goal_of, on_the_ground, start_of
from roadgpt.export.exporters.opendrive import OpenDrive
from roadgpt.export.markup import Value, XmlElement
from roadgpt.geometry.curve import Array
from roadgpt.network import legs_of, network_of, only_road
from roadgpt.road import Road, World

EGO = "Ego"
DATE = "2026-01-01T00:00:00"  # the same in every file, so that the same road gives the same bytes
KEPT = 0.02  # m/s, or s: tolerance of the simplified speeds
PATIENCE = 60.0  # s beyond the planned duration, after which a player stops
STANDS = 0.01  # m; a car that has moved less is taken as standing
DECIMALS = 6


class OpenScenario:
    """ASAM OpenSCENARIO 1.2 with OpenDRIVE: the car follows its lane or route, or replays its recorded
    drive."""

    name = "openscenario"
    suffix = ".xosc"
    holds_junctions = True
    needs_route = True

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the scenario, and beside it NAME.xodr (the road) and NAME.route.json (the lanes to drive).

        If ``poses`` is not None, a second scenario, NAME.drive.xosc, replays this drive."""
        stem = path.name.removesuffix(self.suffix)
        map_ = path.with_name(stem + OpenDrive.suffix)
        OpenDrive().save(road, map_, world)
        path.write_bytes(scenario(road, world, map_.name).to_text().encode())
        if poses is not None:
            text = replay(road, world, poses, map_.name).to_text()
            path.with_name(f"{stem}.drive{self.suffix}").write_bytes(text.encode())


def scenario(road: Road, world: World, map_: str) -> XmlElement:
    """Returns a scenario in which the car starts from rest, slows down for bends, and drives to the end of
    the road or of the route. ``map_`` is the path of the OpenDRIVE file, relative to the scenario.

    The waypoints of a route are its start, the middle of each lane between the first and the last, and its
    end. The scenario also ends if the car drives for too long."""
    plan = calm_profile(road, world)
    # stations are those of the rear axle
    start, near = max(start_of(road) + CAR.rear_axle, 0.0), road.length - (goal_of(road) + CAR.rear_axle)
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
    root, actions, story = _frame(world, map_, told)
    _start(actions, waypoints[0], 0.0)
    assigned = actions.add("PrivateAction").add("RoutingAction").add("AssignRouteAction")
    points = assigned.add("Route", {"name": "to the end", "closed": "false"})
    for waypoint in waypoints:
        points.add("Waypoint", {"routeStrategy": "shortest"}).extended(waypoint)
    _act(story, "drive").extended(_profile(plan))
    distance: dict[str, Value] = {"value": round(near, DECIMALS), "freespace": "false", "rule": "lessThan"}
    reached = XmlElement("DistanceCondition", {**distance, **measured}).extended(waypoints[-1])
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
    """Returns a scenario in which the car replays a recorded drive as a trajectory with time stamps.
    ``map_`` is the path of the OpenDRIVE file, relative to the scenario."""
    time = np.round(poses.time - poses.time[0], DECIMALS) + 0.0
    ground = on_the_ground(poses, CAR.rear_axle)
    exact = np.column_stack([ground, poses.heading, -poses.pitch, poses.roll])
    rows = np.asarray(np.round(exact, DECIMALS) + 0.0, float)
    root, actions, story = _frame(world, map_, "A car repeats its recorded drive.")
    _start(actions, _in_world(rows[0]), round(float(poses.speed[0]), DECIMALS))
    begin = _drives_off(ground)
    follow = _act(story, "repeat", float(time[begin])).add("RoutingAction").add("FollowTrajectoryAction")
    trajectory = follow.add("TrajectoryRef").add("Trajectory", {"name": "drive", "closed": "false"})
    line = trajectory.add("Shape").add("Polyline")
    vertices = np.vstack([rows[:1], rows[begin + 1 :]])
    for moment, row in zip(time[begin:].tolist(), vertices, strict=True):
        line.add("Vertex", {"time": moment}).extended(_in_world(row))
    timing: dict[str, Value] = {"domainAbsoluteRelative": "absolute", "scale": 1, "offset": 0}
    follow.add("TimeReference").add("Timing", timing)
    follow.add("TrajectoryFollowingMode", {"followingMode": "position"})
    _stop(root, {"the drive is over": _after(float(time[-1]))})
    return root


def _drives_off(ground: Array) -> int:
    """Returns the index of the last pose in which the car still stands at its start; 0 if it never moves.

    The car waits until then, and the trajectory begins there: players may merge poses that are close
    together, as esmini does within 0.1 m, and a standing car would then move at once."""
    away = np.linalg.norm(ground - ground[0], axis=1) > STANDS
    return max(int(np.argmax(away)) - 1, 0)


def _frame(world: World, map_: str, description: str) -> tuple[XmlElement, XmlElement, XmlElement]:
    root = XmlElement("OpenSCENARIO")
    told: dict[str, Value] = {"date": DATE, "description": description, "author": "RoadGPT"}
    root.add("FileHeader", {"revMajor": 1, "revMinor": 2, **told})
    root.add("CatalogLocations")
    root.add("RoadNetwork").add("LogicFile", {"filepath": map_})
    root.add("Entities").add("ScenarioObject", {"name": EGO}).extended(_vehicle())
    board = root.add("Storyboard")
    actions = board.add("Init").add("Actions")
    environment = actions.add("GlobalAction").add("EnvironmentAction").add("Environment", {"name": "road"})
    environment.add("RoadCondition", {"frictionScaleFactor": world.site.friction})
    return root, actions.add("Private", {"entityRef": EGO}), board.add("Story", {"name": "drive"})


def _vehicle() -> XmlElement:
    out = XmlElement("Vehicle", {"name": "saloon", "vehicleCategory": "car", "mass": CAR.mass})
    box = out.add("BoundingBox")
    box.add("Center", {"x": round(CAR.middle - CAR.rear_axle, 3), "y": 0, "z": CAR.height / 2})
    box.add("Dimensions", {"width": CAR.width, "length": CAR.length, "height": CAR.height})
    out.add("Performance", {"maxSpeed": 70, "maxAcceleration": 7, "maxDeceleration": 10})
    axles = out.add("Axles")
    each = {"wheelDiameter": CAR.wheel, "trackWidth": CAR.track, "positionZ": CAR.wheel / 2}
    ahead = round(CAR.front_axle - CAR.rear_axle, 3)
    axles.add("FrontAxle", {"maxSteering": CAR.lock, **each, "positionX": ahead})
    axles.add("RearAxle", {"maxSteering": 0, **each, "positionX": 0})
    out.add("Properties")
    return out


def _act(story: XmlElement, name: str, begin: float = 0.0) -> XmlElement:
    act = story.add("Act", {"name": f"{name} act"})
    group = act.add("ManeuverGroup", {"name": f"{name} group", "maximumExecutionCount": 1})
    group.add("Actors", {"selectTriggeringEntities": "false"}).add("EntityRef", {"entityRef": EGO})
    event = group.add("Maneuver", {"name": f"{name} maneuver"}).add(
        "Event", {"name": f"{name} event", "priority": "override", "maximumExecutionCount": 1}
    )
    action = event.add("Action", {"name": name}).add("PrivateAction")
    event.extended(_trigger("StartTrigger", {f"{name} now": _after(begin)}))
    act.extended(_trigger("StartTrigger", {f"{name} begin": _after(0.0)}))
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


def _after(seconds: float) -> XmlElement:
    value: dict[str, Value] = {"value": seconds, "rule": "greaterThan"}
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
