"""A campaign of 20 roads through a BeamNG that fails ten times loses nothing; so do workers side by side."""

import json
from pathlib import Path

import pytest
from beamngpy.connection import Connection

from beamng.fake_beamng import FakeBeamNG, FakeFault, fake_home
from misbehaving import write
from roadgpt.campaign import CellBudget, Plan, begin, campaign, status_of, work
from roadgpt.errors import GivenUpError, RoadGPTError
from roadgpt.road import World
from roadgpt.run import Setup
from roadgpt_beamng.launch import take
from roadgpt_beamng.session import leave_all
from roadgpt_beamng.settings import BeamngSettings
from roadgpt_sbft import Experiment, compete

OURS = Connection.PROTOCOL_VERSION
ROADS = 20
SHORTEST = "straight | turns=0 len=22"  # messages are what such a test costs: 90 or so for this road
# Every kind, in the middle of driving and while a road is laid; what is made anew counts as a scenario too.
FAULTS = [
    FakeFault("hang", "SensorRequest", 2, 20),
    FakeFault("drop", "Step", 5, 15),
    FakeFault("die", "SensorRequest", 8, 28),
    FakeFault("error", "LoadScenario", 11, 1),
    FakeFault("half", "SensorRequest", 14, 20),
    FakeFault("garbage", "Step", 17, 12),
    FakeFault("die", "CreateScenario", 19, 1),
    FakeFault("wrong_ack", "Step", 22, 22),
    FakeFault("hang", "LoadScenario", 24, 1),
    FakeFault("value_error", "SetAiWaypoint", 27, 1),
]


def settings(monkeypatch: pytest.MonkeyPatch, home: Path, port: int, **more: object) -> None:
    given = {
        "home": home,
        "port": port,
        "rate": 20,
        "poll_timeout": 1.5,
        "load_timeout": 1.5,
        "first_load_timeout": 5,
        **more,
    }
    for name, value in given.items():
        monkeypatch.setenv(f"ROADGPT_BEAMNG_{name.upper()}", str(value))


def test_twenty_roads_and_ten_faults_lose_nothing(
    tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = fake_home(tmp_path / "home", protocol=OURS, faults=FAULTS)
    settings(monkeypatch, home, port, recycle=8)
    setup = Setup(reader="plan", simulator="beamng", driver="beamng_like")
    made = campaign(SHORTEST, ROADS, 5, World(), setup, tmp_path / "out")
    outcomes = [run.outcome for run in made]
    assert outcomes == ["PASS"] * ROADS
    assert json.loads((home / "state.json").read_text())["fired"] == list(range(len(FAULTS)))
    kept = [json.loads(path.read_text()) for path in sorted((tmp_path / "out").glob("test.*.json"))]
    assert len(kept) == ROADS
    assert all(test["test_outcome"] == "PASS" and test["execution_data"] for test in kept)


def test_a_road_that_fails_twice_is_one_error_and_the_campaign_goes_on(
    tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    faults = [FakeFault("die", "Step", 2, 9), FakeFault("drop", "SensorRequest", 3, 9)]
    settings(monkeypatch, fake_home(tmp_path / "home", protocol=OURS, faults=faults), port)
    setup = Setup(reader="plan", simulator="beamng")
    runs = list(campaign(SHORTEST, 4, 5, World(), setup, tmp_path / "out"))
    assert [run.outcome for run in runs] == ["PASS", "ERROR", "PASS", "PASS"]
    assert "BeamNG failed 2 times on this road" in runs[1].description
    assert runs[0].versions["beamngpy"]
    assert "aggression 0.7, 20 steps/s" in runs[0].versions["beamng"]


class Surveyed(FakeBeamNG):
    """Keeps how high above the level's ground each road lay."""

    heights: list[float]

    def ge_LoadScenario(self, message: object) -> object:  # noqa: N802
        answer = super().ge_LoadScenario(message)
        self.heights.append(max(node[2] for mesh in self.world.meshes for node in mesh.nodes))
        return answer


def test_a_generator_of_the_competition_is_driven_on_the_levels_ground(
    tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, "pass")
    experiment = Experiment(
        module_name="misbehaves", class_name="Generator", module_path=str(tmp_path), test_budget=5
    )
    setup = Setup(simulator="beamng")
    monkeypatch.setenv("ROADGPT_BEAMNG_RATE", "20")
    monkeypatch.setenv("ROADGPT_BEAMNG_PORT", str(port))
    with pytest.raises(RoadGPTError, match="not even a straight road can be driven: nobody listens on"):
        list(compete(experiment, setup=setup, out=tmp_path / "alone"))
    with Surveyed(port, protocol=OURS) as fake:
        fake.heights = []
        runs = list(compete(experiment, setup=setup, out=tmp_path / "out"))
        leave_all()
    assert [run.outcome for run in runs] == ["PASS", "PASS"]
    assert fake.heights == pytest.approx([0.0] * 3)
    test = json.loads((tmp_path / "out" / "test.0002.json").read_text())
    assert test["execution_data"][0][1][2] == pytest.approx(-28 + 0.56, abs=0.02)
    assert test["execution_data"][-1][0] == pytest.approx(runs[1].drive.duration, abs=0.001)


def test_a_dead_simulator_is_given_up_and_no_road_is_lost(
    tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROADGPT_BEAMNG_PORT", str(port))
    monkeypatch.setenv("ROADGPT_BEAMNG_RATE", "20")
    setup, out = Setup(reader="plan", simulator="beamng"), tmp_path / "out"
    with pytest.raises(
        GivenUpError, match=r"failed 3 times in a row .*nobody listens on .*fix it and continue$"
    ) as caught:
        list(campaign(SHORTEST, 8, 5, World(), setup, out))
    assert caught.value.exit_status == 5
    assert not [*out.glob("test.*.json"), *(out / "runs").iterdir()]
    with FakeBeamNG(port, protocol=OURS):
        again = list(campaign(SHORTEST, 8, 5, World(), setup, out))
        leave_all()
    parked = setup.model_copy(update={"drives": False})
    whole = list(campaign(SHORTEST, 8, 5, World(), parked, tmp_path / "whole"))
    assert [run.outcome for run in again] == ["PASS"] * 8
    assert [run.design for run in again] == [run.design for run in whole]
    table = (out / "generation_stats.csv").read_text().splitlines()[1]
    assert table.startswith("8,8,0,8,0,0,")


def test_a_campaign_of_workers_gives_up_and_resumes(
    tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker's BeamNG has the next port and user folder where another process has taken the first."""
    monkeypatch.setenv("ROADGPT_BEAMNG_PORT", str(port))
    monkeypatch.setenv("ROADGPT_BEAMNG_RATE", "20")
    budget = CellBudget(tests=3)
    plan = Plan(prompts=(SHORTEST,), reader="plan", simulators=("beamng",), budget=budget, seeds=(5,))
    begin(plan, tmp_path / "c")
    with pytest.raises(GivenUpError, match=r"nobody listens on .*fix it and continue$"):
        list(work(tmp_path / "c", 1))
    before = status_of(tmp_path / "c")
    assert before.outcomes == {}
    assert not before.is_finished
    home, user = fake_home(tmp_path / "home", protocol=OURS), tmp_path / "user"
    (user / "0.39").mkdir(parents=True)
    (user / "0.39" / "tech.key").write_text("key")
    monkeypatch.setenv("ROADGPT_BEAMNG_HOME", str(home))
    monkeypatch.setenv("ROADGPT_BEAMNG_USER", str(user))
    ours = take(BeamngSettings.of())
    *_, last = work(tmp_path / "c", 1)
    ours.release()
    assert last["PASS"] >= 2
    assert last.total() == 3
    words = json.loads((home / "started.jsonl").read_text().splitlines()[0])["words"]
    assert words[words.index("-tport") + 1] == str(ours.port + 1)
    assert words[words.index("-userpath") + 1] == f"{user}-2"
    assert (tmp_path / "user-2" / "0.39" / "tech.key").read_text() == "key"
    assert status_of(tmp_path / "c").is_finished


def test_a_generator_of_the_competition_is_stopped_where_the_simulator_is_dead(
    tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, "while True: self.executor.execute_test(RoadTestFactory.create_road_test(straight()))")
    experiment = Experiment(
        module_name="misbehaves", class_name="Generator", module_path=str(tmp_path), test_budget=50
    )
    monkeypatch.setenv("ROADGPT_BEAMNG_RATE", "20")
    monkeypatch.setenv("ROADGPT_BEAMNG_PORT", str(port))
    fake = FakeBeamNG(port, protocol=OURS)
    runs = iter(compete(experiment, setup=Setup(simulator="beamng"), out=tmp_path / "out"))
    outcomes = [next(runs).outcome for _ in range(2)]
    fake.stop()
    leave_all()
    outcomes += [next(runs).outcome for _ in range(3)]
    with pytest.raises(GivenUpError, match=r"nobody listens on .*the tests until then are in .*out"):
        next(runs)
    assert outcomes == ["PASS", "PASS", "ERROR", "ERROR", "ERROR"]
    assert len([*(tmp_path / "out").glob("test.*.json")]) == 5
