"""The method of the thesis through a server: a run and a campaign."""

import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from chat.stub_server import StubServer, says, serving
from planned import planned
from roadgpt.campaign import campaign
from roadgpt.chat import ChatSettings
from roadgpt.chat.providers.openai import forget
from roadgpt.run import Setup, perform

BRIEF = planned("turn x3", "a road with 3 turns")
SEGMENTS = [(40, 0), (40, 50), (20, 0), (40, -60), (20, 0), (40, 40)]
SIDES = {1: "left", -1: "right", 0: "straight"}


def road(**more: object) -> dict[str, object]:
    made = [
        {"distance": d, "direction": SIDES[(t > 0) - (t < 0)], "incline": 0, "turn_degrees": t}
        for d, t in SEGMENTS
    ]
    numbered = {f"road_segment{i}": one for i, one in enumerate(made, 1)}
    return {"starting_point": [60, 125, 0], "theta": 0, **numbered, **more}


GOOD = json.dumps(road())


@pytest.fixture(scope="module")
def stub() -> Iterator[StubServer]:
    with serving(says(GOOD)) as server:
        yield server


@pytest.fixture(autouse=True)
def _alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Without settings and habits of whoever runs the tests, and without pauses."""
    for name in [name for name in os.environ if name.startswith(("OPENAI_", "ROADGPT_"))]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "home"))
    monkeypatch.setenv("OPENAI_API_KEY", "sk-secret-of-mine")
    clock = SimpleNamespace(sleep=lambda seconds: None, time=time.time)
    monkeypatch.setattr("openai._base_client.time", clock)
    monkeypatch.chdir(tmp_path)
    forget()
    yield
    forget()


def setup(stub: StubServer, **more: object) -> Setup:
    told = {"model": "stub-model", "base_url": stub.url, "timeout": 5, "retries": 2, "rounds": 2, **more}
    return Setup(reader="plan", designer="thesis", drives=False, chat=ChatSettings(**told))


def test_the_thesis_method_asks_once_and_its_invalid_road_counts_as_invalid(stub: StubServer) -> None:
    outside = road(starting_point=[245, 9, 0])
    stub.play(says(json.dumps(outside)))
    run = perform(BRIEF, seed=3, setup=setup(stub))
    assert len(stub.requests) == 1
    assert run.outcome == "INVALID"
    assert run.road is not None
    assert run.road.nodes is not None
    assert run.rounds == 1


def test_a_model_that_fails_costs_one_road_and_nothing_of_those_before(
    stub: StubServer, tmp_path: Path
) -> None:
    other = json.dumps(road(starting_point=[60, 60, 0]))
    stub.play(says(GOOD), says("nothing"), says(other))
    runs = list(campaign(BRIEF, 3, seed=3, setup=setup(stub, retries=0), out=tmp_path / "c"))
    assert [run.road is not None for run in runs] == [True, False, True]
    assert runs[1].outcome == "ERROR"
    assert len(list((tmp_path / "c" / "runs").iterdir())) == 3
