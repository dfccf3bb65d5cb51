"""The unmodified beamngpy against the fake: what the fake takes, and what it refuses, as BeamNG would."""

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beamngpy import BeamNGpy, MeshRoad, Road, Scenario, Vehicle, angle_to_quat
from beamngpy.connection import Connection
from beamngpy.logging import BNGDisconnectedError, BNGError, BNGValueError
from beamngpy.sensors import Electrics

from drive.beamng.fake_beamng import VERSIONS, FakeBeamNG, FakeFault, fake_home

OURS = Connection.PROTOCOL_VERSION
NODES = [(float(x), 0.0, 0.5, 8.0) for x in range(0, 101, 5)]


def opened(fake: FakeBeamNG) -> BeamNGpy:
    return BeamNGpy("127.0.0.1", fake.port).open(launch=False)


def scenario(
    level: str = "tech_ground", heading: float = 0.0, model: str = "etk800"
) -> tuple[Scenario, Vehicle]:
    made = Scenario(level, "test_scenario")
    road, mesh = Road("asphalt", rid="lanes"), MeshRoad("asphalt", rid="mesh")
    road.add_nodes(*NODES)
    mesh.add_nodes(*NODES)
    made.add_road(road)
    made.add_mesh_road(mesh)
    made.add_checkpoints([(98.0, -2.0, 0.5)], [(4.0, 4.0, 4.0)], ["goal"])
    car = Vehicle("ego", model)
    car.sensors.attach("electrics", Electrics())
    # the fourth argument is called cling up to 1.35 and safe_spawn from 1.36 on
    made.add_vehicle(car, (3.0, -2.0, 1.0), angle_to_quat((0, 0, -(heading + 90))), False)
    return made, car


def loaded(bng: BeamNGpy, **given: Any) -> Vehicle:
    made, car = scenario(**given)
    made.make(bng)
    bng.settings.set_deterministic(50)
    bng.control.pause()
    bng.scenario.load(made)
    bng.scenario.start()
    bng.settings.set_deterministic(50)  # a load makes steps uneven again
    car.set_shift_mode("arcade")  # in the gear that the car stands in it does not move
    return car


@pytest.fixture
def fake() -> Iterator[FakeBeamNG]:
    with FakeBeamNG(protocol=OURS) as server:
        yield server


def test_the_ai_drives_the_lane_to_the_goal(fake: FakeBeamNG) -> None:
    bng = opened(fake)
    car = loaded(bng)
    car.ai.set_waypoint("goal")
    car.ai.set_speed(10.0, "limit")
    car.ai.set_aggression(0.7)
    car.ai.drive_in_lane(True)
    for _ in range(10):
        bng.control.step(50)
        car.sensors.poll("state", "electrics")
        assert abs(car.state["pos"][1] + 2.0) < 0.1
    assert car.state["time"] == pytest.approx(10.0)
    assert car.sensors["electrics"]["wheelspeed"] == pytest.approx(10.0, abs=0.3)
    assert 80 < car.state["pos"][0] < 105
    assert fake.unknown == []
    bng.disconnect()


@pytest.mark.parametrize("heading", [0, 37, 90, -120, 180])
def test_a_car_looks_where_the_known_quaternion_says(fake: FakeBeamNG, heading: float) -> None:
    car = loaded(opened(fake), heading=heading)
    car.sensors.poll("state")
    wanted = [np.cos(np.radians(heading)), np.sin(np.radians(heading)), 0.0]
    assert car.state["dir"] == pytest.approx(wanted, abs=1e-9)
    corners = {name: np.array(corner) for name, corner in car.get_bbox().items()}
    length = corners["front_bottom_left"] - corners["rear_bottom_left"]
    across = corners["front_bottom_left"] - corners["front_bottom_right"]
    assert length / np.linalg.norm(length) == pytest.approx(wanted, abs=1e-9)
    assert np.cross(wanted, across)[2] == pytest.approx(1.86)  # left is left
    assert np.linalg.norm(length) == pytest.approx(4.70)


def test_positive_steering_turns_right(fake: FakeBeamNG) -> None:
    bng = opened(fake)
    car = loaded(bng)
    car.control(steering=0.5, throttle=0.5, brake=0.0, parkingbrake=0.0)
    bng.control.step(100)
    car.sensors.poll("state")
    assert car.state["dir"][1] < -0.05


def test_an_unknown_level_is_refused(fake: FakeBeamNG) -> None:
    made, _ = scenario(level="atlantis")
    with pytest.raises(BNGError, match="level atlantis not found"):
        made.make(opened(fake))


def test_an_unknown_vehicle_is_refused(fake: FakeBeamNG) -> None:
    with pytest.raises(BNGError, match="vehicle dodo not found"):
        loaded(opened(fake), model="dodo")


def test_a_road_without_nodes_is_refused(fake: FakeBeamNG) -> None:
    made, _ = scenario()
    made.add_road(Road("asphalt", rid="empty"))
    with pytest.raises(Exception, match=r"no element 0|prefab line|two nodes or more"):
        made.make(opened(fake))


def test_a_road_of_one_node_is_refused(fake: FakeBeamNG) -> None:
    made, _ = scenario()
    short = Road("asphalt", rid="short")
    short.add_nodes((0.0, 0.0, 0.0, 8.0))
    made.add_road(short)
    with pytest.raises(BNGError, match="two nodes or more"):
        made.make(opened(fake))


def test_two_objects_of_one_name_are_refused(fake: FakeBeamNG) -> None:
    made, _ = scenario()
    twin = Road("asphalt", rid="lanes")
    twin.add_nodes(*NODES)
    made.add_road(twin)
    with pytest.raises(BNGError, match="not unique: lanes"):
        made.make(opened(fake))


def test_nothing_can_be_added_between_make_and_load(fake: FakeBeamNG) -> None:
    bng = opened(fake)
    made, _ = scenario()
    made.make(bng)
    late = Road("asphalt", rid="late")
    late.add_nodes(*NODES)
    if OURS == "v1.27":
        with pytest.raises(BNGError, match="Cannot add a road"):
            made.add_road(late)
    else:  # clients before 1.36 lose it without a word
        made.add_road(late)
    bng.scenario.load(made)
    assert fake.world is not None
    assert set(fake.world.decals) == {"lanes"}


@pytest.mark.parametrize("other", sorted({*VERSIONS, "v1.19"} - {OURS}))
def test_another_protocol_is_refused(other: str) -> None:
    with FakeBeamNG(protocol=other) as fake, pytest.raises(BNGError, match="Mismatching"):
        opened(fake)


def test_who_does_not_greet_is_not_talked_to(fake: FakeBeamNG) -> None:
    link = Connection("127.0.0.1", fake.port)
    link.hello = lambda: None  # type: ignore[method-assign]
    assert link.connect_to_beamng(tries=1)
    with pytest.raises(BNGDisconnectedError):
        link.message("GetLevels")


def test_starting_needs_a_scenario_and_a_waypoint_must_exist(fake: FakeBeamNG) -> None:
    bng = opened(fake)
    with pytest.raises(BNGError, match=r"scenario (is )?loaded"):
        bng.scenario.start()
    car = loaded(bng)
    with pytest.raises(BNGError, match="no waypoint nowhere"):
        car.ai.set_waypoint("nowhere")


def test_an_unknown_message_is_told_of(fake: FakeBeamNG) -> None:
    with pytest.raises(BNGValueError, match="no message GetGravity"):
        opened(fake).env.get_gravity()
    assert fake.unknown == [("", "GetGravity")]


@pytest.mark.parametrize(
    ("kind", "error"),
    [
        ("error", BNGError),
        ("value_error", BNGValueError),
        ("wrong_ack", BNGError),
        ("drop", Exception),
        ("half", Exception),
        ("garbage", Exception),
    ],
)
def test_faults_come_once_at_their_message(kind: str, error: type[Exception]) -> None:
    with FakeBeamNG(protocol=OURS, faults=(FakeFault(kind, "Step", nth=2),)) as fake:
        bng = opened(fake)
        loaded(bng)
        bng.control.step(1)
        with pytest.raises(error):
            bng.control.step(1)
        assert fake.fired == [0]


def test_the_client_starts_it_as_its_home_and_ends_it(tmp_path: Path, port: int) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS, slow_start=0.3)
    bng = BeamNGpy("127.0.0.1", port, home=str(home), user=str(tmp_path / "user")).open()
    assert bng.tech_enabled()
    assert str(bng.user_with_version).startswith(str(tmp_path / "user"))
    assert bng.process is not None
    process = bng.process
    bng.close()
    assert process.poll() is not None
    (started,) = (home / "started.jsonl").read_text().splitlines()
    words = json.loads(started)["words"]
    assert words[:4] == ["-nosteam", "-tcom", "-tport", str(port)]


@pytest.mark.parametrize("words", [["-tcom"], ["-tport", "1"], ["-tcom", "-tport", "1", "-flying"]])
def test_the_binary_takes_what_beamng_takes_and_no_more(tmp_path: Path, words: list[str]) -> None:
    home = fake_home(tmp_path / "home")
    done = subprocess.run(
        [home / "BinLinux" / "BeamNG.tech.x64", *words], capture_output=True, check=False, timeout=60
    )
    assert done.returncode == 2
