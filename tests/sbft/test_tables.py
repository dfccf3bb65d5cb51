"""The competition's tables: every column is that of the tests that were counted."""

import csv
from pathlib import Path

import numpy as np
import pytest

from roadgpt.road import CrossSection, Limits, Site, World
from roadgpt.run.model import Request, Seconds, Setup
from roadgpt_sbft.sparseness import Departure
from roadgpt_sbft.tables import Tally, TallyEntry

STRAIGHT = np.column_stack([np.arange(10.0), np.zeros(10)])
BENT = np.column_stack([10 * np.cos(np.arange(10) / 10), 10 * np.sin(np.arange(10) / 10)])
LONG = np.column_stack([np.arange(0.0, 60.0, 3.0), np.arange(20.0) ** 2 / 20])


def row_of(path: Path) -> dict[str, str]:
    with path.open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    return row


def left_at(side: str, points: np.ndarray | None) -> Departure:
    return Departure(side, 5) if points is None else Departure(side, 5, 0, points[:5], points[5:])


def test_every_column_counts_the_tests_that_it_names(tmp_path: Path) -> None:
    entries = [
        TallyEntry(1, "PASS", True, Seconds(1.0, 10.0), 20.0, None),
        TallyEntry(2, "FAIL", True, Seconds(2.0, 20.0), 30.0, left_at("left", STRAIGHT)),
        TallyEntry(3, "FAIL", True, Seconds(4.0, 40.0), 40.0, left_at("right", BENT)),
        TallyEntry(4, "FAIL", True, Seconds(8.0, 80.0), 50.00006, left_at("right", None)),
        TallyEntry(5, "FAIL", True, Seconds(0.5, 0.25), 5.0, left_at("left", LONG)),
        TallyEntry(6, "FAIL", True, Seconds(0.25, 0.125), 5.0, None),  # it was too slow
        TallyEntry(7, "INVALID", False, Seconds(16.0, 0.0), 0.0, None),
        TallyEntry(8, "ERROR", False, Seconds(32.0, 0.0), 0.0, None),
        TallyEntry(9, "ERROR", True, Seconds(64.0, 160.0), 0.0, None),
        TallyEntry(10, "VALID", True, Seconds(128.0, 0.0), 0.0, None),
    ]
    tally = Tally()
    for entry in entries:
        tally.add(entry)
    tally.write(tmp_path)
    columns = {
        "test_generated": "10",
        "test_valid": "8",
        "test_invalid": "2",
        "test_passed": "1",
        "test_failed": "5",
        "test_in_error": "2",
        "real_time_generation": "255.75",
        "real_time_execution": "310.375",
        "simulated_time_execution": "150.0001",
    }
    assert [*row_of(tmp_path / "generation_stats.csv").items()] == [*columns.items()]
    row = row_of(tmp_path / "oob_stats.csv")
    assert [row[name] for name in ("total_oob", "left_oob", "right_oob")] == ["4", "2", "2"]
    alone = {}
    for one, other in ((1, 2), (1, 4), (2, 4)):  # the distance of each pair by a table of its own
        pair = Tally()
        for number in (one, other):
            pair.add(entries[number])
        assert pair.spread is not None
        alone[one, other] = pair.spread.mean
    assert len(set(alone.values())) == 3
    furthest = [max(alone[1, 2], alone[1, 4]), alone[2, 4]]
    assert float(row["avg_sparseness"]) == pytest.approx(np.mean(furthest), abs=0.000501)
    assert float(row["stdev_sparseness"]) == pytest.approx(np.std(furthest), abs=0.501)


@pytest.mark.parametrize("failures", [0, 1])
def test_fewer_than_two_failures_have_no_sparseness(failures: int, tmp_path: Path) -> None:
    tally = Tally()
    for number in range(failures):
        tally.add(TallyEntry(number, "FAIL", True, Seconds(), 1.0, left_at("left", BENT)))
    tally.write(tmp_path)
    row = row_of(tmp_path / "oob_stats.csv")
    assert list(row.values()) == [str(failures), str(failures), "0", "nan", "nan"]
    assert list(row) == ["total_oob", "left_oob", "right_oob", "avg_sparseness", "stdev_sparseness"]


def test_every_setting_is_in_the_description_of_an_experiment(tmp_path: Path) -> None:
    world = World(
        site=Site(map_size=400, friction=0.7),
        section=CrossSection(lane_width=3.25, shoulder=1.5),
        limits=Limits(speed_limit=50 / 3.6, oob_tolerance=0.85),
    )
    setup = Setup(reader="plan", driver="pure_pursuit", drives=False)
    Tally.describe(Request(words="| turns=3", seed=17, world=world, setup=setup), 12, tmp_path)
    row = row_of(tmp_path / "experiment_description.csv")
    known = {
        "executor": setup.simulator,
        "map_size": "400.0",
        "oob_tolerance": "0.85",
        "speed_limit": "50.0",
        "module_name": "roadgpt",
        "class_name": setup.designer,
        "description": "| turns=3",
        "roads": "12",
        "seed": "17",
        "reader": "plan",
        "driver": "pure_pursuit",
        "drives": "False",
    }
    assert {name: row[name] for name in known} == known
    for name in ("dave2_model", "beamng_home", "beamng_user", "time_budget", "module_path", "debug"):
        assert row[name] == ""
    written = ",".join(row.values())
    assert all(number in written for number in ("0.7", "3.25", "1.5"))
    assert not {"designer", "simulator", "chat"} & {*row}
