"""Responses in the place of the Assistants API: one conversation a campaign, kept by the server if it can."""

from typing import Any

import pytest
from click.testing import CliRunner

from chat.asker import Turn, on_shelf
from chat.stub_server import HeardRequest, StubServer, fails, in_order, only, says, send
from roadgpt.chat import ChatSettings, Message, Meter, RefusedError, UnparsableError, counting, open_chat
from roadgpt.cli import app

NOTHING, REFUSAL = UnparsableError, RefusedError
RULES = Message(role="system", text="You turn.")
QUESTION = [RULES, Message(role="user", text="How far?")]
GOOD = '{"degrees": 5}'


def settings(stub: StubServer, **more: Any) -> ChatSettings:
    return ChatSettings(base_url=stub.url, model="m", api="responses", **more)


def test_the_server_keeps_the_conversation(stub: StubServer) -> None:
    stub.play(says(GOOD))
    chat = open_chat(settings(stub, max_completion=77, temperature=0.5))
    replies = [chat.ask(QUESTION, Turn) for _ in range(2)]
    assert [reply.conversation for reply in replies] == ["conv_1", "conv_1"]
    assert [reply.usage.total for reply in replies] == [150, 150]
    first, second = (request.body for request in stub.requests)
    assert stub.requests[0].path == "/v1/responses"
    assert first["conversation"] == second["conversation"] == "conv_1"
    assert first["instructions"] == "You turn."
    assert first["input"] == second["input"] == [{"role": "user", "content": "How far?"}]
    assert first["max_output_tokens"] == 77
    assert first["temperature"] == 0.5
    assert first["text"]["format"]["type"] == "json_schema"
    assert "seed" not in first


def test_each_campaign_has_a_conversation_of_its_own(stub: StubServer) -> None:
    stub.play(says(GOOD))
    chat = open_chat(settings(stub))
    names = []
    for meter in (one := Meter(), two := Meter(), one, two):
        with counting(meter):
            names.append(chat.ask(QUESTION, Turn).conversation)
    assert names == ["conv_1", "conv_2", "conv_1", "conv_2"]


def test_a_server_that_keeps_nothing_is_told_what_was_said(
    stub: StubServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    stub.keeps_conversations = False
    stub.play(*in_order(['{"degrees": 5}', '{"degrees": 6}']))
    chat = open_chat(settings(stub))
    replies = [chat.ask(QUESTION, Turn) for _ in range(2)]
    assert [reply.data.degrees for reply in replies] == [5, 6]
    assert replies[1].conversation is None
    first, second = (request.body for request in stub.requests)
    assert first["store"] is second["store"] is False
    assert second["input"] == [
        {"role": "user", "content": "How far?"},
        {"role": "assistant", "content": '{"degrees": 5}'},
        {"role": "user", "content": "How far?"},
    ]


def test_a_conversation_that_is_full_is_followed_by_another(stub: StubServer) -> None:
    stub.play(says(GOOD), fails(400, "too many tokens", code="context_length_exceeded"), says(GOOD))
    chat = open_chat(settings(stub))
    assert [chat.ask(QUESTION, Turn).conversation for _ in range(2)] == ["conv_1", "conv_2"]


def test_the_ladder_holds_here_as_well(stub: StubServer) -> None:
    stub.play(only("text", text=f"```json\n{GOOD}\n```"))
    assert open_chat(settings(stub)).ask(QUESTION, Turn).data == Turn(degrees=5)
    assert stub.response_formats == ["json_schema", "json_object", "text"]
    stub.play(says(f"```json\n{GOOD}\n```"))  # LM Studio: 200 and the schema ignored
    assert open_chat(settings(stub)).ask(QUESTION, Turn).data == Turn(degrees=5)


@pytest.mark.parametrize(
    ("body", "error", "told"),
    [
        (
            {"status": "incomplete", "incomplete_details": {"reason": "max_output_tokens"}},
            UnparsableError,
            "cut off",
        ),
        (
            {"status": "incomplete", "incomplete_details": {"reason": "content_filter"}},
            REFUSAL,
            "filter",
        ),
        ({"output": "none"}, NOTHING, "blank"),
        (
            {"output": [None, 3, {"type": "message", "content": [None, {"text": 5}]}]},
            UnparsableError,
            "blank",
        ),
        (
            {"output": [{"type": "message", "content": [{"type": "refusal", "refusal": "Not roads."}]}]},
            REFUSAL,
            "Not roads",
        ),
    ],
)
def test_answers_without_an_answer(
    stub: StubServer, body: dict[str, Any], error: type[Exception], told: str
) -> None:
    stub.play(lambda request, handler: send(handler, 200, body))
    with pytest.raises(error, match=told):
        open_chat(settings(stub)).ask(QUESTION, Turn)


def test_a_campaign_through_responses(stub: StubServer, monkeypatch: pytest.MonkeyPatch) -> None:
    on_shelf(monkeypatch)

    def scene(request: HeardRequest, handler: Any) -> None:
        says(f'{{"degrees": {30 + 10 * len(stub.requests)}}}')(request, handler)

    stub.play(scene)
    words = [
        "run",
        "a left turn",
        "--designer",
        "asker",
        "-n",
        "3",
        "--no-drive",
        "--no-plot",
        "--api",
        "responses",
    ]
    result = CliRunner().invoke(app, [*words, "--api", "responses", "--base-url", stub.url, "--model", "m"])
    assert result.exit_code == 0, result.output
    assert {request.body["conversation"] for request in stub.requests} == {"conv_1"}
