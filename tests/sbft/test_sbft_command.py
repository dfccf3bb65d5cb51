"""``roadgpt sbft`` and what other commands make of its folder."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from misbehaving import write
from roadgpt.cli import app

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "sbft"
WALK = ["--module-name", "curvature_walk", "--class-name", "CurvatureWalk", "--module-path", str(EXAMPLES)]
BAD = ["--module-name", "misbehaves", "--class-name", "Generator", "--module-path", "."]


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_tests_are_told_drawn_and_open_to_other_commands() -> None:
    result = CliRunner().invoke(app, ["compete", "sbft", *WALK, "--test-budget", "2", "--json", "--plot"])
    assert result.exit_code == 0, result.output
    rows = [json.loads(line) for line in result.stdout.splitlines()]
    assert len(rows) == 2
    (folder,) = Path("results").iterdir()
    assert folder.name.startswith("curvature_walk_CurvatureWalk_")
    assert (folder / "overview.png").is_file()
    assert (folder / "runs" / "0001" / "birds_eye.png").is_file()
    assert "the generator: " in result.stderr
    for words in (
        ["show", str(folder)],
        ["view", str(folder / "test.0001.json"), "--format", "png"],
        ["check", rows[0]["file"], "--rules", "sbft", "--map-size", "200"],
    ):
        again = CliRunner().invoke(app, words)
        assert again.exit_code == 0, again.output
    exported = CliRunner().invoke(app, ["export", str(folder), "--to", "opendrive"])
    assert exported.exit_code == 0, exported.output


def test_one_that_raises_gives_a_status_and_a_sentence() -> None:
    write(Path(), "raise ValueError('no more ideas')")
    result = CliRunner().invoke(
        app, ["compete", "sbft", *BAD, "--time-budget", "60", "--out", "here", "--no-plot"]
    )
    assert result.exit_code == 1
    assert "no more ideas" in result.output
    assert "2 roads in" in result.output
    assert len(list(Path("here").glob("test.*.json"))) == 2
    assert not Path("here/overview.png").exists()


@pytest.mark.parametrize(
    "words",
    [
        ["compete", "sbft", *WALK],
        ["compete", "sbft", *WALK, "--test-budget", "0"],
        ["compete", "sbft", *WALK, "--test-budget", "1", "--map-size", "50"],
        ["compete", "sbft", *WALK, "--test-budget", "1", "--speed-limit", "5"],
        ["compete", "sbft", *WALK, "--test-budget", "1", "--driver", "nobody"],
        ["compete", "sbft", "--class-name", "X", "--test-budget", "1"],
    ],
)
def test_what_cannot_be_is_told(words: list[str]) -> None:
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 2, done.output
    assert isinstance(done.exception, SystemExit)
    assert list(Path().iterdir()) == [], "nothing was begun"


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_ctrl_c_ends_both_and_keeps_what_is_there() -> None:
    write(Path(), "open('pid', 'w').write(str(os.getpid()))\ntime.sleep(600)")
    command = [sys.executable, "-c", "from roadgpt.cli import main; main()", "compete", "sbft", *BAD]
    process = subprocess.Popen(
        [*command, "--test-budget", "9", "--out", "here"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    until = time.monotonic() + 100
    while not (Path("pid").exists() and Path("pid").read_text()) and time.monotonic() < until:
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 130
    assert len(list(Path("here").glob("test.*.json"))) == 2
    assert is_gone(int(Path("pid").read_text()))


def is_gone(pid: int) -> bool:
    for _ in range(100):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.1)
    return False
