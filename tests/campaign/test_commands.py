"""The commands, and campaigns in processes of their own that are killed, stopped and gone on with."""

import csv
import json
import os
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from campaign.jobs import TESTS, is_alive
from campaign.quick import Inline, InlineJob, plan, put_on_shelves
from roadgpt.campaign.folder_record import kept_run
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.record import STORE, Store
from roadgpt.campaign.status import status_of
from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app
from roadgpt.run import read_run
from rows import rows

QUICK = [sys.executable, str(TESTS / "campaign" / "quick.py")]
SOON = 120.0  # s: far more than anything here takes
unix = pytest.mark.skipif(os.name == "nt", reason="kills as Unix does")


def roadgpt(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


def start(*words: object) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [*QUICK, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=TESTS
    )


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small campaign with real drives, made by the command."""
    folder = tmp_path_factory.mktemp("driven") / "c"
    words = ["turn x2", "-n", 3, "--reader", "plan", "--seed", 7, "--out", folder, "--json"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
        done = roadgpt("campaign", *words)
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["done"] == 3
    return folder


@unix
def test_after_kill_9_the_table_is_the_same(tmp_path: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        put_on_shelves(patch.setattr)
        Inline.rng = np.random.default_rng(0)
        begin(plan(60), tmp_path / "whole")
        [*work(tmp_path / "whole", 1, "inline")]
        begin(plan(60, seconds=0.02), tmp_path / "c")
        process = start(tmp_path / "c", 60, 2, 0.02)
        assert process.stdout is not None
        while not int(process.stdout.readline()):
            pass  # it has only just begun
        pids = children(process.pid)
        assert len(pids) == 2
        time.sleep(0.1)
        process.kill()
        process.communicate()
        gone(pids)
        assert 0 < done_in(tmp_path / "c") < 60
        assert [*work(tmp_path / "c", 1, "inline")][-1].total() == 60
    for name in ("results.csv", "cells.csv"):
        assert (tmp_path / "c" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def children(pid: int) -> list[int]:
    """Processes that a process has started."""
    told = subprocess.run(
        ["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False
    )
    return [int(word) for word in told.stdout.split()]


def gone(pids: list[int]) -> None:
    """Wait until these have ended."""
    until = time.monotonic() + SOON
    while any(map(is_alive, pids)):
        assert time.monotonic() < until
        time.sleep(0.05)


@unix
def test_ctrl_c_keeps_what_is_done_and_says_how_to_go_on(tmp_path: Path) -> None:
    words = ["campaign", "turn x2", "-n", "5000", "--reader", "plan", "--no-drive", "-j", "1", "--out"]
    process = subprocess.Popen(
        [sys.executable, "-c", "from roadgpt.cli import main; main()", *words, str(tmp_path / "c")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    until = time.monotonic() + SOON
    while not done_in(tmp_path / "c") and process.poll() is None and time.monotonic() < until:
        time.sleep(0.1)
    workers = children(process.pid)
    process.send_signal(signal.SIGINT)
    said, errors = process.communicate(timeout=SOON)
    assert process.returncode == 130, errors
    assert f"continue with: roadgpt resume {tmp_path / 'c'}" in errors
    assert "Traceback" not in errors + said
    assert "ignored" not in errors + said
    gone(workers)
    assert 0 < done_in(tmp_path / "c") < 5000
    assert "interrupted" in roadgpt("show", tmp_path / "c").stdout


def done_in(folder: Path) -> int:
    try:
        with sqlite3.connect(f"file:{folder / 'campaign.sqlite'}?mode=ro", uri=True) as db:
            count: int = db.execute("SELECT count(*) FROM tests WHERE outcome IS NOT NULL").fetchone()[0]
        db.close()
    except sqlite3.Error:
        return 0
    return count


def test_status_and_top_tell_of_a_finished_campaign(driven: Path) -> None:
    said = roadgpt("show", driven)
    assert "finished, 3 of 3 tests" in said.output
    assert "turn x2 (lane_centring, words, seed 7)" in said.output
    told = json.loads(roadgpt("show", driven, "--json").stdout)
    assert told["is_finished"]
    assert sum(told["outcomes"].values()) == told["done"] == told["total"] == 3
    assert told["cells"][0]["name"] == "c01"
    assert f"roadgpt show {driven}/c01/1" in roadgpt("show", driven).output
    again = roadgpt("resume", driven, "--json")
    assert json.loads(again.output)["done"] == 3


def test_a_test_is_driven_again_to_the_same_bytes(driven: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        done = roadgpt("drive", "--again", driven, "2", "c01/3", "--no-plot", "--out", tmp_path / name)
        assert done.exit_code == 0, done.output
        assert "was" not in done.stderr  # in the campaign, and now is something else
    one, other = (tmp_path / name / "c01" / "runs" / "0002" for name in ("a", "b"))
    files = sorted(path.name for path in one.iterdir() if path.name != "seconds.json")
    assert "drive.npz" in files
    for name in files:
        assert (one / name).read_bytes() == (other / name).read_bytes()
    run, kept = read_run(one), kept_run(driven, "c01", 2).drive
    assert run.drive is not None
    assert kept is not None
    assert run.words == "turn x2"
    assert len(kept) == len(run.drive)
    assert np.abs(kept["x"] - run.drive["x"]).max() < 0.00051
    with (driven / "results.csv").open() as file:
        rows = [*csv.DictReader(file)]
    assert float(rows[1]["margin_m"]) == run.verdict.margin if run.verdict else None
    assert int(rows[1]["seed"]) == run.seed
    assert "turn x2" in roadgpt("show", one).output


def test_a_campaign_is_written_as_folders_of_runs(driven: Path, tmp_path: Path) -> None:
    done = roadgpt("export", driven, "--to", "runs", "--out", tmp_path)
    assert done.exit_code == 0, done.output
    place = tmp_path / driven.name / "c01"
    assert done.stdout.split() == [str(place / "runs" / f"{number:04d}") for number in (1, 2, 3)]
    with (driven / "results.csv").open() as file:
        rows = [*csv.DictReader(file)]
    for number, row in enumerate(rows, 1):
        run = read_run(place / f"test.{number:04d}.json")
        assert run.outcome == row["outcome"]
        assert run.seed == int(row["seed"])
        assert run.verdict is not None
        assert run.verdict.margin == float(row["margin_m"])
    again = roadgpt("show", place)
    assert again.exit_code == 0, again.output
    with (place / "generation_stats.csv").open() as file:
        assert next(csv.DictReader(file))["test_generated"] == "3"
    twice = roadgpt("export", driven, "--to", "runs", "--out", tmp_path)
    assert twice.exit_code == 2
    assert "holds runs already; name another folder" in twice.stderr
    before = of_a_folder(place)
    for file, *words, says in (
        (driven, "--to", "runs,csv", "ask for them alone"),
        (driven, "--to", "runs", "--failures", "leave out --failures"),
        (driven, "--to", "runs", "--speed-limit", 50, "leave out --speed-limit"),
        (driven / "results.csv", "--to", "runs", "is no folder"),
    ):
        done = roadgpt("export", file, *words)
        assert done.exit_code == 2
        (line,) = done.stderr.strip().splitlines()
        assert says in line
    assert of_a_folder(place) == before
    assert roadgpt("export", place, "--to", "runs", "--out", tmp_path / "copy").exit_code == 0
    assert of_a_folder(tmp_path / "copy" / "c01") == before


def test_the_python_in_the_guide_runs(driven: Path, capsys: pytest.CaptureFixture[str]) -> None:
    guide = (TESTS.parent / "docs" / "how-to" / "run-campaigns.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"^```python\n(.*?)^```", guide, re.MULTILINE | re.DOTALL)
    ours = {'"study"': repr(str(driven)), '"c02"': '"c01"', "17": "2", "0.25": "99"}
    for name in ours:
        assert name in code
    # In one pass, for the folder's own path may hold a 17.
    code = re.sub("|".join(map(re.escape, ours)), lambda found: ours[found[0]], code)
    exec(compile(code, "campaigns.md", "exec"), {})
    assert "kept its lane" in capsys.readouterr().out


@pytest.mark.parametrize(("words", "sentence"), rows(__file__, "impossible_commands"))
def test_what_cannot_be_is_told_in_a_sentence(driven: Path, words: list[str], sentence: str) -> None:
    done = roadgpt(*(word.replace("DIR", str(driven)) for word in words))
    assert sentence in " ".join(done.output.split())
    assert done.exit_code != 0


def of_a_folder(folder: Path) -> dict[str, bytes]:
    """The files of a folder of runs, but for those of the clock."""
    clock = ("seconds.json", "generation_stats.csv", "campaign.lock", STORE)
    files = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.name not in clock)
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@pytest.mark.usefixtures("no_workers")
def test_a_folder_of_roadgpt_run_is_resumed_as_a_campaign_is(tmp_path: Path) -> None:
    """Runs without a row have not ended: they are made again, with pictures and road files."""
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    words = ["straight | turns=0 len=50", "-n", 3, "--seed", 7, "--reader", "plan", "--format", "svg"]
    assert roadgpt("run", *words, "--export", "opendrive", "--out", whole).exit_code == 0
    shutil.copytree(whole, broken)
    (broken / "test.0002.json").unlink()
    (broken / "runs/0003/run.json").write_text("{}")
    with Store.opened(broken) as store:
        for number in (2, 3):
            store.reopen("", number, number - 1)
        store.finish(is_finished=False)
    assert roadgpt("show", broken).stdout.endswith("2 of 3 still to be made\n")
    done = roadgpt("resume", broken, "--json", "--junit", tmp_path / "tests.xml")
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert (told["done"], told["total"], told["is_finished"]) == (3, 3, True)
    assert (tmp_path / "tests.xml").read_text().count("<testcase") == 3
    first, second = of_a_folder(whole), of_a_folder(broken)
    assert {*first} == {*second}
    assert {"runs/0002/road.xodr", "runs/0002/birds_eye.svg"} <= {*second}
    assert [name for name in first if first[name] != second[name]] == []
    assert roadgpt("show", broken).stdout.endswith("3 PASS\n")


def test_what_cannot_be_resumed_is_told(tmp_path: Path) -> None:
    (tmp_path / "road.json").write_text("[[60, 100], [100, 100], [140, 100]]")
    done = roadgpt("run", "a road", "-n", 1, "--no-drive", "--no-plot", "--seed", 7, "--out", tmp_path / "r")
    done = roadgpt("resume", tmp_path / "r", "--max-cost", "1")
    assert "asks none" in done.output
    done = roadgpt("resume", tmp_path / "r", "--executor", "ray")
    assert "made on this machine; leave out --executor" in done.output
    shutil.copytree(tmp_path / "r", tmp_path / "files")
    (tmp_path / "files" / STORE).unlink()
    done = roadgpt("resume", tmp_path / "files")
    assert done.exit_code == 2
    assert "has no campaign.sqlite, the record of its tests, so they are shown but not" in done.output
    done = roadgpt("resume", tmp_path / "r", "--driver", "mine.py:Mine")
    assert done.exit_code == 2


def test_an_error_that_concerns_all_stops_the_campaign_and_keeps_the_rest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from roadgpt.errors import ChatError

    put_on_shelves(monkeypatch.setattr)
    begin(plan(20), tmp_path)
    real = Inline.end

    def failing(self: Inline, job: InlineJob) -> None:
        if job.number == 8:
            job.set_exception(ChatError("nobody answers"))
        else:
            real(self, job)

    with monkeypatch.context() as patch:
        patch.setattr(Inline, "end", failing)
        with pytest.raises(ChatError, match="nobody answers"):
            [*work(tmp_path, 1, "inline")]
    kept = status_of(tmp_path).done
    assert 0 < kept < 20
    [*work(tmp_path, 1, "inline")]
    assert status_of(tmp_path).done == 20
