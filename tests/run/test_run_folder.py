"""Runs on the disk: what is written is read back, and is what the competition's tools expect."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from roadgpt.brief.model import Brief, Clause
from roadgpt.errors import UsageError
from roadgpt.road import Limits, Road, World
from roadgpt.run import Request, Run, Setup, prove, read_run, write_run
from roadgpt.run.execution import test_of as as_test
from roadgpt_sbft.tables import Tally
from run.doubles import TOO_STEEP, a_design

NEVER = """
from roadgpt.drive import Command

class Never:
    name = "never"

    def steer(self, view):
        return Command(0.0, 0.6, 0.0)
"""
WORDS = "a road with 'quotes', $money & 3 turns"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Run]:
    file = tmp_path_factory.mktemp("driver") / "never.py"
    file.write_text(NEVER)
    brief = Brief(words=WORDS, clauses=(Clause(kind="turn"),))
    made = {
        "PASS": prove(a_design(3), 11),
        "FAIL": prove(
            a_design(25), 12, World(limits=Limits(speed_limit=30.0)), Setup(driver=f"{file}:Never"), 2
        ),
        "INVALID": prove(a_design(0, (TOO_STEEP,)), 13, index=3),
        "VALID": prove(
            Road.through([[40, 100, 1], [90, 101, 2], [140, 120, 3]]), 14, World(), Setup(drives=False)
        ),
        "ERROR": Run(Request(), 5, 1, "ERROR", "no road of 9 hairpins fits on this map", brief),
    }
    named = made["PASS"].request.model_copy(update={"words": WORDS})
    made["PASS"] = replace(made["PASS"], request=named, brief=brief, rounds=2)
    return made


@pytest.mark.parametrize("outcome", ["PASS", "FAIL", "INVALID", "VALID", "ERROR"])
def test_a_run_is_read_back_as_it_was(runs: dict[str, Run], outcome: str, tmp_path: Path) -> None:
    run = runs[outcome]
    assert run.outcome == outcome
    folder = write_run(run, tmp_path)
    for path in (folder, tmp_path / f"test.{run.index:04d}.json"):
        again = read_run(path)
        for name in ("request", "index", "seed", "outcome", "description", "brief", "design", "findings"):
            assert getattr(again, name) == getattr(run, name)
        assert (again.verdict, again.rounds, again.versions) == (run.verdict, run.rounds, run.versions)
        assert again.seconds == run.seconds
        assert (again.drive is None) == (run.drive is None)
        if run.drive is not None and again.drive is not None:
            assert again.drive.to_bytes() == run.drive.to_bytes()
        if run.road is not None and again.road is not None:
            s = np.linspace(0, run.length, 50)
            assert np.array_equal(again.road.at(s), run.road.at(s))


def test_nothing_unfinished_is_left(runs: dict[str, Run], tmp_path: Path) -> None:
    for run in runs.values():
        write_run(run, tmp_path)
        write_run(run, tmp_path)
    assert not list(tmp_path.rglob("*.part"))
    assert len(list(tmp_path.glob("test.*.json"))) == len({run.index for run in runs.values()})


def test_a_driven_test_has_the_competition_s_shape(runs: dict[str, Run]) -> None:
    test = json.loads(json.dumps(as_test(runs["PASS"])))
    assert list(test) == [
        "is_valid",
        "validation_message",
        "road_points",
        "interpolated_points",
        "id",
        "execution_data",
        "test_outcome",
        "description",
        "features",
    ]
    assert test["is_valid"] is True
    assert test["validation_message"] == ""
    assert (test["test_outcome"], test["description"]) == ("PASS", "Successful test")
    assert set(test["features"]) == {"MAX_CURV", "DIR_COV", "STD_SA", "MEAN_LP", "MAX_LP"}
    assert all(len(record) == 17 for record in test["execution_data"])
    assert all(len(point) == 2 for point in test["road_points"])


def test_interpolated_points_are_the_road_about_every_metre(runs: dict[str, Run]) -> None:
    run = runs["PASS"]
    assert run.road is not None
    points = np.array(as_test(run)["interpolated_points"])
    gaps = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1)
    assert gaps == pytest.approx(1.0, abs=0.02)
    assert len(points) == round(run.length) + 1
    assert points[[0, -1]] == pytest.approx(run.road.at([0.0, run.length]), abs=1e-5)
    assert np.ptp(points[:, 2]) > 1


def test_a_departure_is_told_in_the_competition_s_words(runs: dict[str, Run]) -> None:
    test = as_test(runs["FAIL"])
    assert test["test_outcome"] == "FAIL"
    assert test["description"].startswith("Car drove out of the lane")
    assert [record.is_oob for record in test["execution_data"]].index(True) == len(test["execution_data"]) - 1


def test_what_was_not_driven_has_no_outcome_of_a_drive(runs: dict[str, Run]) -> None:
    valid, invalid, error = (as_test(runs[name]) for name in ("VALID", "INVALID", "ERROR"))
    assert valid["test_outcome"] is None
    assert set(valid["features"]) == {"MAX_CURV", "DIR_COV"}
    assert invalid["is_valid"] is False
    assert invalid["validation_message"] == invalid["description"] == runs["INVALID"].findings[0].sentence
    assert invalid["execution_data"] == []
    assert (error["road_points"], error["is_valid"]) == ([], False)
    assert "9 hairpins" in error["validation_message"]


def test_runs_are_counted_as_what_they_were(runs: dict[str, Run]) -> None:
    tally = Tally()
    for run in (*runs.values(), runs["FAIL"]):
        tally.add(Tally.entry(run))
    assert tally.outcomes == {"PASS": 1, "FAIL": 2, "INVALID": 1, "VALID": 1, "ERROR": 1}
    assert tally.valid == 4
    driven = [runs["PASS"].drive, runs["FAIL"].drive, runs["FAIL"].drive]
    assert tally.simulated == pytest.approx(sum(drive.duration for drive in driven if drive is not None))
    verdict = runs["FAIL"].verdict
    assert verdict is not None
    assert tally.sides == {verdict.side: 2}
    assert tally.spread is not None
    assert tally.spread.mean == 0.0  # twice the same


@pytest.mark.parametrize(
    ("damage", "complaint"),
    [
        (lambda folder: (folder / "run.json").unlink(), "there is no run"),
        (lambda folder: (folder / "run.json").write_text("{"), "cannot be read"),
        (lambda folder: (folder / "run.json").write_text('{"format": 99}'), "another version"),
        (lambda folder: (folder / "road.json").write_text("{}"), "cannot be read"),
        (lambda folder: (folder / "drive.npz").write_bytes(b"no"), "drive the road again"),
        (lambda folder: (folder / "verdict.json").write_text("[1"), "cannot be read"),
    ],
)
def test_a_damaged_run_is_told_in_a_sentence(
    runs: dict[str, Run],
    tmp_path: Path,
    damage,
    complaint: str,  # type: ignore[no-untyped-def]
) -> None:
    folder = write_run(runs["PASS"], tmp_path)
    damage(folder)
    with pytest.raises(UsageError, match=complaint):
        read_run(folder)


def test_a_campaign_is_no_run(runs: dict[str, Run], tmp_path: Path) -> None:
    write_run(runs["PASS"], tmp_path)
    with pytest.raises(UsageError, match="holds many runs"):
        read_run(tmp_path)
    with pytest.raises(UsageError, match="there is no run"):
        read_run(tmp_path / "runs" / "0009")
