"""Stored drives that are judged again by the rules of today, and what stays to be told of them."""

import json
from pathlib import Path

import pytest

from command_line import invoke
from roadgpt.run import read_run
from roadgpt.verdict import JUDGEMENT


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs: the robot drives into a standing car."""
    folder = tmp_path_factory.mktemp("rejudge") / "stored"
    words = ("straight 200 && car ahead v=0", "--reader", "plan", "--driver", "robot", "--no-plot")
    assert invoke("run", *words, "-n", "2", "--seed", "1", "--out", str(folder)).exit_code == 0
    return folder


@pytest.fixture
def stored(made: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(made.parent)
    return Path(made.name)


def changed(folder: Path, number: int, name: str, **values: object) -> None:
    """Writes other values into a file of a run, as another version of the rules may have stored them."""
    file = folder / "runs" / f"{number:04d}" / name
    file.write_text(json.dumps(json.loads(file.read_text()) | values))


def test_each_record_holds_the_version_of_the_rules(stored: Path) -> None:
    assert read_run(stored / "runs" / "0001").versions["judgement"] == str(JUDGEMENT)
    assert f"judgement {JUDGEMENT}" in invoke("show", f"{stored}/1").stdout


def test_outcomes_that_would_be_others_are_told_with_the_reason(stored: Path) -> None:
    done = invoke("show", "--rejudge", str(stored))
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines() == [
        f"2 drives judged again by version {JUDGEMENT} of the rules: 2 of version {JUDGEMENT}",
        "0 outcomes would be others today",
    ]
    # as an earlier version of the rules might have judged the first one
    run = json.loads((stored / "runs" / "0001" / "run.json").read_text())
    before, rest = run["description"].split("; ", 1)
    versions = {name: value for name, value in run["versions"].items() if name != "judgement"}
    told = {"outcome": "UNAVOIDABLE", "description": f"{before}; nobody could have avoided it"}
    changed(stored, 1, "run.json", **told, versions=versions)
    changed(stored, 1, "verdict.json", **told)
    (stored / "runs" / "0002" / "drive.npz").write_bytes(b"no drive")
    first, second, *counts = invoke("show", "--rejudge", str(stored)).stdout.splitlines()
    assert first == (
        f"{stored}/1  UNAVOIDABLE -> FAIL (collision)  it was: nobody could have avoided it; today: {rest}"
    )
    assert second.startswith(f"{stored}/2  cannot be judged again: ")
    assert counts == [
        f"1 drive judged again by version {JUDGEMENT} of the rules: 1 of version 1",
        "1 outcome would be others today, 1 cannot be judged again",
        "      1  UNAVOIDABLE -> FAIL (collision)",
    ]
    (one,) = map(json.loads, invoke("show", "--rejudge", "--json", f"{stored}/runs/0001").stdout.splitlines())
    assert (one["stored"], one["today"], one["version"]) == ("UNAVOIDABLE", "FAIL (collision)", 1)
    assert invoke("show", "--rejudge", "--failures", str(stored)).exit_code == 2
