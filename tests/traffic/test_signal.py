"""What the first traffic lights show to the tested car, where a scene tells it: read from drives alone."""

import numpy as np
import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.drive import Drive
from roadgpt.errors import BriefError
from roadgpt.run import Run, Setup, perform

ROAD = "straight 150 // crossroads straight lights // straight 100"
CYCLE = 40.0  # s: 15 of green, 3 of yellow and 2 of red for all, twice


def run_of(words: str, driver: str, seed: int = 3) -> Run:
    return perform(words, seed=seed, setup=Setup(driver=driver, reader="plan"))


def drive_of(run: Run) -> Drive:
    assert run.drive is not None
    return run.drive


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("driver", ["reference", "lane_centring"])
def test_a_driver_waits_at_red_and_goes_on(driver: str, seed: int) -> None:
    run = run_of(f"{ROAD} && ego v=50; lights red", driver, seed)
    drive = drive_of(run)
    assert run.road is not None
    stands = drive["speed"] < 0.1
    assert 5.0 < np.ptp(drive["time"][stands]) < 16.0
    assert 0.0 < run.road.passages[0].line - drive["s"][stands][0] < 6.0
    assert run.outcome == "PASS"
    green = drive_of(run_of(f"{ROAD} && ego v=50; lights green", driver, seed))
    assert green["speed"].min() > 8.0


@pytest.mark.parametrize(("shows", "runs"), [("red", True), ("green", False), ("yellow", False)])
def test_who_looks_at_no_light_runs_the_red_one(shows: str, runs: bool) -> None:
    verdict = run_of(f"{ROAD} && ego v=50; lights {shows}", "robot").verdict
    assert verdict is not None
    assert ("red light" in verdict.counts) == runs


def test_lights_turn_when_they_are_told_to() -> None:
    run = run_of(f"{ROAD} && ego v=50; lights green time=24", "reference")
    drive = drive_of(run)
    assert drive["time"][drive["speed"] < 0.1][-1] == pytest.approx(24.0, abs=1.0)
    assert [turns(f"{ROAD} && ego v=50; lights {each}") for each in ("red time=2", "red time=25")] == [
        True,
        False,
    ]


def turns(words: str) -> bool:
    """Whether the robot, which comes to the line after some 10 s, ran a red light."""
    verdict = run_of(words, "robot").verdict
    assert verdict is not None
    return "red light" in verdict.counts


def test_junctions_get_lights_where_they_are_told_and_none_against_the_words() -> None:
    run = run_of("straight 150 // crossroads straight // straight 100 && ego v=50; lights red", "reference")
    assert run.road is not None
    assert run.road.passages[0].control == "lights"
    with pytest.raises(
        BriefError, match="no junction of the road has lights; write lights there instead of stop"
    ):
        run_of("straight 150 // crossroads straight stop // straight 100 && lights red", "reference")


def test_what_a_part_lacks_is_named() -> None:
    with pytest.raises(BriefError, match="it lacks red or yellow or green"):
        read_plan("crossroads lights && lights")
    with pytest.raises(BriefError, match="it lacks s="):
        read_plan("crossroads lights && slippery mu=0.3")


@pytest.mark.parametrize("part", ["lights red", "lights green time=5", "lights yellow time=2..8"])
def test_plans_with_lights_read_back(part: str) -> None:
    brief = read_plan(f"crossroads lights && {part}")
    assert read_plan(plan(brief)) == brief


@pytest.mark.parametrize(
    "part", ["lights", "lights blue", "lights red; lights green", "lights red time=9999"]
)
def test_lights_that_cannot_be_are_refused(part: str) -> None:
    with pytest.raises(BriefError):
        read_plan(f"crossroads lights && {part}")
