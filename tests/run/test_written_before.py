"""What was written when the default driver was beamng_like and the default tolerance 0.95 keeps its meaning.

``written_before`` was made by the version before the change: a folder of runs that was stopped after the
first of two roads, a campaign of one test, and the card of a study.
"""

import csv
import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from roadgpt.campaign.csv_tables import write_tables
from roadgpt.campaign.record import Record, Store
from roadgpt.campaign.status import cell_statuses
from roadgpt.cli import app
from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.run import Request, read_run
from roadgpt.run.card import read_card
from roadgpt.study.plan import read_plan

MADE = Path(__file__).parent / "written_before"
WORDS = "straight 20; turn left 90 r15; straight 15"


@pytest.fixture
def old(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copytree(MADE, tmp_path / "old")
    monkeypatch.setattr("roadgpt.cli.options.drawing_of", lambda *_: None)  # pictures take long
    monkeypatch.chdir(tmp_path / "old")
    return tmp_path / "old"


def roadgpt(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words], prog_name="roadgpt")


def is_of_then(request: Request) -> bool:
    limits = request.world.limits
    return (request.setup.driver, limits.oob_tolerance, limits.lane_departure) == ("beamng_like", 0.95, False)


def test_a_stopped_folder_goes_on_with_its_own_driver_and_tolerance(old: Path) -> None:
    assert is_of_then(read_card(old / "run").request)
    assert is_of_then(read_run("run/runs/0001").request)
    assert roadgpt("resume", "run").exit_code == 2  # it has no record of what decided the first road
    done = roadgpt("resume", "run", "--again")
    assert done.exit_code == 0, done.output
    assert "driver beamng_like, oracle thesis: FAIL when more than 95 % of the car is outside" in done.stdout
    second = read_run("run/runs/0002")
    assert is_of_then(second.request)
    assert second.drive is not None
    assert second.drive.driver == "beamng_like"


def test_an_old_drive_is_read_and_driven_again_byte_for_byte(old: Path) -> None:
    drive = Drive.load(old / "run" / "runs" / "0001" / "drive.npz")
    assert (drive.driver, drive.handovers, drive.shares) == ("beamng_like", (), {})
    verdict = read_run("run/runs/0001").verdict
    assert verdict is not None
    assert (verdict.outcome, verdict.own_share, verdict.handed_to) == ("PASS", None, None)
    assert verdict.max_oob > 0.5  # by today's default it had failed
    done = roadgpt("drive", "--again", "run", 1, "--no-plot", "--out", "again")
    assert done.exit_code == 0, done.output
    assert Path("again/runs/0001/drive.npz").read_bytes() == Path("run/runs/0001/drive.npz").read_bytes()


def test_the_same_words_without_the_old_defaults_are_another_campaign(old: Path) -> None:
    words = (WORDS, "--reader", "plan", "--seed", 1, "-n", 2, "--no-plot", "--out", "run")
    done = roadgpt("run", *words)
    assert done.exit_code == 2
    assert "run holds other roads (different driver and oob_tolerance)" in done.stderr
    done = roadgpt("run", *words, "--driver", "beamng_like", "--oracle", "thesis")
    assert "has changed: roadgpt (was not recorded, is " in done.stderr
    assert not Path("run/runs/0002").exists()


def test_an_old_campaign_is_told_and_gets_the_columns_that_it_lacks(old: Path) -> None:
    with Record.opened(old / "campaign") as record:
        (cell,), (status,) = record.cells(), cell_statuses(record)
        (result,) = record.results("c01")
    assert is_of_then(cell.request)
    assert (status.driver, status.oracle, status.handed_over) == ("beamng_like", "thesis", 0)
    assert (result.own_share, result.handed_to) == (None, None)
    said = roadgpt("show", "campaign").stdout
    assert "driver beamng_like, oracle thesis: FAIL when more than 95 %" in said
    Store.opened(old / "campaign").close()
    with Store.opened(old / "campaign") as store:
        assert [*store.results("c01")] == [result]
        assert not store.missing
        write_tables(store, old)
    with Path("cells.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["driver"], row["oracle"], row["failed_handed_over"]) == ("beamng_like", "thesis", "0")


def test_an_old_study_keeps_its_driver_and_tolerance(old: Path) -> None:
    plan = read_plan(old / "study")
    assert (plan.setup.driver, plan.world.limits.oracle) == ("beamng_like", "thesis")


@pytest.mark.parametrize("lost", ["driver", "oob_tolerance"])
def test_a_card_that_does_not_say_what_the_default_decided_is_refused(old: Path, lost: str) -> None:
    for name in ("run/campaign.json", "run/runs/0001/run.json"):
        card = json.loads((old / name).read_text())
        for part in card["request"].values():
            if isinstance(part, dict):
                part.pop(lost, None)
        (old / name).write_text(json.dumps(card))
    for read in (lambda: read_card(old / "run"), lambda: read_run("run/runs/0001")):
        with pytest.raises(UsageError, match="lacks driver or oob_tolerance, whose defaults have changed"):
            read()


def test_what_is_written_now_says_driver_and_oracle(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = roadgpt("run", WORDS, "--reader", "plan", "--seed", 1, "--no-plot", "--out", "now")
    assert "driver lane_centring, oracle half: FAIL when more than half of the car is outside" in done.stdout
    for name in ("now/campaign.json", "now/runs/0001/run.json"):
        request = json.loads(Path(name).read_text())["request"]
        assert request["setup"]["driver"] == "lane_centring"
        assert (request["world"]["oob_tolerance"], request["world"]["lane_departure"]) == (0.5, False)
    with Path("now/experiment_description.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["driver"], row["oracle"], row["oob_tolerance"]) == ("lane_centring", "half", "0.5")
