"""What was recorded is replayed byte for byte, without a server, and holds no key."""

from pathlib import Path
from typing import Any

import pytest

from chat.asker import Turn, on_shelf
from chat.conftest import KEY
from chat.stub_server import StubServer, in_order, says
from command_line import invoke
from roadgpt.chat import (
    ChatError,
    ChatSettings,
    Message,
    Meter,
    RefusedError,
    UnparsableError,
    counting,
    open_chat,
)
from roadgpt.errors import UsageError

QUESTION = [Message(role="user", text="How far?")]
CLOCK = ("seconds.json", "generation_stats.csv", "campaign.sqlite")  # the only files that another day changes


@pytest.fixture
def key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)


def files(folder: str) -> dict[str, bytes]:
    found = (path for path in Path(folder).rglob("*") if path.is_file() and path.name not in CLOCK)
    return {str(path.relative_to(folder)): path.read_bytes() for path in found}


@pytest.mark.usefixtures("key")
@pytest.mark.parametrize("designer", ["asker", "repeater"])
def test_a_replayed_campaign_is_the_same_byte_for_byte(
    stub: StubServer, monkeypatch: pytest.MonkeyPatch, designer: str
) -> None:
    on_shelf(monkeypatch)
    stub.play(*in_order([f'{{"degrees": {degrees}}}' for degrees in (30, 40, 50, 60)]))
    words = (
        "run", "a left turn", "--designer", designer, "-n", "4", "--seed", "7", "--no-drive", "--no-plot",
    )  # fmt: skip
    server = ("--base-url", stub.url, "--model", "m", "--price", "1/2")
    live = invoke(*words, *server, "--out", "live", "--record", "tape")
    assert live.exit_code == 0, live.output
    asked = len(stub.requests)
    assert asked == 4
    again = invoke(*words, *server, "--out", "again", "--replay", "tape")
    assert again.exit_code == 0, again.output
    assert len(stub.requests) == asked
    assert files("live") == files("again")
    designs = {path.read_text() for path in Path("live").glob("runs/*/design.json")}
    assert len(designs) == 4
    parts = invoke(*words[:5], "2", *words[6:], *server, "--out", "parts", "--replay", "tape")
    assert parts.exit_code == 0
    rest = invoke(*words, *server, "--out", "parts", "--replay", "tape")
    assert rest.exit_code == 0
    assert files("live") == files("parts")
    assert not any(KEY.encode() in content for content in files(".").values())


def settings(stub: StubServer, **more: Any) -> ChatSettings:
    return ChatSettings(base_url=stub.url, model="m", **more)


def test_failures_are_recorded_too(stub: StubServer) -> None:
    stub.play(says("no"))
    with pytest.raises(UnparsableError) as live:
        open_chat(settings(stub, record="tape")).ask(QUESTION, Turn)
    stub.play(says(None, refusal="never"))
    with pytest.raises(RefusedError):
        open_chat(settings(stub, record="tape")).ask([Message(role="user", text="Other")], Turn)
    chat = open_chat(ChatSettings(replay="tape"))
    with pytest.raises(UnparsableError) as again:
        chat.ask(QUESTION, Turn)
    assert (str(again.value), again.value.text) == (str(live.value), live.value.text)
    assert chat.spent.calls == 3
    with pytest.raises(RefusedError, match="never"):
        chat.ask([Message(role="user", text="Other")], Turn)


def test_a_question_that_was_not_recorded_is_told(stub: StubServer) -> None:
    stub.play(says('{"degrees": 5}'))
    open_chat(settings(stub, record="tape")).ask(QUESTION, Turn)
    for chat, question in (
        (ChatSettings(replay="tape"), [Message(role="user", text="How wide?")]),
        (ChatSettings(replay="tape", model="other"), QUESTION),
        (ChatSettings(replay="tape", temperature=1.0), QUESTION),
    ):
        with pytest.raises(ChatError, match=r"holds no answer to this question; .*model m\)"):
            open_chat(chat).ask(question, Turn)
    with pytest.raises(ChatError, match="holds no answer"):
        open_chat(ChatSettings(replay="tape")).ask(QUESTION)


def test_the_same_question_has_its_answers_in_their_order(stub: StubServer) -> None:
    stub.play(*in_order([f'{{"degrees": {degrees}}}' for degrees in (1, 2, 3)]))
    chat = open_chat(settings(stub, record="tape"))
    with counting(Meter(), "road 1"):
        assert [chat.ask(QUESTION, Turn).data.degrees for _ in range(2)] == [1, 2]
    with counting(Meter(), "road 2"):
        assert chat.ask(QUESTION, Turn).data.degrees == 3
    again = open_chat(ChatSettings(replay="tape"))
    with counting(Meter(), "road 2"):
        assert again.ask(QUESTION, Turn).data.degrees == 3
        with pytest.raises(ChatError, match="holds no answer"):
            again.ask(QUESTION, Turn)
    with counting(Meter(), "road 1"):
        assert [again.ask(QUESTION, Turn).data.degrees for _ in range(2)] == [1, 2]


@pytest.mark.parametrize("content", ["", "{", "[]", '{"format": 2}', '{"format": 1, "answers": {"": [{}]}}'])
def test_a_recording_that_is_damaged_is_told(stub: StubServer, content: str) -> None:
    stub.play(says('{"degrees": 5}'))
    open_chat(settings(stub, record="tape")).ask(QUESTION, Turn)
    (path,) = Path("tape").rglob("*.json")
    path.write_text(content)
    with pytest.raises(UsageError, match="record it again"):
        open_chat(ChatSettings(replay="tape", model="m")).ask(QUESTION, Turn)


def test_where_there_is_no_recording_that_is_told(stub: StubServer) -> None:
    Path("empty").mkdir()
    for folder in ("nowhere", "empty"):
        with pytest.raises(UsageError, match=f"there is no recording in {folder}"):
            open_chat(ChatSettings(replay=folder))
    with pytest.raises(UsageError, match="--record or --replay, not both"):
        open_chat(settings(stub, record="a", replay="b"))
    Path("file").write_text("")
    stub.play(says('{"degrees": 5}'))
    with pytest.raises(ChatError, match="cannot record into file"):
        open_chat(settings(stub, record="file")).ask(QUESTION, Turn)
