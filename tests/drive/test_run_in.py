"""A test of the catalogue: the test robot drives until the event begins, then the driver; and the drive ends
when the event is over. Times and gaps are taken from the recorded motion alone."""

import math
from dataclasses import replace

import numpy as np
import pytest

from roadgpt.brief.plan import read_plan, read_scene, scene_plan
from roadgpt.brief.scenarios import LANE_WIDTH, scenario, scenarios
from roadgpt.drive import Command, Drive, simulate
from roadgpt.drive.drive import RUN_IN
from roadgpt.errors import UsageError
from roadgpt.road import World
from roadgpt.run import Run, Setup, judged, perform

LEADS = (
    "straight 600 | flat lanes=1 against=1 && ego test_robot v=50; car ahead thw=1 v=50: brake 4 to=2 time=3"
)
STANDS = "straight 600 | flat lanes=1 against=1 && ego test_robot v=50; car ahead gap=100 v=0"
CROSSES = (
    "straight 600 | flat lanes=1 against=1 && ego test_robot v=50; adult crossing right v=5 impact=50: cross"
)
DRIFTS = (
    "straight 900 | flat lanes=1 against=1 && "
    "ego test_robot v=70: drift left 1 lat=0.4 time=4, release time=6"
)
AFTER = 4.0  # s
SPEED = 0.5 / 3.6  # m/s, of the tested car before T0: Euro NCAP


class Brakes:
    """Brakes from its first step on."""

    name = "brakes"

    def steer(self, view: object) -> Command:
        return Command(0.0, 0.0, 1.0)


class Sleeps:
    """Does nothing."""

    name = "sleeps"

    def steer(self, view: object) -> Command:
        return Command(0.0, 0.1, 0.0)


def driven(plan: str, driver: object) -> Run:
    road = perform(
        read_plan(plan), 1, World().changed(lane_width=LANE_WIDTH), Setup(reader="plan", drives=False)
    )
    assert road.road is not None, road.description
    drive = simulate(road.road, road.world, driver, 1)
    return judged(replace(road, drive=drive))


def handed(drive: Drive) -> float:
    """When the run-in ends; it is one stretch from the start."""
    (run_in,) = [each for each in drive.handovers if each.by == RUN_IN]
    assert run_in.start == 0.0
    return run_in.end


def between(drive: Drive, time: float) -> float:
    """Metres between the tested car and the first of the others, one behind the other on a straight road."""
    assert drive.others is not None
    (x, y), other = (np.interp(time, drive["time"], drive.middles[:, n]) for n in (0, 1)), drive.others
    far = math.hypot(*(other.at(time)[0, :2] - (x, y)))
    return far - (drive.car.length + other.actors[0].size[0]) / 2


def test_speed_and_headway_are_held_until_the_leader_brakes() -> None:
    drive = driven(LEADS, Brakes()).drive
    assert drive is not None
    before = drive["time"] <= 3.0
    assert handed(drive) == pytest.approx(3.0, abs=0.021)
    assert drive["speed"][before] == pytest.approx(50 / 3.6, abs=SPEED)
    assert between(drive, 2.9) == pytest.approx(50 / 3.6, abs=0.5)
    assert drive.unheeded is not None
    assert (drive.unheeded[before[1:], 2] == 1.0).all()
    assert np.isnan(drive.unheeded[~before[1:]]).all()


def test_it_ends_when_the_car_stands_and_the_leader_drives_away() -> None:
    run = driven(LEADS, Brakes())
    drive = run.drive
    assert drive is not None
    stands = drive["time"][np.argmax(drive["speed"] < 0.1)]
    assert drive.ended == "over"
    assert drive.duration > stands
    assert drive.duration < 3.0 + 48 / 3.6 / 4 + AFTER + 1.0  # the leader has braked to 2 km/h
    assert run.outcome == "PASS"
    assert "to the end of the event" in run.description
    assert f"{RUN_IN} drove until 3.0 s (T0)" in run.description


@pytest.mark.parametrize("driver", ["reference", "lane_centring"])
def test_it_begins_4_s_before_who_stands_and_ends_behind_it(driver: str) -> None:
    run = driven(STANDS, driver)
    drive = run.drive
    assert drive is not None
    at = handed(drive)
    assert between(drive, at) / (50 / 3.6) == pytest.approx(4.0, abs=0.11)
    assert drive["speed"][drive["time"] <= at] == pytest.approx(50 / 3.6, abs=SPEED)
    assert (drive.ended, run.outcome) == ("over", "PASS")
    stood = drive["time"][drive["speed"] > 0.1].max()
    assert drive.duration - stood == pytest.approx(AFTER, abs=2.0)


@pytest.mark.parametrize("driver", ["reference", "lane_centring"])
def test_it_ends_when_who_crosses_has_left_the_lane(driver: str) -> None:
    run = driven(CROSSES, driver)
    drive = run.drive
    assert drive is not None
    assert drive.others is not None
    assert (drive.ended, run.outcome) == ("over", "PASS")
    last = drive.others.states[-1, 0]
    assert last[1] * drive.others.states[0, 0, 1] < 0 or abs(last[1]) > LANE_WIDTH  # on the other side


def test_somebody_far_away_who_does_nothing_is_an_event_too() -> None:
    run = driven(STANDS.replace("gap=100", "gap=400"), "reference")
    assert run.drive is not None
    assert between(run.drive, handed(run.drive)) / (50 / 3.6) == pytest.approx(4.0, abs=0.11)
    assert run.drive.ended == "over"


def test_who_steers_back_has_ended_and_who_does_not_fails() -> None:
    back, out = driven(DRIFTS, "reference"), driven(DRIFTS, Sleeps())
    assert back.drive is not None
    assert out.drive is not None
    assert (back.drive.ended, back.outcome) == ("over", "PASS")
    assert 6.0 + AFTER <= back.drive.duration < 14.0
    assert (out.outcome, out.verdict and out.verdict.cause) == ("FAIL", "out of lane")
    assert out.drive.duration > 6.0


def test_the_other_words_and_the_robot_itself_have_no_run_in() -> None:
    whole, own = driven(LEADS.replace("test_robot", "robot"), Brakes()), driven(LEADS, "robot")
    assert whole.drive is not None
    assert own.drive is not None
    assert not whole.drive.handovers
    assert whole.drive.duration > 60.0
    assert not own.drive.handovers


def test_nothing_to_wait_for_leaves_the_driver_all_the_way() -> None:
    run = driven("straight 300 | flat && ego test_robot v=50", "reference")
    assert run.drive is not None
    assert (run.drive.ended, run.drive.handovers) == ("goal", ())


def test_simulators_without_it_refuse_it_by_name() -> None:
    class Other:
        moves_others = True

        def simulate(self, *given: object) -> Drive:
            raise AssertionError

    made = perform(read_plan(STANDS), 1, World(), Setup(reader="plan", drives=False))
    assert made.road is not None
    with pytest.raises(UsageError, match="run-in"):
        simulate(made.road, made.world, "reference", 1, Other())  # type: ignore[arg-type]


def test_each_scenario_of_the_catalogue_is_such_a_test() -> None:
    for each in scenarios().values():
        scene = read_plan(f"straight 600 && {each.scene_text}").scene
        assert scene.is_test, each.name
        assert "test_robot" in scene_plan(scene)


def test_a_stored_scene_of_a_scenario_drives_on_to_the_goal_as_it_did() -> None:
    stored = read_scene("ego robot v=50; car ahead v=0 impact=50")  # of ncap:CCRs
    assert scenario("ncap:CCRs").onto(stored) == stored
