"""Requests that change a scene in words, with the right changes written by hand: what the reader inside and a
chat model make of them, and what is not used."""

import json
from pathlib import Path
from typing import Any

import pytest

from fake_chat import FakeChat
from roadgpt.brief.change import read_request
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.change.request import EditRequest
from roadgpt.brief.change.staging import changed_scene
from roadgpt.brief.plan import read_scene, scene_plan
from roadgpt.chat import ChatSettings
from roadgpt.errors import EditError

FILE = Path(__file__).with_name("scene_requests.jsonl")
ROWS: list[dict[str, Any]] = [*map(json.loads, FILE.read_text(encoding="utf-8").splitlines())]


def staged(scene: str, request: EditRequest) -> str:
    assert not request.changes, "the road stays as it is"
    return scene_plan(changed_scene(read_scene(scene), request.scene, 100.0))


@pytest.mark.parametrize("row", ROWS, ids=[row["request"][:40] for row in ROWS])
def test_a_request_changes_the_scene_as_meant(row: dict[str, Any]) -> None:
    request = read_request(row["request"])
    assert staged(row["scene"], request) == staged(row["scene"], read_change_plan(row["plan"]))
    assert all(any(word in said.split() for said in request.unused) for word in row.get("unused", ()))


@pytest.mark.parametrize("row", ROWS[::8], ids=[row["request"][:40] for row in ROWS[::8]])
def test_a_chat_model_may_read_it_as_well(row: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    scene = [each.strip() for each in row["plan"].removeprefix("&&").split(";")]
    chat = FakeChat(
        json.dumps({"changes": [], "scene": [*scene[:-1], "truck: sing"], "unused": []}),
        json.dumps({"changes": [], "scene": scene, "unused": row["request"].split()[:1]}),
    )
    monkeypatch.setattr("roadgpt.brief.change.chatting.open_chat", lambda _: chat)
    request = read_request(row["request"], ChatSettings(rounds=2))
    assert staged(row["scene"], request) == staged(row["scene"], read_change_plan(row["plan"]))
    assert "'sing' is not expected" in chat.questions[1]
    assert request.unused == tuple(row["request"].split()[:1])


@pytest.mark.parametrize(
    ("words", "unused"),
    [
        ("let the big blue truck brake harder", {"big", "blue"}),
        ("paint the truck red, and let it brake more gently", {"paint the truck red"}),
        ("let the car drift later", set()),
        ("turn the truck into a bus that brakes harder", {"bus"}),
    ],
)
def test_what_a_request_says_without_effect_is_named(words: str, unused: set[str]) -> None:
    assert {*read_request(words).unused} == unused


@pytest.mark.parametrize(
    ("scene", "plan", "after"),
    [
        ("adult crossing left: cross", "adult: as other", "adult crossing right: cross"),
        ("adult crossing left: cross", "adult: as child other", "child crossing right: cross"),
        ("van junction left: cross", "van: add run_light", "van junction left: run_light"),
        ("truck ahead: brake", "truck: add cut_out left", "truck ahead: brake, cut_out left"),
    ],
)
def test_the_other_side_and_another_way_through_a_junction(scene: str, plan: str, after: str) -> None:
    assert staged(scene, read_change_plan(f"&& {plan}")) == after


def test_of_nobody_with_a_side_the_other_one_is_no_change() -> None:
    assert staged("adult crossing: cross", read_change_plan("&& adult: as other")) == "adult crossing: cross"


def test_a_wish_for_somebody_who_is_not_there_is_refused() -> None:
    with pytest.raises(EditError, match=r"the scene has no bus; there is: a truck ahead"):
        staged("truck ahead", read_request("the bus is slower"))
