"""Stores that are not as RoadGPT wrote them, and links in folders that came from somebody."""

import os
import random
import shutil
import sqlite3
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from roadgpt.campaign import record
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.model import CellBudget
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app

COMMANDS = (
    ("show", "c"),
    ("report", "c"),
    ("faults", "c", "--repeat", "1", "--no-plot"),
    ("drive", "--again", "c", "1", "--no-plot"),
    ("resume", "c", "-q"),
)
BEGUN = "UPDATE meta SET value = '' WHERE name = 'finished'; "
SPOILT = {
    **{
        f"no {name}": f"DROP TABLE {name}"
        for name in ("tests", "cells", "meta", "details", "batches", "traces")
    },
    "no column": "ALTER TABLE tests DROP COLUMN margin",
    "cell": "UPDATE cells SET cell = '{'",
    "plan": BEGUN + "UPDATE meta SET value = '[]' WHERE name = 'plan'",
    "text for a number": "UPDATE tests SET length = 'abc', at_s = 'x'",
    "bytes for a number": "UPDATE tests SET margin = x'00ff'",
    "not finite": "UPDATE tests SET margin = 9e999, length = 9e999",
    "another outcome": "UPDATE tests SET outcome = 'FINE'",
    "a path for a cell": "UPDATE cells SET name = '../../c01'; UPDATE tests SET cell = '../../c01'",
    "a cell that is none": "UPDATE tests SET cell = 'c99'",
    "a path for a file": "UPDATE traces SET file = '/etc/passwd'",
    "a batch without end": BEGUN + "UPDATE batches SET n = 1 << 62, left = 1 << 62",
    "no cells": "DELETE FROM cells; DELETE FROM tests",
    "nothing for a seed": "UPDATE tests SET seed = -1",
}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("made") / "c"
    begin(Plan(prompts=("turn x2",), budget=CellBudget(tests=2), reader="plan"), place)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
        for _ in work(place):
            pass
    return place


@pytest.fixture
def campaign(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return Path(shutil.copytree(made, "c"))


def invoke(*words: str) -> Result:
    return CliRunner().invoke(app, words, prog_name="roadgpt")


def change(campaign: Path, sql: str) -> None:
    db = sqlite3.connect(campaign / "campaign.sqlite")
    db.executescript(sql)
    db.close()


@pytest.mark.parametrize("sql", SPOILT.values(), ids=SPOILT)
def test_a_store_that_is_not_as_we_wrote_it_is_told_by_its_name(campaign: Path, sql: str) -> None:
    change(campaign, sql)
    for words in COMMANDS:
        if words[0] in ("faults", "drive") and "plan" in sql:  # which they do not ask for
            continue
        result = invoke(*words)
        assert result.exit_code == 2, (words, result.output)
        (line,) = result.stderr.strip().splitlines()
        assert "campaign.sqlite" in line
        assert "is damaged" in line or "cannot be read" in line


@pytest.mark.parametrize(
    "sql",
    [
        "UPDATE details SET design = '[1'",
        "UPDATE details SET features = '[]'",
        "UPDATE details SET description = x'00'",
    ],
)
def test_designs_and_sentences_are_checked_as_they_are_read(campaign: Path, sql: str) -> None:
    change(campaign, sql + "; UPDATE tests SET outcome = 'FAIL'")
    for words in COMMANDS[2:4]:
        result = invoke(*words)
        assert result.exit_code == 2, (words, result.output)
        assert "campaign.sqlite is damaged" in result.stderr


def test_flipped_bytes_end_in_a_sentence(campaign: Path) -> None:
    """Whatever they hit: the file itself, a number, a letter of a design."""
    store = campaign / "campaign.sqlite"
    sound, draw = store.read_bytes(), random.Random(5)
    for trial in range(12):
        spoilt = bytearray(sound)
        for _ in range(20):
            spoilt[draw.randrange(len(spoilt))] = draw.randrange(256)
        store.unlink()
        store.write_bytes(spoilt)
        record._checked.clear()
        for words in (COMMANDS[0], *COMMANDS[3:]):
            result = invoke(*words)
            assert result.exit_code in (0, 1, 2), (trial, words, result.output)
            assert "should not happen" not in result.stderr, (trial, words, result.stderr)


LINKS = {
    "tables": ("report", "c"),
    "faults": ("faults", "c", "--repeat", "1", "--no-plot"),
    "again": ("drive", "--again", "c", "1", "--no-plot"),
    "campaign.lock": ("resume", "c", "-q"),
    "workers.log": ("resume", "c", "-q"),
    "traces": ("resume", "c", "-q"),
}


@pytest.mark.parametrize("name", LINKS)
def test_nothing_is_written_through_a_link_to_elsewhere(campaign: Path, tmp_path: Path, name: str) -> None:
    change(campaign, BEGUN + "UPDATE tests SET outcome = 'FAIL'")
    outside = tmp_path / "outside"
    there = outside if "." not in name else outside / "precious.txt"
    outside.mkdir()
    (outside / "precious.txt").write_text("precious")
    (outside / "0000001.npz").write_text("precious")
    place = campaign / name
    shutil.rmtree(place) if place.is_dir() else place.unlink(missing_ok=True)
    place.symlink_to(there)
    result = invoke(*LINKS[name])
    assert result.exit_code == 2, result.output
    assert f"{name} is a link to somewhere else" in result.stderr
    assert sorted(path.name for path in outside.iterdir()) == ["0000001.npz", "precious.txt"]
    assert {path.read_text() for path in outside.iterdir()} == {"precious"}


def test_a_lock_that_is_a_pipe_is_not_waited_for(campaign: Path) -> None:
    (campaign / "campaign.lock").unlink()
    os.mkfifo(campaign / "campaign.lock")
    result = invoke("resume", "c", "-q")
    assert result.exit_code == 2
    assert "campaign.lock is a pipe or a device" in result.stderr
