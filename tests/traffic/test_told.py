"""What people write and the world once could not do: three plans of each happen as told, in the events of the
verdict and for an outside judge of the exported files. The truths were written beside the plans, in the words
of that judge."""

import json
from pathlib import Path
from typing import Any

import pytest

from outside_judge import traffic_referee
from roadgpt.run import Setup, perform
from roadgpt.run.exporting import export

LOSSES: dict[str, list[dict[str, Any]]] = json.loads((Path(__file__).parent / "told.json").read_text())
ROWS = [pytest.param(row, id=f"{loss}: {row['plan']}") for loss, rows in LOSSES.items() for row in rows]


def test_each_loss_has_three_plans() -> None:
    assert {len(rows) for rows in LOSSES.values()} == {3}


@pytest.mark.parametrize("row", ROWS)
def test_it_happens_as_told(row: dict[str, Any], tmp_path: Path) -> None:
    run = perform(row["plan"], 1, setup=Setup(reader="plan", driver=row["driver"]))
    assert run.verdict is not None, run.description
    assert [str(each) for each in run.verdict.events or () if each.time is None] == []
    export(run, tmp_path, ["opendrive", "openscenario"], lambda said: None)
    holds, measured = traffic_referee().check(f"{tmp_path}/road.drive.xosc", row["truth"])
    assert all(holds.values()), measured
