"""OpenSCENARIO: ASAM's checker finds nothing, and the car is told where the road says."""

import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from exported import ROADS, WORLD, asam_says, drive
from roadgpt.export import Poses, Trajectories, save
from roadgpt.road import Road, World

REAR_AXLE, GRAVITY_HEIGHT = -1.47, 0.56  # m, of the simulator's car


def saved(road: Road, folder: Path, world: World = WORLD) -> tuple[ET.Element, ET.Element]:
    save(road, folder, ["openscenario"], world, "a road", drive(road, world))
    return tuple(ET.parse(folder / f"a road{end}.xosc").getroot() for end in ("", ".drive"))


@pytest.mark.parametrize(
    ("road", "end"), [("arcs", ""), ("arcs", ".drive"), ("spline", ".drive"), ("short", "")]
)
def test_asams_checker_asks_everything_and_objects_to_nothing(tmp_path: Path, road: str, end: str) -> None:
    saved(ROADS[road], tmp_path)
    issues, ends = asam_says(tmp_path / f"a road{end}.xosc")
    assert issues == []
    assert ends == {"completed": 17}


@pytest.mark.parametrize("name", ROADS)
def test_the_car_starts_in_the_right_lane_and_stops_near_the_end(tmp_path: Path, name: str) -> None:
    road = ROADS[name]
    scenario, _ = saved(road, tmp_path)
    map_ = ET.parse(tmp_path / scenario.find("RoadNetwork/LogicFile").attrib["filepath"]).getroot()
    length = float(map_.find("road").attrib["length"])
    lanes = {lane.get("id"): lane.get("type") for lane in map_.iter("lane")}
    places = list(scenario.iter("LanePosition"))
    assert len(places) == 4
    for place in places:
        assert place.get("roadId") == map_.find("road").get("id")
        assert lanes[place.attrib["laneId"]] == "driving"
        assert int(place.attrib["laneId"]) < 0
        assert 0 <= float(place.attrib["s"]) <= length
    start, first, last, end = (float(place.attrib["s"]) for place in places)
    assert start == first
    assert last == end == length
    (near,) = (each.attrib for each in scenario.iter("DistanceCondition"))
    goal = length - float(near["value"])
    assert start < goal < length
    if length > 20:
        assert start - REAR_AXLE == pytest.approx(2.5)
        assert goal - REAR_AXLE == pytest.approx(length - 8)


def planned(scenario: ET.Element) -> tuple[np.ndarray, np.ndarray]:
    """Times in seconds and speeds in m/s of the speed profile."""
    entries = list(scenario.iter("SpeedProfileEntry"))
    return tuple(np.array([float(each.attrib[key]) for each in entries]) for key in ("time", "speed"))


@pytest.mark.parametrize("friction", [0.2, 0.6, 1.0])
@pytest.mark.parametrize("name", ["arcs", "spline"])
def test_the_car_drives_as_fast_as_each_bend_allows_a_calm_driver(
    tmp_path: Path, friction: float, name: str
) -> None:
    """Driven step by step on the middle of the lane: no bend is taken too fast, no pull is too strong."""
    road = ROADS[name]
    world = WORLD.changed(friction=friction)
    scenario, _ = saved(road, tmp_path, world)
    assert scenario.find(".//RoadCondition").attrib == {
        "frictionScaleFactor": str(friction).removesuffix(".0")
    }
    (first,) = (float(each.attrib["value"]) for each in scenario.iter("AbsoluteTargetSpeed"))
    driven = float(drive(road, world).speed[0])
    assert first == pytest.approx(driven) or (friction == 0.2 and 0.8 * driven < first < driven)  # it brakes
    waits, speeds = planned(scenario)
    grip = min(3.0, 0.5 * friction * 9.81)
    time = np.arange(0.0, waits.sum(), 0.01)
    speed = np.interp(time, np.cumsum(waits), speeds)
    assert speed.max() <= world.limits.speed_limit + 1e-6
    pull = np.abs(np.diff(speeds)[waits[1:] > 0.2] / waits[1:][waits[1:] > 0.2])
    assert pull.max() < min(2.0, 0.5 * friction * 9.81) * 1.1
    s = 2.5
    bends = road.curvature(np.arange(0.0, road.length, 0.02)).tolist()
    for v in speed.tolist():
        bend = bends[min(round(s / 0.02), len(bends) - 1)]
        own = bend / (1 + bend * world.section.lane_width / 2)
        assert v**2 * abs(own) <= grip * 1.06 + 0.05
        s += v * 0.01 / (1 + bend * world.section.lane_width / 2)
    assert s == pytest.approx(road.length, abs=1.5)
    tightest = np.abs(road.curvature(np.linspace(0, road.length, 999))).max()
    slowest = min(world.limits.speed_limit, np.sqrt(grip / tightest))
    assert speed.max() > 1.05 * slowest or slowest == world.limits.speed_limit, "one speed for the whole road"


@pytest.mark.parametrize("name", ["arcs", "flat points", "short"])
def test_the_trajectory_is_that_of_the_rear_axle(tmp_path: Path, name: str) -> None:
    """OpenSCENARIO turns right-handed about z, y, x; scipy does so, too."""
    poses = drive(ROADS[name])
    _, replay = saved(ROADS[name], tmp_path)
    vertices = list(replay.iter("Vertex"))
    time = np.array([float(vertex.attrib["time"]) for vertex in vertices])
    rows = np.array(
        [[float(vertex.find("Position/WorldPosition").attrib[k]) for k in "xyzhpr"] for vertex in vertices]
    )
    assert time == pytest.approx(poses.time - poses.time[0])
    attitude = Rotation.from_euler("ZYX", rows[:, 3:])
    gravity = rows[:, :3] + attitude.apply([-REAR_AXLE, 0, GRAVITY_HEIGHT])
    assert np.abs(gravity - np.column_stack([poses.x, poses.y, poses.z])).max() < 1e-5
    nose, left = attitude.apply([1, 0, 0]), attitude.apply([0, 1, 0])
    assert np.arcsin(nose[:, 2]) == pytest.approx(poses.pitch, abs=1e-5)  # up where the pitch is positive
    assert (np.sign(left[:, 2]) == np.sign(poses.roll)).all()
    stop = replay.find("Storyboard/StopTrigger").iter("SimulationTimeCondition")
    assert [float(each.attrib["value"]) for each in stop] == [pytest.approx(time[-1])]


def merged(time: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What a player leaves of a trajectory that merges close vertices, as esmini does where it is not told
    otherwise: those within 0.1 m of the last one that it kept, unless the car stands there for a second."""
    kept = [0]
    for i in range(1, len(time) - 1):
        if np.hypot(*(places[i] - places[kept[-1]])) > 0.1:
            if time[i] - time[kept[-1]] > 1.0:
                kept.append(i - 1)
            kept.append(i)
    return time[[*kept, len(time) - 1]], places[[*kept, len(time) - 1]]


@pytest.mark.parametrize("wait", [0.0, 0.4, 3.0])
def test_a_player_that_merges_close_poses_still_drives_off_in_time(tmp_path: Path, wait: float) -> None:
    """A car waits, then drives off ever faster, 9 m in the first two seconds; nowhere is it 2 cm off.

    The merged trajectory of a car that never waits would be 38 mm off."""
    time = np.arange(0.0, 8.0, 0.02)
    s = 2.5 + 1.1 * np.maximum(time - wait, 0.0) ** 3
    s = s[s < 90]
    time = time[: len(s)]
    road = Road.through([[0, 0], [50, 0], [100, 0]])
    x, y, z = road.at(s, -2.0).T
    zero = np.zeros(len(s))
    speed = np.gradient(s, time)
    save(road, tmp_path, ["openscenario"], WORLD, "r", Poses(time, x, y, z + 0.56, zero, zero, zero, speed))
    root = ET.parse(tmp_path / "r.drive.xosc").getroot()
    vertices = list(root.iter("Vertex"))
    when = np.array([float(vertex.attrib["time"]) for vertex in vertices])
    where = np.array([[float(v.find("Position/WorldPosition").attrib[k]) for k in "xy"] for v in vertices])
    event = next(root.iter("Event"))
    begins = float(next(event.iter("SimulationTimeCondition")).attrib["value"])
    assert begins == when[0]
    known, places = merged(when, where)
    played = np.interp(time, known, places[:, 0])
    played[time < begins] = x[0] + REAR_AXLE
    assert np.abs(played - (x + REAR_AXLE)).max() < 0.02


CONDITIONS = {
    "": {"RoadCondition"},
    "medium; wet": {"RoadCondition"},
    "fog 60": {"RoadCondition", "Weather", "Fog"},
    "rain 5": {"RoadCondition", "Weather", "Precipitation"},
    "night": {"RoadCondition", "TimeOfDay", "Weather", "Sun"},
    "low_sun": {"RoadCondition", "Weather", "Sun"},
    "fog 60; rain 5; night": {"RoadCondition", "TimeOfDay", "Weather", "Sun", "Fog", "Precipitation"},
    "clock 14:15": {"RoadCondition", "TimeOfDay"},
}


@pytest.mark.parametrize("text", CONDITIONS)
def test_the_environment_is_that_of_the_scene_and_asams_checker_agrees(tmp_path: Path, text: str) -> None:
    road = ROADS["arcs"]
    world = WORLD.changed(scene=text)
    save(road, tmp_path, ["openscenario"], world, "weather", drive(road, world))
    for file in (tmp_path / "weather.xosc", tmp_path / "weather.drive.xosc"):
        assert asam_says(file)[0] == []
        root = ET.parse(file).getroot()
        (environment,) = root.iter("Environment")
        assert {each.tag for each in environment.iter()} == {"Environment", *CONDITIONS[text]}
        values = {each.tag: each.attrib for each in environment.iter()}
        assert float(values["RoadCondition"]["frictionScaleFactor"]) == world.site.friction
        assert "Fog" not in values or values["Fog"] == {"visualRange": "60"}
        rain = {"precipitationType": "rain", "precipitationIntensity": "5"}
        assert "Precipitation" not in values or values["Precipitation"] == rain
        if "TimeOfDay" in values:
            hour = "14:15" if text == "clock 14:15" else "00:00"
            assert values["TimeOfDay"]["dateTime"].endswith(f"T{hour}:00")
        if "Sun" in values:
            azimuth, up = (float(values["Sun"][name]) for name in ("azimuth", "elevation"))
            assert ("TimeOfDay" in values) == ("night" in text) == (up < math.radians(-18))  # astronomical
            assert text != "low_sun" or 0 < up < math.radians(15)
    if text == "low_sun":  # ASAM: 0 is north, pi/2 east
        heading = float(next(root.iter("WorldPosition")).attrib["h"])
        ahead = math.cos(heading), math.sin(heading)
        assert (math.sin(azimuth), math.cos(azimuth)) == pytest.approx(ahead, abs=0.03)


def kept_by_esmini(time: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The vertices that esmini 3.6 leaves of a trajectory of more than two (PolyLineShape::FinalizeVertices):
    of those within 0.1 m of one that it kept, none; after more than 1 s the last, moved to the kept one."""
    if len(time) < 3:
        return time, places
    rows, n = [(time[0], places[0])], 1
    while n < len(time):
        close = n
        while close < len(time) - 1 and np.hypot(*(places[close] - rows[-1][1])) < 0.1:
            close += 1
        if close > n and time[close] - rows[-1][0] > 1.0:
            rows.append((time[close - 1], rows[-1][1]))
        rows.append((time[close], places[close]))
        n = close + 1
    return tuple(np.array(column) for column in zip(*rows, strict=True))


@pytest.mark.parametrize("creep", [0.05, 0.09, 0.3])
def test_who_creeps_among_others_is_where_it_was(tmp_path: Path, creep: float) -> None:
    """Brakes from 8 m/s, creeps for 4 s, stands for 3 s, creeps on and drives off."""
    time = np.arange(0, 18.0, 0.02)
    speed = np.interp(time, [0, 2, 4, 8, 8.1, 11, 11.1, 14, 18], [8, 8, creep, creep, 0, 0, creep, creep, 9])
    s = 10 + np.concatenate([[0], np.cumsum(0.02 * (speed[1:] + speed[:-1]) / 2)])
    flat, heading = np.zeros(len(s)), np.full(len(s), 0.3)
    x, y = s * np.cos(0.3), s * np.sin(0.3)
    cone = Trajectories(
        ("cone",), ("cones",), np.array([[0.4, 0.4, 0.75]]), np.arange(0, 18.1, 0.1), np.zeros((181, 1, 5))
    )
    poses = Poses(time, x, y, flat + GRAVITY_HEIGHT, heading, flat, flat, speed, cone)
    save(ROADS["arcs"], tmp_path, ["openscenario"], WORLD, "r", poses)
    played = []
    for line in ET.parse(tmp_path / "r.drive.xosc").getroot().iter("Polyline"):
        told = [(each.get("time"), *map(each[0][0].get, "xy")) for each in line]
        moment, *place = np.array(told, float).T
        played.append(kept_by_esmini(moment, np.array(place).T))
    moment, place = (np.concatenate(parts) for parts in zip(*played, strict=True))
    expected = np.stack([x, y], axis=1) + REAR_AXLE * np.array([np.cos(0.3), np.sin(0.3)])
    found = np.stack([np.interp(time, moment, place[:, k]) for k in (0, 1)], axis=1)
    assert np.hypot(*(found - expected).T).max() < 0.03
