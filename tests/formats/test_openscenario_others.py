"""OpenSCENARIO with others: ASAM's checker finds nothing, and everybody is where and when they were."""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from exported import LATE, LEAVES, ROADS, WORLD, among_others, asam_says, drive
from roadgpt.brief.plan import read_scene
from roadgpt.drive import COLUMNS, Box, Columns, Drive
from roadgpt.export import Poses, doubts, save
from roadgpt.road import Road, World
from roadgpt.run import Setup, perform
from roadgpt.run.exporting import export, poses_of
from roadgpt.traffic import Tracks
from roadgpt.traffic.recording import read_recording

ROAD = ROADS["arcs"]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Tracks]:
    folder, (poses, tracks) = tmp_path_factory.mktemp("others"), among_others()
    save(ROAD, folder, ["openscenario"], WORLD, "scene", poses)
    save(ROAD, folder, ["openscenario"], WORLD, "alone", drive(ROAD, WORLD))
    return folder / "scene.drive.xosc", tracks


BOTH = pytest.mark.parametrize("name", ["scene.drive.xosc", "scene.xosc"])  # the drive, and the scenario


@BOTH
def test_asams_checker_objects_to_nothing(written: tuple[Path, Tracks], name: str) -> None:
    issues, ends = asam_says(written[0].with_name(name))
    assert issues == []
    assert ends == {"completed": 17}


def motions(root: ET.Element, name: str) -> list[tuple[float, np.ndarray]]:
    """Times and poses x, y, z, h, p, r of an entity: where it is put at first, and all its vertices."""
    found = []
    for private in root.iterfind(f"Storyboard/Init/Actions/Private[@entityRef='{name}']"):
        found += [(0.0, place) for place in private.iter("WorldPosition")]
    for group in root.iter("ManeuverGroup"):
        if group.find(f"Actors/EntityRef[@entityRef='{name}']") is not None:
            for vertex in group.iter("Vertex"):
                found.append((float(vertex.attrib["time"]), vertex.find("Position/WorldPosition")))
    return [(time, np.array([float(place.attrib[key]) for key in "xyzhpr"])) for time, place in found]


@BOTH
def test_everybody_is_where_the_drive_recorded_them(written: tuple[Path, Tracks], name: str) -> None:
    path, tracks = written
    root = ET.parse(path.with_name(name)).getroot()
    for number, actor in enumerate(tracks.actors):
        entity = root.find(f"Entities/ScenarioObject[@name='{actor.name}']")
        centre = entity.find(".//Center").attrib
        middle = np.array([float(centre[key]) for key in "xyz"])
        size = entity.find(".//Dimensions").attrib
        assert tuple(float(size[key]) for key in ("length", "width", "height")) == actor.size
        states, moments = tracks.states[:, number], motions(root, actor.name)
        there = np.flatnonzero(~np.isnan(states[:, 0])) * 0.1
        assert moments[0][0] == pytest.approx(there[0])
        if len(moments) > 1:
            assert moments[-1][0] == pytest.approx(there[-1])
        for time, (x, y, z, h, p, r) in moments:
            at = [x, y, z] + Rotation.from_euler("ZYX", [h, p, r]).apply(middle)
            state = states[round(time / 0.1)]
            up = Rotation.from_euler("ZYX", [h, p, r]).apply([0, 0, actor.size.height / 2])
            np.testing.assert_allclose(at - up, state[:3], atol=2e-3)
            assert np.cos(h - state[3]) > 1 - 1e-6
        if number == LATE:  # it climbs and falls with the road
            grade = [float(ROAD.grade(ROAD.locate(*pose[:2])[0])) for _, pose in moments[3:-3]]
            np.testing.assert_allclose([-np.tan(pose[4]) for _, pose in moments[3:-3]], grade, atol=0.03)


def first_speed(root: ET.Element, name: str) -> float:
    """The speed in m/s that an entity has at first."""
    (found,) = root.iterfind(f"Storyboard/Init/Actions/Private[@entityRef='{name}']//AbsoluteTargetSpeed")
    return float(found.attrib["value"])


def test_who_is_placed_stands_where_a_drive_of_the_same_seed_begins(tmp_path: Path) -> None:
    """Nobody has driven: the others are where the drive has them at first, with their speed of that time."""
    words = "straight 160 && truck ahead gap=30 v=50: brake decel=6; car parked"
    driven, alone = (
        perform(words, 4, setup=Setup(driver="reference", reader="plan", drives=drives))
        for drives in (True, False)
    )
    assert driven.drive is not None
    assert driven.drive.others is not None
    said = list[str]()
    export(alone, tmp_path, ["openscenario"], said.append)
    assert said == []
    assert asam_says(tmp_path / "road.xosc") == ([], {"completed": 17})
    assert not (tmp_path / "road.drive.xosc").exists()
    tracks = driven.drive.others
    root = ET.parse(tmp_path / "road.xosc").getroot()
    assert len(tracks.actors) == 2
    for actor, state in zip(tracks.actors, tracks.states[0], strict=True):
        ((_, pose),) = motions(root, actor.name)
        ahead = float(root.find(f"Entities/ScenarioObject[@name='{actor.name}']//Center").attrib["x"])
        way = [np.cos(state[3]), np.sin(state[3])]
        np.testing.assert_allclose(pose[:2] + ahead * np.array(way), state[:2], atol=2e-3)
        assert first_speed(root, actor.name) == pytest.approx(state[4])
    # nor does the tested car start from rest
    speed = driven.drive["speed"]
    assert first_speed(root, "Ego") == pytest.approx(speed[0], abs=0.01)
    assert speed[0] > 10.0
    export(driven, tmp_path, ["openscenario"], said.append)
    root = ET.parse(tmp_path / "road.xosc").getroot()
    assert first_speed(root, "Ego") == pytest.approx(speed[0], abs=0.01)
    entries = [*root.iter("SpeedProfileEntry")]
    waits, speeds = (np.array([float(each.attrib[name]) for each in entries]) for name in ("time", "speed"))
    time = driven.drive["time"] - driven.drive["time"][0]
    assert np.interp(time, np.cumsum(waits), speeds) == pytest.approx(np.abs(speed), abs=0.15)  # simplified


def test_who_is_not_there_at_first_is_named(tmp_path: Path) -> None:
    """Nobody has driven: who comes to the junction later is in no file, and is told."""
    plan = "straight 100 // crossroads straight stop angle=90 // straight 60 && ego v=36; "
    run = perform(f"{plan}car junction left v=36", 1, setup=Setup(reader="plan", drives=False))
    said = list[str]()
    export(run, tmp_path, ["openscenario"], said.append)
    entities = ET.parse(tmp_path / "road.xosc").getroot().iterfind("Entities/ScenarioObject")
    assert [each.attrib["name"] for each in entities] == ["Ego"]
    assert said == ["others left out, who come later: car 1; drive the road to have them"]


def test_who_comes_late_and_who_leaves_is_added_and_deleted(written: tuple[Path, Tracks]) -> None:
    root = ET.parse(written[0]).getroot()
    names = [actor.name for actor in written[1].actors]
    changes = {}
    for event in root.iter("Event"):
        for action in event.iter("EntityAction"):
            time = float(event.find(".//SimulationTimeCondition").attrib["value"])
            changes[action.attrib["entityRef"], action[0].tag] = time
    assert changes == {
        (names[LATE], "AddEntityAction"): pytest.approx(7.1),
        (names[LEAVES], "DeleteEntityAction"): pytest.approx(9.0),
    }
    at_first = {each.attrib["entityRef"] for each in root.iterfind("Storyboard/Init/Actions/Private")}
    assert at_first == {"Ego", *names} - {names[LATE]}


def test_what_was_written_is_replayed_as_it_was(written: tuple[Path, Tracks]) -> None:
    path, tracks = written
    found = read_recording(path)
    assert "it is the tested car: Ego" in found.remarks[0]
    again = found.on(ROAD, WORLD)
    assert [(a.name, a.kind, a.size) for a in again.actors] == [
        (a.name, a.kind, pytest.approx(a.size)) for a in tracks.actors
    ]
    count = min(len(again), len(tracks))
    np.testing.assert_allclose(again.states[:count, :, :3], tracks.states[:count, :, :3], atol=0.03)
    np.testing.assert_allclose(again.states[:count, :, 3], tracks.states[:count, :, 3], atol=2e-3)


def test_alone_the_file_is_that_of_a_drive_without_others(written: tuple[Path, Tracks]) -> None:
    alone = written[0].with_name("alone.drive.xosc").read_text()
    assert "GlobalAction><EntityAction" not in alone
    assert alone.count("ScenarioObject name") == 1
    poses, tracks = among_others()
    columns = dict.fromkeys(COLUMNS, poses.x * 0) | {name: getattr(poses, name) for name in Poses.names()}
    driven = Drive("d", "mujoco", 0, Columns(columns), "goal", Box(4.7, 1.86), others=tracks)
    both = poses_of(driven)
    assert both is not None
    assert both.others is not None
    np.testing.assert_array_equal(both.others.states, tracks.states)
    assert both.others.time[-1] == pytest.approx(0.1 * (len(tracks) - 1))


def test_lights_that_ran_are_in_the_file(tmp_path: Path) -> None:
    plan = "straight 100 // crossroads straight lights angle=90 // straight 60 && ego v=36; "
    run = perform(
        f"{plan}car junction left v=36 impact=50: run_light", 1, setup=Setup(driver="robot", reader="plan")
    )
    assert run.verdict is not None
    assert run.drive is not None
    assert "red light" not in {each.kind for each in run.verdict.incidents or ()}
    export(run, tmp_path, ["openscenario"], print)
    file, map_ = tmp_path / "road.drive.xosc", ET.parse(tmp_path / "road.xodr").getroot()
    assert asam_says(file) == ([], {"completed": 17})
    (controller,) = ET.parse(file).getroot().iterfind("RoadNetwork/TrafficSignals/TrafficSignalController")
    named = {each.attrib["id"]: each for each in map_.iterfind("controller")}[controller.attrib["name"]]
    ids = {each.attrib["signalId"] for each in named.iter("control")}
    roads = {
        s.attrib["id"]: r.attrib["id"] for r in map_.iterfind("road") for s in r.iterfind("signals/signal")
    }
    time, (way,) = 0.0, run.road.passages
    passed = float(np.interp(way.start, run.drive["s"], run.drive["time"]))
    for phase in controller:
        shown = {state.attrib["trafficSignalId"]: state.attrib["state"] for state in phase}
        assert {*shown} == ids
        begun, time = time, time + float(phase.attrib["duration"])
        green = {roads[each] for each, lamps in shown.items() if lamps == "off;off;on"}
        assert len(green) in (0, 2)  # opposite arms
        if begun <= passed < time:
            assert green == {str(way.arrival.road), str(way.departure.road)}
            assert sorted(shown.values()) == ["off;off;on"] * 2 + ["on;off;off"] * 2
    assert time == pytest.approx(2 * (15 + 3 + 2))  # FHWA: two pairs of arms


def test_weather_that_the_standard_lacks_is_told() -> None:
    road = Road.through([[0, 0], [100, 0]])
    wild, usual = (World(scene=read_scene(scene)) for scene in ("rain; hail; dust", "rain; fog 30"))
    assert doubts(road, ["openscenario"], wild) == (
        "openscenario: a scene has one precipitation, so hail is left out",
        "openscenario: the standard has no dust, so it is written as fog",
    )
    assert doubts(road, ["openscenario"], usual) == ()
