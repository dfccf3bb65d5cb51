"""Failures that a campaign looks into when it is done, by its own options; what its report says of them."""

import csv
import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from roadgpt.campaign.faults import Simplest
from roadgpt.campaign.faults.book import Counted, counted
from roadgpt.cli import app
from roadgpt.errors import UsageError
from roadgpt.run import Run

WORDS = ["zig-zag downhill with 3 turns", "-n", 2, "--friction", 0.4, "--seed", 3, "--reader", "grammar"]


def roadgpt(*words: object) -> Result:
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    return done


@pytest.fixture(scope="module")
def looked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign whose roads fail, and were looked into when it was done."""
    folder = tmp_path_factory.mktemp("looked") / "c"
    done = roadgpt("campaign", *WORDS, "--out", folder, "--faults", "--repeat", 2, "--json")
    (line,) = done.stdout.splitlines()
    assert json.loads(line)["outcomes"] == {"FAIL": 2}
    assert "2 failures, of which" in done.stderr
    return folder


def test_a_campaign_looks_into_its_failures_when_it_is_done(looked: Path) -> None:
    with (looked / "faults" / "c01" / "faults.csv").open() as file:
        rows = [*csv.DictReader(file)]
    assert sorted(row["road"] for row in rows) == ["1", "2"]
    assert {row["drives"] for row in rows} == {"2"}
    found = counted(looked / "faults" / "c01")
    assert found == Counted(
        2, sum(2 * int(row["failed_again"]) >= 2 for row in rows), len({row["fault"] for row in rows})
    )


def test_the_report_says_how_many_faults_they_are(looked: Path) -> None:
    roadgpt("report", looked)
    with (looked / "tables" / "faults.csv").open() as file:
        ((_, *row),) = [row for row in csv.reader(file) if row[0] == "c01"]
    found = counted(looked / "faults" / "c01")
    assert found is not None
    assert [int(number) for number in row] == [2, found.failures, found.stable, found.faults]
    assert 'href="faults/c01/faults.csv"' in (looked / "report.html").read_text(encoding="utf-8")


def test_the_simplest_road_is_looked_for_once(looked: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def quick(run: Run) -> Simplest:
        asked.append(run.index)
        return Simplest(run, 1, 1, True)

    monkeypatch.setattr("roadgpt.campaign.faults.simplest", quick)
    for _ in range(2):
        roadgpt("resume", looked, "--minimise", "--repeat", 2, "--quiet")
    found = counted(looked / "faults" / "c01")
    assert found is not None
    assert len(asked) == found.faults == len([*(looked / "faults" / "c01").glob("simplest-*")])


def test_a_table_that_somebody_spoilt_is_told(tmp_path: Path) -> None:
    assert counted(tmp_path) is None
    (tmp_path / "faults.csv").write_text("fault,share\n1,often\n")
    with pytest.raises(UsageError, match=r"faults.csv cannot be read .* make it again with roadgpt faults"):
        counted(tmp_path)
