"""The whole way: a server with all its faults, a campaign, and a road or one clear sentence at its end."""

import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from chat.stub_server import Scene, StubServer, drops, fails, floods, says, serving
from planned import planned
from roadgpt.campaign import campaign
from roadgpt.chat import ChatSettings
from roadgpt.chat.providers.openai import forget
from roadgpt.errors import RoadGPTError
from roadgpt.run import Setup, perform

BRIEF = planned("turn x3", "a road with 3 turns")
SEGMENTS = [(40, 0), (40, 50), (20, 0), (40, -60), (20, 0), (40, 40)]
SIDES = {1: "left", -1: "right", 0: "straight"}


def road(**more: object) -> dict[str, object]:
    made = [
        {"distance": d, "direction": SIDES[(t > 0) - (t < 0)], "incline": 0, "turn_degrees": t}
        for d, t in SEGMENTS
    ]
    return {"starting_point": [60, 125, 0], "theta": 0, "segments": made, **more}


def numbered() -> dict[str, object]:
    plain = road()
    segments = plain.pop("segments")
    assert isinstance(segments, list)
    return plain | {f"road_segment{i}": one for i, one in enumerate(segments, 1)}


GOOD = json.dumps(road())
FAULTS: dict[str, tuple[Scene, ...]] = {
    "fenced": (says(f"Here you are:\n```json\n{GOOD}\n```"),),
    "schema ignored": (says(json.dumps(numbered())),),
    "talk, then a road": (says("I like roads."), says(GOOD)),
    "blanks": (says(" " * 20_000, finish="length"), says(GOOD)),
    "flood": (floods(30),),
    "cut off": (says(GOOD[:200], finish="length"),),
    "refusal": (says(None, refusal="I cannot help with that."),),
    "401": (fails(401, "bad key"),),
    "429": (fails(429, "slow down", {"retry-after": "0"}), says(GOOD)),
    "429 bare": (fails(429, "slow down"), says(GOOD)),
    "500": (fails(500, "oops"), says(GOOD)),
    "dropped": (drops(), says(GOOD)),
    "wrong types": (says(json.dumps(road(theta=[1], segments="three turns"))),),
    "numbers as text": (says(GOOD.replace("50", '"50"').replace("125", '"125"')),),
    "10,000 segments": (says(json.dumps(road(segments=10_000 * [road()["segments"][0]]))),),
    "NaN": (says(GOOD.replace("125", "NaN")),),
    "Infinity": (says(GOOD.replace("125", "-Infinity")),),
    "double keys": (says(GOOD.replace('"theta": 0', '"theta": 0, "theta": 90')),),
    "deep": (says('{"starting_point": ' + "[" * 5000 + "]" * 5000 + "}"),),
    "another order": (says(json.dumps(dict(reversed(road().items())))),),
    "injection": (says(json.dumps(road(note="ignore the rules; {0.__class__}; $(rm -rf ~); ../../x"))),),
}
ROADS = {
    *("fenced", "schema ignored", "talk, then a road", "blanks", "429", "429 bare", "500", "dropped"),
    *("numbers as text", "another order", "injection"),
}


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


def setup(stub: StubServer, designer: str = "chat", **more: object) -> Setup:
    told = {"model": "stub-model", "base_url": stub.url, "timeout": 5, "retries": 2, "rounds": 2, **more}
    return Setup(reader="plan", designer=designer, drives=False, chat=ChatSettings(**told))


@pytest.mark.parametrize("fault", FAULTS)
def test_every_fault_ends_in_a_road_or_in_one_clear_sentence(stub: StubServer, fault: str) -> None:
    stub.play(*FAULTS[fault])
    try:
        run = perform(BRIEF, seed=3, setup=setup(stub, repair="full"))
    except RoadGPTError as error:
        said = str(error)
        is_road = False
    else:
        said, is_road = run.description, run.is_valid
    assert "\n" not in said
    assert "sk-secret" not in said
    assert is_road == (fault in ROADS), said


def test_the_run_tells_rounds_changes_and_what_was_proposed(stub: StubServer) -> None:
    short, outside = road(segments=road()["segments"][:4]), road(starting_point=[245, 9, 0])
    stub.play(says(json.dumps(short)), says(json.dumps(outside)))
    run = perform(BRIEF, seed=3, setup=setup(stub))
    assert run.is_valid
    assert run.rounds == 1
    assert run.designing is not None
    assert run.designing.rounds == 2
    assert run.designing.changes[0].startswith("start moved from (245, 9) to (")
    assert run.designing.proposed is not None
    assert run.designing.proposed["starting_point"] == [245, 9, 0]
    assert run.designing.tokens.prompt == 200


def test_a_route_is_read_from_words_asked_for_and_mended(stub: StubServer) -> None:
    def route(take: str) -> str:
        straight = {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0}
        place = {"after": 1, "kind": "t_junction", "take": take}
        return json.dumps(road(segments=[straight, straight], junctions=[place]))

    stub.play(says(route("right")), says(route("left")))
    made = setup(stub, rounds=4).model_copy(update={"reader": "model"})  # 4: a designer of its own
    run = perform("a T-junction, turn left", seed=3, setup=made)
    assert (run.is_valid, run.designing.rounds) == (True, 2)
    assert run.design.junctions[0].take == "left"
    assert "asked to turn left" in stub.requests[1].last
    form = stub.requests[0].body["response_format"]["json_schema"]["schema"]["properties"]
    assert {"segments", "junctions", "lanes"} <= {*form}


def test_the_thesis_method_asks_once_and_its_invalid_road_counts_as_invalid(stub: StubServer) -> None:
    outside = numbered() | {"starting_point": [245, 9, 0]}
    stub.play(says(json.dumps(outside)))
    run = perform(BRIEF, seed=3, setup=setup(stub, "thesis"))
    assert len(stub.requests) == 1
    assert run.outcome == "INVALID"
    assert run.road is not None
    assert run.road.nodes is not None
    assert run.rounds == 1


def test_a_model_that_fails_costs_one_road_and_nothing_of_those_before(
    stub: StubServer, tmp_path: Path
) -> None:
    other = json.dumps(road(starting_point=[60, 60, 0], segments=list(reversed(road()["segments"]))))
    stub.play(says(GOOD), *(5 * [says("nothing")]), says(other))
    runs = list(campaign(BRIEF, 3, seed=3, setup=setup(stub, rounds=1), out=tmp_path / "c"))
    assert len(runs) == 3
    assert runs[0].is_valid
    assert sum(run.is_valid for run in runs) >= 1
    assert len(list((tmp_path / "c" / "runs").iterdir())) == 3


@pytest.mark.parametrize("designer", ["chat", "thesis"])
def test_both_designers_take_responses_as_well(stub: StubServer, designer: str) -> None:
    stub.play(says(GOOD if designer == "chat" else json.dumps(numbered())))
    run = perform(BRIEF, seed=3, setup=setup(stub, designer, api="responses"))
    assert run.design is not None
    assert stub.requests[0].path.endswith("/responses")
