"""What the test robot drove of each of the 53 scenarios against what its source prescribes, up to the event:
measured from the recorded tracks, prescribed by the numbers in ``prescribed.py``."""

from itertools import groupby

import pytest

from measured import Measured
from prescribed import PRESCRIBED, Row
from roadgpt.brief.plan import read_plan
from roadgpt.brief.scenarios import LANE_WIDTH, scenario, scenarios
from roadgpt.road import World
from roadgpt.run import Setup, perform

BY_POINT = {name: [*rows] for name, rows in groupby(PRESCRIBED, lambda row: row.scenario)}


def test_something_is_prescribed_of_each() -> None:
    assert {*scenarios()} <= {*BY_POINT}
    assert all(row.tolerance > 0 for row in PRESCRIBED)


@pytest.mark.parametrize("name", BY_POINT)
def test_what_is_driven_is_what_is_prescribed(name: str) -> None:
    world = World().changed(lane_width=LANE_WIDTH)
    run = perform(
        read_plan(scenario(name).plan), 1, world, Setup(driver="robot", reader="plan", scenario=name)
    )
    measured = Measured(run)
    found = {
        (row.who, row.what): (getattr(measured, row.what)(row.who, row.want), row) for row in BY_POINT[name]
    }
    assert not {key: pair for key, pair in found.items() if not _holds(*pair)}


def _holds(value: float, row: Row) -> bool:
    return abs(value - row.want) <= row.tolerance
