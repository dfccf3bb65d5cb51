"""The development prompts for networks, judged by the referee, if both are at hand: words in, files out."""

import json
from pathlib import Path

import pytest

from command_line import roadgpt
from outside_judge import SHARED, networks_referee

PROMPTS = SHARED / "prompts" / "networks-dev.jsonl"
ROADS = 2
LOST = {"n20": "the reader leaves the kind of the first junction open, so one of two is a crossroads"}


def rows() -> list[dict]:
    if not PROMPTS.exists():
        return []
    return [json.loads(line) for line in PROMPTS.read_text(encoding="utf-8").splitlines()]


def cases() -> list[object]:
    lost = {name: pytest.mark.xfail(strict=True, reason=why) for name, why in LOST.items()}
    found = [pytest.param(row, id=row["id"], marks=lost.get(row["id"], ())) for row in rows()]
    return [*found] or [pytest.param(None, id="none")]


@pytest.mark.parametrize("row", cases())
def test_every_network_is_as_the_words_say(row: dict | None, tmp_path: Path) -> None:
    referee = networks_referee()
    if row is None:
        pytest.skip("the prompts are not at hand")
    runs, files = tmp_path / "runs", tmp_path / "files"
    how = ("-n", str(ROADS), "--seed", "1", "--no-drive", "--no-plot", "--out", str(runs))
    roadgpt("run", row["prompt"], *how)
    roadgpt("export", str(runs), "--to", "opendrive", "--out", str(files))
    written = sorted(files.rglob("*.xodr"))
    assert len(written) == ROADS
    for file in written:
        route = json.loads(file.with_suffix(".route.json").read_text(encoding="utf-8"))
        holds, _ = referee.check(str(file), route, row["truth"])
        assert all(holds.values()), (file.name, holds)
