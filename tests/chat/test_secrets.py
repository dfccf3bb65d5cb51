"""A key goes to the server and nowhere else: a canary is looked for behind every path that fails."""

import logging
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from chat.asker import Turn, on_shelf
from chat.conftest import KEY
from chat.stub_server import (
    HeardRequest,
    Scene,
    StubServer,
    answers,
    completion,
    drips,
    drops,
    floods,
    says,
    send,
)
from grids import diagonal
from roadgpt.chat import ChatError, ChatSettings, Message, open_chat
from roadgpt.chat.config import Key, redacted
from roadgpt.cli import app

ESCAPED = "".join(f"\\u{ord(letter):04x}" for letter in KEY)
PIECE = KEY[3:]  # what is left where only the beginning is taken away


def echoes(status: int) -> Scene:
    """A server that shows whoever asks what they sent, headers included, wherever it can."""

    def scene(request: HeardRequest, handler: Any) -> None:
        shown = f"you sent {request.headers}"
        body = {"error": {"message": shown, "code": KEY, "param": KEY, "type": shown}, KEY: [KEY]}
        send(handler, status, body, {"X-Request-Id": KEY, "Retry-After": KEY})

    return scene


PATHS: dict[str, Scene] = {
    **{f"status {status}": echoes(status) for status in (400, 401, 403, 404, 413, 422, 429, 500, 503)},
    "in the answer": says(f'{{"degrees": 30, "note": "{KEY}"}}'),
    "as the answer": says(f"The key is {KEY}."),
    "in a name": says(f'{{"{KEY}": 30}}'),
    "escaped": says(
        f'{{"along": ["{ESCAPED}"], "road": "", "unused": ["{ESCAPED}"], "degrees": "{ESCAPED}"}}'
    ),
    "in a plan": says(f'{{"along": ["turn {KEY}"], "road": "", "unused": ["{KEY}"], "degrees": "{KEY}"}}'),
    "as the model": answers({**completion('{"degrees": 30}'), "model": KEY}),
    "in a refusal": says(None, refusal=f"not with {KEY}"),
    "no JSON": answers(f"<html>Bearer {KEY}</html>".encode()),
    "a list": answers([KEY]),
    "cut off": drops(KEY.encode()),
    "dropped": drops(),
    "drips": drips(0.2, KEY),
    "floods": floods(1),
    "good": says('{"degrees": 30, "along": ["turn x1 left"], "road": "", "unused": []}'),
}


def nothing_told(result: Result | None = None) -> None:
    """Nothing that was printed or written has a trace of the key."""
    if result is not None:
        assert PIECE not in result.output
        assert PIECE not in result.stderr
        assert "Traceback" not in result.output
        assert result.exit_code in (0, 2, 3, 4), result.output
    for path in Path().rglob("*"):
        assert PIECE not in path.name
        if path.is_file():
            content = path.read_bytes()
            assert PIECE.encode() not in content, path
            assert ESCAPED[18:].encode() not in content, path


@pytest.fixture
def loud(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> pytest.LogCaptureFixture:
    """A key in the environment, and every logger as loud as it gets."""
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    monkeypatch.setenv("OPENAI_LOG", "debug")
    logging.getLogger("openai").setLevel(logging.DEBUG)
    caplog.set_level(logging.DEBUG)
    return caplog


@pytest.mark.parametrize(("path", "part"), diagonal([*PATHS], ["--designer=asker", "--reader=chat"]))
def test_no_path_tells_the_key(
    stub: StubServer,
    monkeypatch: pytest.MonkeyPatch,
    loud: pytest.LogCaptureFixture,
    waits: list[float],
    path: str,
    part: str,
) -> None:
    on_shelf(monkeypatch)
    stub.play(PATHS[path])
    words = [
        "run", "a left turn", part, "-n", "2", "--no-drive", "--no-plot", "--out", "c", "--record", "tape",
    ]  # fmt: skip
    server = ["--base-url", stub.url, "--model", "m", "--retries", "1", "--timeout", "0.5", "--verbose"]
    result = CliRunner().invoke(app, [*words, *server], prog_name="roadgpt")
    assert f"Bearer {KEY}" in stub.requests[0].headers.values()
    nothing_told(result)
    assert PIECE not in loud.text
    if result.exit_code:
        assert result.stderr.count("roadgpt: ") == 1, result.stderr


def test_an_error_of_the_program_itself_tells_no_key(
    stub: StubServer, monkeypatch: pytest.MonkeyPatch, loud: pytest.LogCaptureFixture
) -> None:
    """A crash writes a traceback to a file; the key is in none of its lines."""
    on_shelf(monkeypatch)

    def broken(*args: Any, **kwargs: Any) -> Any:
        raise RuntimeError("something unforeseen")

    monkeypatch.setattr("roadgpt.chat.answer._count", broken)
    stub.play(says('{"degrees": 30}'))
    words = [
        "run", "a left turn", "--designer", "asker", "--out", "c", "--base-url", stub.url, "--model", "m",
    ]  # fmt: skip
    result = CliRunner().invoke(app, words, prog_name="roadgpt")
    assert result.exit_code == 70
    (crash,) = Path("c").glob("roadgpt-crash-*.txt")
    assert "something unforeseen" in crash.read_text()
    assert PIECE not in crash.read_text() + result.output + loud.text


@pytest.mark.parametrize(
    "key",
    ["sk-canary-\n0123456789abcdef", "sk-canary-ü0123456789abcdef", "sk canary 0123456789", "\x00sk-canary"],
)
def test_a_key_that_no_header_can_carry_is_told_without_it(
    stub: StubServer, monkeypatch: pytest.MonkeyPatch, key: str
) -> None:
    Path(".env").write_text(f"OPENAI_API_KEY='{key}'\n")
    if "\n" not in key and "\x00" not in key:
        monkeypatch.setenv("OPENAI_API_KEY", key)
        Path(".env").unlink()
    for words in (
        ["config", "show"],
        ["run", "a turn", "--reader", "chat", "--base-url", stub.url, "--model", "m"],
    ):
        result = CliRunner().invoke(app, words, prog_name="roadgpt")
        assert "canary" not in result.output
        assert result.exit_code in (0, 4)
        assert "Traceback" not in result.output


def test_settings_and_values_show_no_key(stub: StubServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    stub.play(says(f'{{"degrees": 3, "note": "{KEY}"}}'))
    settings = ChatSettings(base_url=stub.url, model="m")
    chat = open_chat(settings)
    reply = chat.ask([Message(role="user", text="How far?")], Turn)
    key = Key(KEY, "environment")
    for shown in (repr(settings), settings.model_dump_json(), repr(chat), repr(reply), str(key), repr(key)):
        assert PIECE not in shown


def test_an_exception_keeps_no_key_in_its_chain(stub: StubServer, monkeypatch: pytest.MonkeyPatch) -> None:
    import traceback

    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    stub.play(echoes(400))
    with pytest.raises(ChatError) as caught:
        open_chat(ChatSettings(base_url=stub.url, model="m")).ask([Message(role="user", text="x")])
    assert PIECE not in "".join(traceback.format_exception(caught.value))


@pytest.mark.parametrize(
    ("text", "clean"),
    [
        (f"a {KEY} b", "a (key) b"),
        ("Incorrect API key provided: sk-proj-ab****yz12.", "Incorrect API key provided: (key)"),
        ("Authorization: Bearer abcdefgh12345", "Authorization: (key)"),
        ("a risk-free task-oriented road", "a risk-free task-oriented road"),
    ],
)
def test_what_looks_like_a_key_is_taken_out(text: str, clean: str) -> None:
    key = Key(KEY, "environment")
    assert redacted(text, key) == clean
    assert redacted({text: [text, 5, None]}, key) == {clean: [clean, 5, None]}
