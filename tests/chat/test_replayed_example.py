"""What a real model once answered, replayed without a server or a key, gives the roads that it gave then."""

import json
import re
import shlex
import socket
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from roadgpt.cli import app

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "chat-replay"
ROADS = [json.loads(line) for line in (EXAMPLE / "roads.jsonl").open("rb")]
BUDGET = 300_000  # bytes, of all files


@pytest.fixture(autouse=True)
def offline(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("a replay has asked the network")

    monkeypatch.setattr(socket.socket, "connect", refuse)
    monkeypatch.setattr(socket, "create_connection", refuse)


def run(*words: str) -> None:
    usual = ("--no-drive", "--no-plot", "--max-completion", "400")
    done = CliRunner().invoke(app, ["run", *words, *usual, "--replay", str(EXAMPLE), "--out", "out"])
    assert done.exit_code == 0, done.output


def design_of(index: int) -> str | None:
    """The design of a finished run, as text; none where no answer was a road."""
    path = Path("out") / "runs" / f"{index:04d}" / "design.json"
    return json.dumps(json.loads(path.read_bytes())) if path.exists() else None


def text_of(road: dict[str, Any]) -> str | None:
    return None if road["design"] is None else json.dumps(road["design"])


@pytest.mark.parametrize("words", sorted({one["words"] for one in ROADS}))
def test_the_method_of_the_thesis_gives_the_recorded_roads(words: str) -> None:
    roads = [one for one in ROADS if one["words"] == words]
    assert roads
    run(words, "--designer", "thesis", "--seed", "1", "-n", str(len(roads)))
    assert [design_of(road["number"]) for road in roads] == [text_of(road) for road in roads]


def test_the_command_of_the_readme_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    command = re.search(r"^roadgpt (run .*)$", (EXAMPLE / "README.md").read_text("utf-8"), re.MULTILINE)
    assert command
    monkeypatch.chdir(EXAMPLE.parents[1])
    more = ["--out", str(tmp_path / "out"), "--no-plot"]
    done = CliRunner().invoke(app, [*shlex.split(command[1]), *more])
    assert done.exit_code == 0, done.output
    told = json.loads((tmp_path / "out" / "runs" / "0001" / "run.json").read_text("utf-8"))
    assert told["outcome"] == "INVALID"
    assert told["findings"][0]["rule"] == "inside_map"


def test_the_recording_is_small_and_names_one_model() -> None:
    files = [path for path in EXAMPLE.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < BUDGET
    kept = [json.loads(path.read_bytes())["question"] for path in EXAMPLE.glob("??/*.json")]
    assert {question["model"] for question in kept} == {"qwen2.5-coder-1.5b-instruct-q4_k_m"}
