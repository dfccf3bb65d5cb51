"""The server of tools, asked by the SDK's own client, by a hostile one, and over HTTP; and killed."""

import base64
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from typing import Any

import anyio
import pytest

from roadgpt.errors import UsageError
from roadgpt.export import exporter_of

pytest.importorskip("mcp", reason="the extra mcp is not installed")

import httpx2
from mcp import Client
from mcp.client.stdio import StdioServerParameters, stdio_client
from mcp.client.streamable_http import streamable_http_client
from mcp.shared.exceptions import MCPError

from roadgpt_mcp.server import ToolServer
from roadgpt_mcp.work import Workshop

PLAN = "straight 200 && ego v=50; truck ahead gap=30 v=50: brake 6"
Call = Callable[..., Any]


def command(out: Path, *options: object) -> list[str]:
    return [sys.executable, "-m", "roadgpt", "mcp", "--out", str(out), *map(str, options)]


@asynccontextmanager
async def agent(out: Path, *options: object) -> AsyncIterator[Client]:
    """An agent that started a server of its own."""
    program, *words = command(out, *options)
    with (out.parent / "errors.txt").open("a") as errors:
        told = StdioServerParameters(command=program, args=words, env=dict(os.environ))
        async with Client(stdio_client(told, errlog=errors)) as client:
            yield client


async def data(client: Client, tool: str, **given: Any) -> Any:
    """What a tool tells, which its text tells, too, and which the client compares with its schema."""
    told = await client.call_tool(tool, given)
    assert not told.is_error, told.content
    assert json.loads(told.content[0].text) == told.structured_content
    pictures = [each for each in told.content if each.type == "image"]
    assert all(base64.b64decode(each.data).startswith(b"\x89PNG") for each in pictures)
    return told.structured_content | {"pictures": len(pictures)}


async def refusal(client: Client, tool: str, **given: Any) -> str:
    told = await client.call_tool(tool, given)
    assert told.is_error, told
    (said,) = told.content
    assert "\n" not in said.text
    assert "Traceback" not in said.text
    return str(said.text)


def alive(pids: set[int]) -> set[int]:
    def is_alive(pid: int) -> bool:
        try:
            return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
        except OSError:
            return False

    return {pid for pid in pids if is_alive(pid)}


def children_of(pid: int) -> set[int]:
    found = set[int]()
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in map(int, task.read_text().split()):
            found |= {child} | children_of(child)
    return found


def works_for(folder: Path) -> set[int]:
    """The processes that work for the server of a folder, workers included."""
    found = set[int]()
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = path.read_bytes().decode().split("\0")
        except OSError:
            continue
        if "roadgpt_mcp.child" in words and any(word.startswith(f"{folder}/") for word in words):
            found |= {int(path.parent.name)} | children_of(int(path.parent.name))
    return found


def test_an_agent_learns_cancels_drives_changes_looks_and_exports(tmp_path: Path) -> None:
    async def work() -> None:
        async with agent(tmp_path / "out") as client:
            tools = {tool.name: tool for tool in (await client.list_tools()).tools}
            assert {"language", "check", "run", "change", "scenarios", "campaign", "faults", "export"} <= {
                *tools
            }
            assert all(tool.output_schema and tool.description for tool in tools.values())
            assert "cut_in" in (await data(client, "language", topic="others"))["text"]
            async with anyio.create_task_group() as group:
                group.start_soon(client.call_tool, "run", {"plan": PLAN})
                while not (working := works_for(tmp_path / "out")):
                    await anyio.sleep(0.05)
                group.cancel_scope.cancel()
            with anyio.fail_after(8):
                while alive(working) or (await data(client, "runs"))["rows"]:
                    await anyio.sleep(0.05)
            told = await data(client, "run", plan=PLAN, driver="robot", seed=3)
            assert (told["name"], told["pictures"]) == ("run-1", 2)
            (test,) = told["tests"]
            assert (test["test"], test["test_outcome"]) == ("run-1/1", "FAIL")
            truck = [each for each in test["events"] if each["who"] == "truck 1"]
            assert truck[0]["what"].startswith("brake")
            found = dict[str, Any]()

            async def ask(tool: str, **given: Any) -> None:
                found[tool] = await data(client, tool, **given)

            async with anyio.create_task_group() as group:
                group.start_soon(partial(ask, "change", run="run-1", plan="&& truck: remove", no_drive=True))
                group.start_soon(partial(ask, "show", run="run-1/1"))
                group.start_soon(partial(ask, "export", run="run-1/1", formats=["opendrive"]))
            assert found["show"]["tests"][0]["events"] == test["events"]
            assert found["change"]["tests"][0]["test_outcome"] == "VALID"
            assert "truck" in found["change"]["notes"][0]
            files = found["export"]["files"]
            assert [name for name in files if name.endswith(exporter_of("opendrive").suffix)]
            assert all((tmp_path / "out" / name).is_file() for name in files)
            assert [row["name"] for row in (await data(client, "runs"))["rows"]] == ["change-1", "run-1"]

    anyio.run(work)


@asynccontextmanager
async def within(home: Path, **limits: int) -> AsyncIterator[Client]:
    """A client of a server in this process."""
    usual = {"seconds": 60, "tests": 20, "disk": 100, "workers": 1}
    shop = Workshop(home.resolve(), home.parent / "drivers", **{**usual, **limits})
    async with Client(ToolServer(shop).server) as client:
        yield client


def test_what_a_hostile_agent_asks_for_is_refused_in_one_sentence(tmp_path: Path) -> None:
    home, drivers = tmp_path / "out", tmp_path / "drivers"
    (home / "run-1").mkdir(parents=True)
    drivers.mkdir()
    (tmp_path / "secret.py").write_text("open('/tmp/never', 'w')")
    (drivers / "linked.py").symlink_to(tmp_path / "secret.py")
    (home / "away").symlink_to(tmp_path)
    names = (
        "../out/run-1", "..", ".", "", "/etc", f"{home}/run-1", "run-1/../../x", "run-1/runs/0001", "away",
        "run-1\n", "run-1/1/2", "~", "-h", "--help", "run-1\0",
    )  # fmt: skip
    strangers = (
        "nobody", "../secret.py:X", f"{tmp_path}/secret.py:X", "secret.py:X", "linked.py:X", "a.py", "x\ny",
        "robot:file=/etc/passwd", "--help", "reference;ls", "drivers/linked.py:X",
    )  # fmt: skip
    wrong: list[tuple[str, dict[str, Any]]] = [
        ("run", {"plan": PLAN, "tests": 10**9}), ("run", {"plan": PLAN, "tests": 0}),
        ("run", {"plan": PLAN, "tests": "many"}), ("run", {"plan": 3}), ("run", {"plan": "turn " * 100_000}),
        ("run", {"plan": PLAN, "words": "a road"}), ("run", {}), ("run", {"words": "plan.toml"}),
        ("campaign", {"plan": "../x.toml", "tests": 1}), ("check", {"plan": "turn\0"}),
        ("run", {"scenario": "\ud800"}),
        ("run", {"plan": PLAN, "out": "/tmp"}), ("run", {"plan": PLAN, "seed": -1}), ("check", {}),
        ("campaign", {"plan": PLAN}), ("export", {"run": "run-1", "formats": ["../x"]}),
        ("export", {"run": "run-1", "formats": []}), ("language", {"topic": "/etc/passwd"}),
        ("rm", {"-rf": "/"}), ("_call", {}), ("faults", {"run": "run-1", "repeat": 10**6}),
        ("show", {"run": ["run-1"]}),
    ]  # fmt: skip

    async def work() -> None:
        async with within(home) as client:
            for name in names:
                assert await refusal(client, "show", run=name)
                assert await refusal(client, "export", run=name, formats=["opendrive"])
            for said in strangers:
                assert "there is no driver" in await refusal(client, "run", plan=PLAN, driver=said)
            for tool, given in wrong:
                assert await refusal(client, tool, **given)
            assert "maximum of 20" in await refusal(client, "run", plan=PLAN, tests=21)

    anyio.run(work)
    assert {path.name for path in home.iterdir()} == {"run-1", "away"}


def test_drivers_are_installed_ones_and_files_of_their_folder(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("")
    shop = Workshop(tmp_path / "out", tmp_path, 60, 20, 100, 1)
    for said in ("robot", "lane_centring:lag=0.4,headway=1.5", "robot:x=none"):
        assert shop.driver(said) == said
    for said in ("mine.py:Mine", "mine.py:Mine:gain=-1e-3,on=true"):
        assert shop.driver(said) == f"{tmp_path}/{said}"
    with pytest.raises(UsageError, match="there is no driver"):
        Workshop(tmp_path / "out", None, 60, 20, 100, 1).driver("mine.py:Mine")


def test_pictures_outside_the_folder_are_not_shown(tmp_path: Path) -> None:
    shop = Workshop(tmp_path.resolve() / "out", None, 60, 20, 100, 1)
    (shop.home / "run-1").mkdir(parents=True)
    (tmp_path / "secret.png").write_bytes(b"")
    (shop.home / "run-1" / "picture.png").symlink_to(tmp_path / "secret.png")
    with pytest.raises(UsageError, match="leads out of the folder of runs"):
        shop.found(shop.home / "run-1", "*.png")


def test_limits_of_time_and_disk_stop_the_work_and_are_told(tmp_path: Path) -> None:
    async def work() -> None:
        async with within(tmp_path / "slow", seconds=0) as client:
            assert "(--seconds of the server)" in await refusal(client, "run", plan=PLAN)
        (tmp_path / "full").mkdir()
        (tmp_path / "full" / "big").write_bytes(b"0" * 1_000_001)
        async with within(tmp_path / "full", disk=1) as client:
            assert "(--disk of the server)" in await refusal(client, "run", plan=PLAN)

    anyio.run(work)
    assert not works_for(tmp_path)
    assert [*(tmp_path / "slow").iterdir()] == []


def test_a_thousand_calls_at_once_leave_the_server_responsive(tmp_path: Path) -> None:
    refused = 0

    async def one(client: Client) -> None:
        nonlocal refused
        said = await refusal(client, "run", plan=PLAN, driver="robot")
        refused += "calls wait already" in said

    async def work() -> None:
        async with within(tmp_path / "out") as client, anyio.create_task_group() as group:
            for _ in range(1000):
                group.start_soon(one, client)
            with anyio.fail_after(20):
                while refused < 1000 - 2 - 64:
                    await anyio.sleep(0.02)
                begun = time.monotonic()
                await data(client, "language")
                assert time.monotonic() - begun < 2
            assert len(works_for(tmp_path)) <= 4
            group.cancel_scope.cancel()

    anyio.run(work)
    assert refused == 1000 - 2 - 64
    assert not works_for(tmp_path)


def test_nothing_but_the_protocol_comes_out_whatever_goes_in(tmp_path: Path) -> None:
    hello = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "x", "version": "1"}}
    call = {"name": "check", "arguments": {"plan": "turn foo"}}
    asked: list[dict[str, Any]] = [
        {"id": 1, "method": "initialize", "params": hello}, {"method": "notifications/initialized"},
        {"id": 2, "method": "no/such"}, {"id": 3, "method": "tools/call", "params": {"name": 3}},
        {"id": 4, "method": "tools/call", "params": call},
    ]  # fmt: skip
    lines = [json.dumps({"jsonrpc": "2.0", **each}).encode() for each in asked]
    garbage = [
        b"\xff\xfe\0garbage",
        b"{",
        b"[]",
        b"null",
        b'{"jsonrpc": "2.0"}',
        b"{" * 5000,
        b"0" * 1_000_000,
    ]
    words = command(tmp_path / "out")
    with subprocess.Popen(
        words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        server.stdin.write(b"\n".join([*garbage, *lines[:2], *garbage, *lines[2:]]) + b"\n")
        server.stdin.flush()
        told = list[dict[str, Any]]()
        while not told or told[-1].get("id") != 4:
            told.append(json.loads(server.stdout.readline()))
        server.stdin.close()
        told += map(json.loads, server.stdout.readlines())
        assert server.wait(10) == 0
    assert all(each["jsonrpc"] == "2.0" for each in told)
    answers = {each["id"]: each for each in told if each.get("id")}
    assert len(answers[4]["result"]["structuredContent"]["objections"]) == 1
    assert "error" in answers[2] | answers[3]


def test_a_campaign_tells_progress_and_goes_on_after_a_kill(tmp_path: Path) -> None:
    home, killed = tmp_path / "out", set[int]()
    seen = list[tuple[float, float | None]]()

    async def progress(done: float, total: float | None, message: str | None) -> None:
        seen.append((done, total))
        if not killed:
            server = {int(Path(f"/proc/{pid}/stat").read_text().split()[3]) for pid in works_for(home)}
            killed.update(works_for(home))
            os.kill(min(server), signal.SIGKILL)

    async def work() -> None:
        given = {"plan": "straight 200", "tests": 2, "driver": "robot"}
        async with agent(home) as client:
            with pytest.raises(MCPError):
                await client.call_tool("campaign", given, progress_callback=progress)
        with anyio.fail_after(10):
            while alive(killed):
                await anyio.sleep(0.05)
        async with agent(home) as client:
            state = (await data(client, "resume", run="campaign-1"))["state"]
            assert (state["is_finished"], state["done"], state["total"]) == (True, 2, 2)

    anyio.run(work)
    assert seen[0][1] == 2
    assert seen[0][0] < 2


def test_over_http_only_who_knows_the_token_is_served(tmp_path: Path) -> None:
    words = command(tmp_path / "out", "--http", 0)
    server = subprocess.Popen(words, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
    try:
        assert server.stderr is not None
        address, header = (server.stderr.readline().decode().strip() for _ in range(2))
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/mcp", address)
        token = header.removeprefix("Authorization: ")
        assert re.fullmatch(r"Bearer [\w-]{40,}", token)
        told = {"jsonrpc": "2.0", "id": 1, "method": "tools/list"}
        accept = {"Accept": "application/json, text/event-stream"}

        def status(**headers: str) -> int:
            return httpx2.post(address, json=told, headers=accept | headers, trust_env=False).status_code

        assert [status(), status(Authorization="Bearer x"), status(Authorization=f"{token}x")] == [401] * 3
        assert status(Authorization=token, Host="evil.example") == 421
        assert status(Authorization=token, Origin="http://evil.example") == 403

        async def work() -> None:
            async with (
                httpx2.AsyncClient(headers={"Authorization": token}, trust_env=False) as http,
                Client(streamable_http_client(address, http_client=http)) as client,
            ):
                assert "lane_drop" in (await data(client, "language", topic="routes"))["text"]
                assert "no run" in await refusal(client, "show", run="run-9")

        anyio.run(work)
    finally:
        server.terminate()
        out, _ = server.communicate(timeout=15)
    assert out == b""
