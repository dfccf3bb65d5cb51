"""What people give to the commands of campaigns by mistake or in jest: they are told, and nothing breaks."""

import shlex
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from campaign.quick import plan, put_on_shelves
from roadgpt.brief import Brief, read
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.model import CellBudget
from roadgpt.campaign.plan import Plan, read_plan
from roadgpt.campaign.record import STORE, Record
from roadgpt.campaign.status import status_of
from roadgpt.chat import Meter, Spent, Usage
from roadgpt.cli import app
from roadgpt.cli.commands.evaluate import command_of
from roadgpt.road import World
from roadgpt.run import Setup

HOSTILE = "a road [/red] [bold]<b>\n\x1b[31m " + "very " * 60 + "long"


def roadgpt(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


def begin_quickly(folder: Path, patch: pytest.MonkeyPatch, wanted: Plan) -> None:
    """A campaign whose tests cost nothing."""
    put_on_shelves(patch.setattr)
    patch.setattr("roadgpt.campaign.lifecycle.brief_of", lambda *_: read("hairpin x2", "plan"))
    begin(wanted, folder)


@pytest.fixture
def hostile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    begin_quickly(tmp_path / "c", monkeypatch, plan(5).model_copy(update={"prompts": (HOSTILE,)}))
    [*work(tmp_path / "c", 1, "inline")]
    return tmp_path / "c"


def test_a_description_takes_one_line_whatever_is_in_it(hostile: Path) -> None:
    said = roadgpt("show", hostile)
    assert said.exit_code == 0
    (line,) = [line for line in said.output.splitlines() if line.startswith("c01")]
    assert "a road [/red] [bold]<b> [31m very" in line
    assert len(line) < 160
    assert "\x1b" not in said.output


def journal(folder: Path) -> str:
    with closing(sqlite3.connect(folder / STORE)) as db:
        return str(db.execute("PRAGMA journal_mode").fetchone()[0])


def test_a_finished_campaign_stays_one_file_when_somebody_goes_on_with_it(hostile: Path) -> None:
    assert journal(hostile) == "delete"
    assert roadgpt("resume", hostile).exit_code == 0
    assert journal(hostile) == "delete"


def test_an_interrupted_campaign_is_read_where_nothing_may_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin_quickly(tmp_path, monkeypatch, plan(5))
    assert journal(tmp_path) == "wal"
    real = sqlite3.connect

    def refusing(place: str, *rest: Any, **more: Any) -> sqlite3.Connection:
        """As SQLite does on a read-only disk, where it cannot make the files beside a log."""
        return real(place if "immutable" in place else f"file:{tmp_path}/gone?mode=ro", *rest, **more)

    monkeypatch.setattr("roadgpt.campaign.record.sqlite3.connect", refusing)
    assert status_of(tmp_path).total == 5
    (tmp_path / f"{STORE}-wal").write_text("what is not in the store yet")
    said = roadgpt("show", tmp_path)
    assert said.exit_code == 2
    assert "copy this to where you may write" in " ".join(said.output.split())


@pytest.mark.parametrize("driver", ["nobody", "nofile.py:Mine", "{here}:Other", "{here}:Raises"])
def test_a_mistyped_driver_leaves_nothing_behind(tmp_path: Path, driver: str) -> None:
    mine = tmp_path / "mine.py"
    mine.write_text(
        "class Raises:\n    def __init__(self): raise ValueError('no')\n    def steer(self, view): ..."
    )
    words = ["turn x2", "-n", 2, "--reader", "plan", "--driver", driver.format(here=mine)]
    said = roadgpt("campaign", *words, "--out", tmp_path / "c")
    assert said.exit_code == 2
    assert not (tmp_path / "c").exists()


def test_files_of_other_people_beside_the_drives_are_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin_quickly(tmp_path / "c", monkeypatch, plan(5))
    (tmp_path / "c" / "traces").mkdir()
    for name in ("notes.txt", "mine.npz", "0000009.npz"):
        (tmp_path / "c" / "traces" / name).write_text("x")
    (tmp_path / "c" / "traces" / "folder").mkdir()
    [*work(tmp_path / "c", 1, "inline")]
    left = sorted(path.name for path in (tmp_path / "c" / "traces").iterdir())
    assert left == ["folder", "mine.npz", "notes.txt"]


def test_what_reading_has_cost_counts_for_the_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def dear(words: str, world: World, setup: Setup, meter: Meter) -> Brief:
        meter.add(Spent(calls=1, usage=Usage(prompt=70, completion=30), seconds=1.0, cost=0.25))
        return read(words, "plan")

    put_on_shelves(monkeypatch.setattr)
    monkeypatch.setattr("roadgpt.campaign.lifecycle.brief_of", dear)
    begin(plan(5), tmp_path / "c")
    with Record.opened(tmp_path / "c") as record:
        assert record.spent() == (100, 0.25)
    told = status_of(tmp_path / "c")
    assert (told.tokens, told.cost_usd, told.is_running, told.seconds) == (100, 0.25, False, 0.0)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("goal = 'failures'\ndrive = false", "a search (--goal failures) learns from drives"),
        ("seeds = [1, 2, 1]", "1 is listed twice"),
        ("drivers = ['reference', 'reference']", "'reference' is listed twice"),
    ],
)
def test_a_plan_that_makes_no_sense_is_told(tmp_path: Path, text: str, sentence: str) -> None:
    (tmp_path / "plan.toml").write_text(f"prompts = 'hairpin x2'\ntests = 3\nreader = 'plan'\n{text}\n")
    said = roadgpt("campaign", tmp_path / "plan.toml", "--out", tmp_path / "c")
    assert said.exit_code == 2
    assert sentence in said.output
    assert not (tmp_path / "c").exists()


def test_a_plan_that_was_saved_by_a_windows_editor_is_read(tmp_path: Path) -> None:
    (tmp_path / "plan.toml").write_text("prompts = 'two hairpins'\r\ntests = 3\r\n", encoding="utf-8-sig")
    assert read_plan(tmp_path / "plan.toml").plan.prompts == ("two hairpins",)


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        (
            {"goal": "failures", "drives": True, "generators": ("genetic",)},
            ["--goal failures", "--generator genetic"],
        ),
        (
            {"goal": "failures", "drives": True, "generators": ("quality_diversity",)},
            ["--goal failures --out"],
        ),
        (
            {"generators": ("words",), "budget": CellBudget(tests=5, seconds=60)},
            ["--seconds 60", "--no-drive"],
        ),
    ],
)
def test_the_command_on_the_card_makes_the_same_campaign(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: dict[str, Any], wanted: list[str]
) -> None:
    plain = plan(5).model_copy(update={"settings": {}, **given})
    begin_quickly(tmp_path / "c", monkeypatch, plain)
    words = command_of(tmp_path / "c")
    assert all(word in words for word in wanted), words
    monkeypatch.setattr("roadgpt.campaign.lifecycle.work", lambda *_: iter(()))
    again = CliRunner().invoke(app, shlex.split(words)[1:])
    assert again.exit_code == 0, again.output
    assert "resuming in" in again.output
