"""Plans that somebody of the trade would type can be built, on a map that grows to what they need."""

import json
from pathlib import Path

import numpy as np
import pytest

from roadgpt.brief.words import LARGEST_MAP
from roadgpt.errors import BriefError
from roadgpt.network import Route
from roadgpt.road import World
from roadgpt.road.road import MOST_CONTROL_POINTS, control_stations
from roadgpt.run import Run, Setup, brief_of, perform

PLANS = Path(__file__).parents[2] / "benchmarks" / "plans_of_practice.jsonl"
ROWS = [json.loads(line) for line in PLANS.read_text(encoding="utf-8").splitlines()]
DESIGN = Setup(reader="plan", drives=False)
QUICK = (1, 33, 38, 44, 49, 63, 67, 86, 108, 134, 154, 175, 178, 187)
"""Numbers of plans of all kinds that are designed in 0.3 s or less."""


def designed(plan: str, seed: int = 1, world: World | None = None) -> Run:
    world = world or World()
    return perform(brief_of(plan, world, DESIGN), seed, world, DESIGN)


@pytest.mark.parametrize("number", QUICK)
def test_a_plan_of_practice_is_built_and_passes_its_own_check(number: int) -> None:
    row = ROWS[number]
    run = designed(row["plan"], world=World.model_validate(row.get("world", {})))
    assert not run.findings


def test_a_route_over_two_ramps_goes_over_both() -> None:
    route = designed("| motorway // diverge ramp // | motorway // diverge ramp").road
    assert isinstance(route, Route)
    assert len(route.network.junctions) == 2


def test_the_map_grows_beyond_what_it_once_could_be_and_no_road_is_longer_than_50_km() -> None:
    run = designed("straight 16000")
    assert run.road.length == pytest.approx(16_000, rel=0.11)
    assert 10_000 < run.road.length / 2**0.5 < run.world.site.map_size <= LARGEST_MAP == 40_000
    with pytest.raises(BriefError, match=r"a straight of 60000 m|no road is longer than 50000 m"):
        designed("straight 60000")


def test_control_points_of_a_long_road_are_dense_in_its_tight_bend() -> None:
    s = np.arange(0.0, 20_001.0)
    curvature = np.where(np.abs(s - 7000) < 50, 1 / 20, 0.0)
    stations = control_stations(s, curvature)
    assert len(stations) == MOST_CONTROL_POINTS
    assert (stations[0], stations[-1]) == (0, 20_000)
    spacing, middle = np.diff(stations), (stations[1:] + stations[:-1]) / 2
    bend = np.abs(middle - 7000) < 45
    assert spacing[bend].max() < 20 / 3  # more than 3 points for each radian of the bend
    assert spacing.max() < 4.5 * 20_000 / MOST_CONTROL_POINTS
    assert (spacing[1:] / spacing[:-1]).max() < 2  # a spline through uneven points swings
