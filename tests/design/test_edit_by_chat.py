"""Edits by a language model: whatever it answers, segments that nobody spoke of stay as they were."""

import json
from dataclasses import replace
from typing import Any

import pytest

from edit_truth import changed_besides, roads
from fake_chat import FakeChat
from roadgpt import check
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.chat import BudgetError, ChatSettings, UnparsableError
from roadgpt.check.measures import measure
from roadgpt.design.edit import EditRequest, edit
from roadgpt.errors import EditError
from roadgpt.road import Design, World, build

WORLD = World()
OLD = roads()["r01"]  # turn 2 is segment 5
WORDS = "make the second turn sharper"
FIELDS = {"distance", "direction", "incline", "turn_degrees"}


def answer(touched: list[int], more: dict[int, dict[str, Any]] | None = None, leave_out: int = 0) -> str:
    """The old road as a model would write it, some segments changed."""
    segments = [
        {"was": number, **segment.model_dump(include=FIELDS), **(more or {}).get(number, {})}
        for number, segment in enumerate(OLD.segments, 1)
        if number != leave_out
    ]
    return json.dumps({"touched": touched, "theta": OLD.theta, "segments": segments})


def request(words: str, plan: str) -> EditRequest:
    """Words that are read as this plan says."""
    return replace(read_change_plan(plan), words=words)


SECOND = request(WORDS, "turn 2: angle more")


def edited(
    chat: FakeChat, words: str | EditRequest = SECOND, **settings: Any
) -> tuple[Design, tuple[str, ...]]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("roadgpt.design.edit.open_chat", lambda _: chat)
        after = edit(OLD, words, WORLD, designer="chat", chat=ChatSettings(**settings))
    return after.design, after.changes


SHARPER = {5: {"turn_degrees": 65.0, "distance": 33.0}}


def test_a_good_answer_is_taken() -> None:
    chat = FakeChat(answer([5], SHARPER))
    design, changes = edited(chat)
    assert changed_besides(OLD, design, [5]) == []
    assert measure(build(design).centreline()).turns[1].degrees == pytest.approx(65, abs=1.5)
    assert any("turn 2" in sentence for sentence in changes)
    assert "turn 2, 54 degrees to the left" in chat.questions[0]
    assert WORDS in chat.questions[0]


def test_what_it_changes_besides_is_put_back() -> None:
    more = {**SHARPER, 1: {"distance": 99.0}, 9: {"incline": -9.0}, 7: {"turn_degrees": 12.0}}
    design, _ = edited(FakeChat(answer([5], more)))
    assert changed_besides(OLD, design, [5]) == []


def test_it_may_not_name_more_than_the_request_speaks_of() -> None:
    more = {**SHARPER, 1: {"distance": 25.0}, 9: {"incline": -9.0}}
    design, _ = edited(FakeChat(answer([*range(1, 10)], more)))
    assert changed_besides(OLD, design, [5]) == []


def test_a_request_in_words_is_read_for_what_it_is_about() -> None:
    more = {**SHARPER, 1: {"distance": 25.0}}
    design, _ = edited(FakeChat(answer([1, 5], more)), WORDS)
    assert changed_besides(OLD, design, [5]) == []


def test_where_the_request_cannot_be_read_the_model_says_what_it_is_about(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(words: str) -> EditRequest:
        raise EditError("not understood")

    monkeypatch.setattr("roadgpt.brief.change.read_request", refuse)
    design, _ = edited(FakeChat(answer([5], SHARPER)), "spice up the second turn, would you")
    assert changed_besides(OLD, design, [5]) == []
    assert design.segments[4] != OLD.segments[4]


def test_only_its_slope_changed_a_turn_keeps_radius_and_transition() -> None:
    design, _ = edited(
        FakeChat(answer([5], {5: {"incline": 8.0}})),
        request("make the second turn steeper", "turn 2: slope more"),
    )
    assert design.segments[4] == OLD.segments[4].model_copy(update={"incline": 8.0})


@pytest.mark.parametrize(
    ("bad", "said"),
    [
        (answer([5], SHARPER, leave_out=3), "segment 3 is not as it was"),
        (answer([5]), "nothing about it has changed"),
        (answer([5], {5: {"turn_degrees": 65.0, "distance": 8.0}}), "radius"),
        ("once upon a time", "could not be read"),
        (json.dumps({"touched": [5], "theta": 0, "segments": []}), "is not as it was"),
        (answer([5], {5: {"distance": -3.0}}), "segment 1 cannot be read"),
    ],
)
def test_what_is_wrong_goes_back_in_a_sentence(bad: str, said: str) -> None:
    chat = FakeChat(bad, answer([5], SHARPER))
    design, _ = edited(chat)
    assert len(chat.questions) == 2
    assert said in chat.questions[1]
    assert changed_besides(OLD, design, [5]) == []
    assert check.inspect(build(design), None, WORLD) == ()


def test_it_ends_after_its_rounds_with_the_reason() -> None:
    chat = FakeChat(answer([4], {4: {"distance": 900.0}}))
    with pytest.raises(EditError, match=r"will not do: .*leaves the map"):
        edited(chat, request("make the second straight longer", "straight 2: length more"), rounds=2)
    assert len(chat.questions) == 2
    with pytest.raises(UnparsableError):
        edited(FakeChat("no road"), rounds=1)


def test_the_budget_ends_it() -> None:
    with pytest.raises(BudgetError):
        edited(FakeChat(BudgetError("no more")))
