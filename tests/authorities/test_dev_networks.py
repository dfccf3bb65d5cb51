"""The development prompts for networks, judged by the referee, if both are at hand: words in, files out."""

import json
from pathlib import Path

import pytest

from command_line import roadgpt
from outside_judge import SHARED, networks_referee

PROMPTS = SHARED / "prompts" / "networks-dev.jsonl"
ROADS = 5


def rows() -> list[dict]:
    if not PROMPTS.exists():
        return []
    return [json.loads(line) for line in PROMPTS.read_text(encoding="utf-8").splitlines()]


@pytest.mark.parametrize("row", rows() or [None], ids=lambda row: row["id"] if row else "none")
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
