"""Servers that only a file names, redirects, and replies without end."""

import gzip
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from chat.conftest import KEY
from chat.stub_server import HeardRequest, Scene, StubServer, says, send, serving
from command_line import invoke
from roadgpt import provenance
from roadgpt.campaign.lifecycle import begin
from roadgpt.campaign.model import CellBudget
from roadgpt.campaign.plan import Plan, read_plan
from roadgpt.chat import ChatError, ChatSettings, Message, open_chat
from roadgpt.chat.config import configured, key_for
from roadgpt.run import Request, Setup, perform, read_run, write_run

ELSEWHERE = "https://elsewhere.example/v1"
GOOD = '{"degrees": 30, "along": ["turn x1 left"], "road": "", "unused": []}'


@pytest.fixture(autouse=True)
def key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)


def plan_naming(url: str) -> Path:
    path = Path("plan.toml")
    path.write_text(
        'prompts = ["turn left"]\ntests = 1\ndrive = false\ndesigners = ["thesis"]\nreader = "plan"\n'
        f'[chat]\nmodel = "m"\nretries = 0\nbase_url = "{url}"\n'
    )
    return path


def test_a_plan_does_not_get_the_users_key_sent_to_its_server() -> None:
    result = invoke("campaign", str(plan_naming(ELSEWHERE)), "--out", "c")
    assert result.exit_code == 4
    assert "elsewhere.example is named in plan.toml, so your own key is not sent there" in result.stderr
    assert not Path("c").exists()


@pytest.mark.parametrize("how", ["the plan alone", "as a flag", "in the environment"])
def test_a_server_of_a_plan_gets_the_key_only_from_who_names_it(
    stub: StubServer, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest, how: str
) -> None:
    """Also on this machine, where any port may be anybody's; the workers are processes of their own."""
    stub.play(says(GOOD))
    more = ["--base-url", stub.url] if how == "as a flag" else []
    if how == "in the environment":
        monkeypatch.setenv("OPENAI_BASE_URL", stub.url)
        request.getfixturevalue("no_workers")  # a worker that gets the key is seen with the flag
    invoke("campaign", str(plan_naming(stub.url)), "--out", "c", "-q", *more)
    assert stub.requests
    sent = [KEY in str(each.headers) for each in stub.requests]
    assert sent == [how != "the plan alone"] * len(sent)


@pytest.mark.usefixtures("no_workers")  # those that get no key, and those that do, are seen with a plan
@pytest.mark.parametrize("how", ["resume", "resume with a flag", "resume another"])
def test_a_store_does_not_get_the_users_key_sent(stub: StubServer, how: str) -> None:
    stub.play(says(GOOD))
    chat = ChatSettings(model="m", base_url=stub.url, retries=0)
    setup = {"designers": ("thesis",), "reader": "plan", "drives": False, "chat": chat}
    begin(Plan(prompts=("turn left",), budget=CellBudget(tests=1), **setup), Path("c"))  # type: ignore[arg-type]
    provenance.SERVERS.forget()
    given = {"resume": [], "resume with a flag": [stub.url], "resume another": [ELSEWHERE]}[how]
    result = invoke("resume", "c", "-q", *(word for url in given for word in ("--base-url", url)))
    if how == "resume another":
        assert result.exit_code == 2
        assert f"c names {stub.url}, and not {ELSEWHERE}" in result.stderr
        assert not stub.requests
        return
    assert stub.requests
    assert all((KEY in str(each.headers)) == bool(given) for each in stub.requests)


def test_a_run_does_not_get_the_users_key_sent() -> None:
    setup = Setup(reader="plan", drives=False, chat=ChatSettings(model="m", base_url=ELSEWHERE))
    run = perform("turn left", setup=Setup(reader="plan", drives=False))
    asked = Request(words="turn left", setup=setup)
    folder = write_run(type(run)(**{**vars(run), "request": asked}), Path("c"))
    assert key_for(ELSEWHERE) is not None  # a program that names it itself
    read_run(folder)
    with pytest.raises(ChatError, match=r"named in .*run\.json, so your own key is not sent"):
        key_for(ELSEWHERE)


@pytest.mark.parametrize("url", ["https://elsewhere.example/v1/", "https://Elsewhere.example:443/other"])
def test_another_spelling_of_a_server_is_the_same_server(url: str) -> None:
    Path(".env").write_text(f"ROADGPT_BASE_URL={url}\n")
    with pytest.raises(ChatError, match=r"named in \.env"):
        key_for(configured().base_url)


def test_a_key_beside_a_plan_is_not_for_the_plans_server(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OPENAI_API_KEY")
    Path(".env").write_text(f"OPENAI_API_KEY={KEY}\n")
    read_plan(plan_naming(ELSEWHERE))
    with pytest.raises(ChatError, match=r"named in plan\.toml"):
        key_for(ELSEWHERE)


@pytest.mark.usefixtures("no_workers")
def test_a_server_that_gets_no_key_and_wants_one_is_told_why(stub: StubServer) -> None:
    stub.play(lambda request, handler: send(handler, 401, {"error": {"message": "no key"}}))
    result = invoke("campaign", str(plan_naming(stub.url)), "--out", "c", "-q")
    assert "wants a key but is sent none, because only plan.toml names it" in result.stderr


def ask(stub: StubServer, **settings: Any) -> str:
    chat = open_chat(ChatSettings(base_url=stub.url, model="m", retries=0, **settings))
    return chat.ask([Message(role="user", text="a road?")]).text


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_a_redirect_to_another_server_is_not_followed(stub: StubServer, status: int) -> None:
    with serving(says("hello")) as elsewhere:
        place = f"{elsewhere.url}/chat/completions"
        stub.play(lambda request, handler: send(handler, status, {}, {"Location": place}))
        with pytest.raises(ChatError, match=r"redirects to http://127\.0\.0\.1:\d+/\S+, which is sent"):
            ask(stub)
        assert not elsewhere.requests
    assert len(stub.requests) == 1


@cache
def block_of(packed: bool) -> bytes:
    return gzip.compress(b" " * 100_000_000, 9) if packed else b'"' + b"a" * 1_000_000


def gushes(status: int, sent: list[int], packed: bool = False, most: int = 300) -> Scene:
    """Megabytes without end, until whoever asked goes away."""

    def scene(request: HeardRequest, handler: Any) -> None:
        handler.send_response(status)
        handler.send_header("Content-Type", "application/json")
        if packed:
            handler.send_header("Content-Encoding", "gzip")
        handler.send_header("Connection", "close")
        handler.end_headers()
        block = block_of(packed)
        for _ in range(most):
            sent.append(len(block))
            handler.wfile.write(block)
        handler.close_connection = True

    return scene


@pytest.mark.parametrize("status", [200, 401, 500])
@pytest.mark.parametrize("packed", [False, True])
def test_a_reply_of_any_status_is_read_up_to_a_limit(stub: StubServer, status: int, packed: bool) -> None:
    sent: list[int] = []
    stub.play(gushes(status, sent, packed))
    with pytest.raises(ChatError):
        ask(stub, timeout=20)
    assert sum(sent) < 60_000_000  # of 300 MB; what lies in buffers of the system is not ours
