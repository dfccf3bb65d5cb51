"""A folder that came from somebody runs no code of theirs until the user says so."""

import json
import os
import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from roadgpt import provenance
from roadgpt.campaign.folder_record import run_again
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.model import CellBudget
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app
from roadgpt.errors import UsageError
from roadgpt.reading import digest
from roadgpt.road import Limits, Site, World
from roadgpt.run import Setup, perform, prove, read_run, write_run

DRIVER = (
    "from pathlib import Path\nPath({!r}).touch()\n"
    "from roadgpt.drive import Command\n"
    "class Mine:\n    def steer(self, view):\n        return Command(0.0, 1.0, 0.0)\n"
)
PLAIN = Setup(reader="plan")


@pytest.fixture(autouse=True)
def stranger() -> Iterator[None]:
    """Each test begins as a new process does."""
    provenance.CODE.forget()
    yield
    provenance.CODE.forget()


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that fails, a finished campaign and an unfinished one."""
    place = tmp_path_factory.mktemp("made")
    slippery = World(site=Site(friction=0.2), limits=Limits(speed_limit=40.0))
    run = perform("turn x4 sharp", world=slippery, setup=PLAIN)
    assert run.outcome == "FAIL"
    write_run(run, place / "run")
    plan = Plan(prompts=("turn x2",), budget=CellBudget(tests=2), reader="plan")
    begin(plan, place / "done")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
        for _ in work(place / "done"):
            pass
    begin(plan, place / "begun")
    return place


@pytest.fixture
def shared(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of it, all driven by a file beside them."""
    here = tmp_path / "shared"
    shutil.copytree(made, here)
    monkeypatch.chdir(here)
    Path("mine.py").write_text(DRIVER.format(str(tmp_path / "ran")))
    Path("other.py").write_text(DRIVER.format(str(tmp_path / "other ran")))
    driver = f"{here / 'mine.py'}:Mine"
    known = '"roadgpt source":', f'"driver:mine.py": "{digest(Path("mine.py"))}", "roadgpt source":'
    card = Path("run/runs/0001/run.json")
    card.write_text(card.read_text().replace('"lane_centring"', json.dumps(driver)).replace(*known))
    for folder in ("done", "begun"):
        with sqlite3.connect(f"{folder}/campaign.sqlite") as db:
            db.execute("UPDATE meta SET value = replace(value, 'lane_centring', ?)", (driver,))
            db.execute("UPDATE meta SET value = replace(value, ?, ?)", known)
            db.execute("UPDATE cells SET cell = replace(cell, 'lane_centring', ?)", (driver,))
            db.execute("UPDATE tests SET outcome = 'FAIL' WHERE outcome = 'PASS'")
        db.close()
    Path("plan.toml").write_text(
        'prompts = ["turn x2"]\ntests = 1\nreader = "plan"\ndrivers = "mine.py:Mine"\n'
    )
    return tmp_path


def invoke(*words: str) -> Result:
    return CliRunner().invoke(app, words, prog_name="roadgpt")


COMMANDS: dict[str, tuple[str, ...]] = {
    "edit": ("edit", "run/runs/0001", "--plan", "road: length +20", "--no-plot", "--out", "edited"),
    "faults by workers": ("faults", "run/runs/0001", "--repeat", "1", "--groups", "--no-plot", "-j", "2"),
    "faults of a run": ("faults", "run/runs/0001", "--repeat", "1", "--groups", "--no-plot"),
    "faults of a campaign": ("faults", "done", "--repeat", "1", "--groups", "--no-plot"),
    "drive": ("drive", "--again", "done", "1", "--no-plot"),
    "resume": ("resume", "begun", "-q"),
    "plan": ("campaign", "plan.toml", "--out", "new", "-q"),
}


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_code_that_a_file_names_is_refused_in_a_sentence(shared: Path, words: tuple[str, ...]) -> None:
    result = invoke(*words)
    assert not (shared / "ran").exists()
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.strip().splitlines()
    assert "names the driver" in line
    assert "if you trust it, name it yourself: --driver" in line
    assert "mine.py:Mine" in line


@pytest.mark.parametrize("name", [name for name in COMMANDS if name != "faults of a run"])
def test_code_that_the_user_names_as_well_is_run(
    shared: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In processes of their own where it is workers that analyse, also a run, or that resume."""
    if name == "plan":
        monkeypatch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
    result = invoke(*COMMANDS[name], "--driver", "mine.py:Mine")
    assert result.exit_code == 0, result.output
    assert (shared / "ran").exists()


@pytest.mark.parametrize(
    ("words", "driver"),
    [
        *((words, "other.py:Mine") for words in COMMANDS.values()),
        (COMMANDS["drive"], "mine.py:Other"),
        (COMMANDS["edit"], "beamng_like"),
    ],
)
def test_another_driver_than_that_of_the_file_is_refused(
    shared: Path, words: tuple[str, ...], driver: str
) -> None:
    result = invoke(*words, "--driver", driver)
    assert result.exit_code == 2, result.output
    assert "is driven by" in result.stderr
    assert not (shared / "ran").exists()
    assert not (shared / "other ran").exists()


def test_the_users_own_copy_is_run_where_the_folder_names_another_place(shared: Path) -> None:
    """A folder made elsewhere names a path that is not here, or that holds something else."""
    own = shared / "own"
    own.mkdir()
    (own / "mine.py").write_text(DRIVER.format(str(shared / "own ran")))
    result = invoke(*COMMANDS["drive"], "--driver", str(own / "mine.py:Mine"))
    assert result.exit_code == 0, result.output
    assert (shared / "own ran").exists()
    assert not (shared / "ran").exists()


AGAIN = {
    "faults": ("faults", "made", "--repeat", "1", "--groups", "--no-plot"),
    "drive": ("drive", "--again", "made", "1", "--no-plot"),
    "resume": ("resume", "made", "-q"),
}


@pytest.mark.parametrize(
    ("words", "name"),
    [*zip(AGAIN.values(), ["own.py:Mine", "./own.py:Mine", "whole"], strict=True)],
    ids=AGAIN,
)
def test_a_driver_that_was_named_by_a_relative_path_is_named_so_again(
    words: tuple[str, ...], name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("own.py").write_text(DRIVER.format(str(tmp_path / "ran")))
    made = ("run", "two sharp turns", "--driver", "own.py:Mine", "--no-plot", "-q", "--out", "made")
    assert invoke(*made, "--seed", "3").exit_code == 0
    provenance.CODE.forget()
    name = str(tmp_path / "own.py:Mine") if name == "whole" else name
    result = invoke(*words, "--driver", name)
    assert result.exit_code == 0, result.output
    mine = tmp_path / "own.py:Mine"
    assert f"is driven by {mine}, not by" in invoke(*words, "--driver", "own.py:Other").stderr


def test_what_needs_no_driver_shows_a_strangers_folder(shared: Path) -> None:
    for words in (
        ("show", "run/runs/0001"), ("show", "done"),
        ("view", "run/runs/0001", "--format", "png", "--out", "p"),
        ("export", "run/runs/0001", "--to", "csv", "--out", "x"), ("report", "done"),
        ("view", "run/runs/0001", "--out", "v.html"), ("edit", *COMMANDS["edit"][1:], "--no-drive"),
    ):  # fmt: skip
        assert invoke(*words).exit_code == 0, words
    assert not (shared / "ran").exists()


def test_a_program_is_held_to_it_as_well(shared: Path) -> None:
    run = read_run("run/runs/0001")
    assert run.design is not None
    with pytest.raises(UsageError, match=r"run\.json names the driver"):
        prove(run.design, setup=run.request.setup)
    provenance.CODE.forget()
    with pytest.raises(UsageError, match=r"campaign\.sqlite names the driver"):
        run_again(Path("done"), "c01", 1)
    provenance.CODE.forget()
    assert prove(run.design, setup=Setup(driver="mine.py:Mine")).outcome in ("PASS", "FAIL")
    assert (shared / "ran").exists()


def at_a_terminal(words: list[str], answer: bytes) -> tuple[int, str]:
    """Status and words of a process that has a terminal, at which this is typed."""
    import pty  # there is none on Windows

    ours, theirs = pty.openpty()
    program = [sys.executable, "-c", "from roadgpt.cli import main; main()", *words]
    child = subprocess.Popen(program, stdin=theirs, stdout=theirs, stderr=theirs, start_new_session=True)
    os.close(theirs)
    said = b""
    while True:
        try:
            piece = os.read(ours, 4096)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        said += piece
        if b"[y/N]" in said and answer:
            os.write(ours, answer)
            answer = b""
    os.close(ours)
    return child.wait(60), said.decode()


@pytest.mark.skipif(sys.platform == "win32", reason="no pseudo-terminals")
@pytest.mark.parametrize(("answer", "status"), [(b"y\n", 0), (b"\n", 2)])
def test_at_a_terminal_the_user_is_asked(shared: Path, answer: bytes, status: int) -> None:
    ended, said = at_a_terminal([*COMMANDS["edit"]], answer)
    assert "names the driver" in said
    assert "Run the code in that file? [y/N]" in said
    assert ended == status, said
    assert (shared / "ran").exists() == (status == 0)


def test_without_a_terminal_nobody_is_waited_for(shared: Path) -> None:
    """At a pipe that stays open; nothing at all is what the commands above are given."""
    ours, theirs = os.pipe()
    program = [sys.executable, "-c", "from roadgpt.cli import main; main()", *COMMANDS["edit"]]
    done = subprocess.run(program, stdin=ours, capture_output=True, text=True, timeout=60, check=False)
    os.close(ours)
    os.close(theirs)
    assert done.returncode == 2
    assert "name it yourself: --driver" in done.stderr
    assert not (shared / "ran").exists()
