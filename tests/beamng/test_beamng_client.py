"""The unmodified beamngpy against the fake: what the fake takes, and what it refuses, as BeamNG would."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from beamngpy import BeamNGpy, MeshRoad, Road, Scenario, Vehicle, angle_to_quat
from beamngpy.connection import Connection
from beamngpy.logging import BNGError, BNGValueError
from beamngpy.sensors import Electrics

from beamng.fake_beamng import FakeBeamNG, FakeFault

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
