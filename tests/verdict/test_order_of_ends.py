"""Goal, then motion, then lane: what is asked first at one and the same step, as the SBFT competition does.

The car's way is written by hand, so that things happen at one step that hardly ever do.
"""

import math
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.drive import COLUMNS, Command, Drive, View, drive_monitor
from roadgpt.drive.simulators import mujoco
from roadgpt.drive.simulators.mujoco import MujocoSimulator
from roadgpt.road import Limits, Road, World
from roadgpt.verdict import Verdict, consult, judge

ROAD = Road.through([[10, 20], [40, 20], [70, 20]])  # along +x, 60 m, y of its middle is 20
WORLD = World(limits=Limits(oob_tolerance=0.5))
IN, OUT = -2.0, 1.5  # m to the left of the centre line: in the lane's middle, and wholly outside
FAST, STANDS = 3.0, 0.0  # m from step to step
PATIENCE = 0.1  # s without motion, instead of 10

Step = tuple[float, float, bool]  # metres on, metres to the left, fallen


class Sits:
    def steer(self, view: View) -> Command:
        return Command(0.0)


class OnRails:
    """Stands in for the car: goes where it is told, then on to the goal in its lane."""

    def __init__(self, way: list[Step]) -> None:
        self.way = iter(way)
        self.s, self.mishap, self.row = 2.5, None, np.zeros(len(COLUMNS))
        self._tell(IN)

    def put(self, s: float, t: float, speed: float = 0.0) -> None:
        assert (s, t, speed) == (2.5, IN, 0.0)

    def move(self, steer: float, throttle: float, brake: float) -> None:
        on, t, has_fallen = next(self.way, (FAST, IN, False))
        self.mishap = "fell" if has_fallen else None
        self.s += on
        self._tell(t)

    def _tell(self, t: float) -> None:
        outside = 1.0 if t == OUT else 0.0
        # y stays, so that a leap across the road is not taken for motion.
        seen = {"x": 10 + self.s, "y": 20 + IN, "s": self.s, "t": t, "outside": outside}
        self.row[:] = [seen.get(name, 0.0) for name in COLUMNS]


def driven(way: list[Step], keep_driving: bool) -> tuple[Drive, Verdict]:
    def on(*_: Any) -> OnRails:
        return OnRails(way)

    with patch.object(mujoco.Vehicle, "on", on), patch.object(drive_monitor, "STUCK_TIME", PATIENCE):
        drive = MujocoSimulator().simulate(ROAD, WORLD, Sits(), seed=0, keep_driving=keep_driving)
    return drive, judge(ROAD, drive, WORLD)


def to_the_last_step_before_the_goal() -> list[Step]:
    return [(FAST, IN, False)] * 16  # 2.5 + 16 * 3 = 50.5; the goal begins at 52


@pytest.mark.parametrize("keep_driving", [False, True])
def test_a_car_that_leaves_its_lane_at_the_step_of_the_goal_has_arrived(keep_driving: bool) -> None:
    drive, verdict = driven([*to_the_last_step_before_the_goal(), (FAST, OUT, False)], keep_driving)
    assert (drive.ended, verdict.outcome, verdict.cause) == ("goal", "PASS", None)
    assert drive["outside"][-1] == 1.0
    # That step counts neither for the margin (2 m to the middle of the box) nor for the shares.
    assert verdict.margin == pytest.approx(2.0)
    assert (verdict.max_oob, drive.max_outside, verdict.oob_counter) == (0.0, 0.0, 0)
    record = consult(ROAD, drive, WORLD)
    assert not record.is_oob.any()
    assert not record.max_oob_percentage.any()
    assert record.oob_percentage[-1] == 1.0


@pytest.mark.parametrize("keep_driving", [False, True])
def test_a_car_that_leaves_its_lane_one_step_earlier_has_failed(keep_driving: bool) -> None:
    way = [*to_the_last_step_before_the_goal()[:-1], (FAST, OUT, False)]
    drive, verdict = driven(way, keep_driving)
    assert drive.ended == ("goal" if keep_driving else "out_of_lane")
    assert (verdict.outcome, verdict.cause, verdict.at_s) == ("FAIL", "out of lane", 50.5)
    assert verdict.margin == pytest.approx(-1.5)  # half of the box may be outside: its middle on the edge


@pytest.mark.parametrize("keep_driving", [False, True])
def test_a_car_that_is_stuck_at_the_step_at_which_it_leaves_its_lane_is_stuck(keep_driving: bool) -> None:
    drive, verdict = driven([(STANDS, IN, False)] * 4 + [(STANDS, OUT, False)] * 99, keep_driving)
    assert len(drive) == 1 + round(PATIENCE / 0.02)
    assert (drive.ended, verdict.cause) == ("stuck", "stuck")
    assert (verdict.margin > 0, verdict.max_oob, verdict.oob_counter) == (True, 0.0, 0)


@pytest.mark.parametrize("keep_driving", [False, True])
def test_a_car_that_falls_at_the_step_at_which_it_leaves_its_lane_left_its_lane(keep_driving: bool) -> None:
    _, verdict = driven([(FAST, IN, False)] * 4 + [(FAST, OUT, True)], keep_driving)
    assert (verdict.cause, verdict.margin) == ("out of lane", pytest.approx(-1.5))


ways = st.lists(
    st.tuples(
        st.sampled_from([FAST, STANDS]),
        st.sampled_from([IN, IN, OUT]),
        st.sampled_from([False, False, False, True]),
    ),
    max_size=30,
)


@given(ways)
def test_told_to_keep_driving_it_gets_the_same_verdict(way: list[Step]) -> None:
    once, verdict = driven(way, keep_driving=False)
    longer, on = driven(way, keep_driving=True)
    assert len(once) <= len(longer)
    for name in ("outcome", "cause", "at_s", "at_xy", "at_time", "side", "kept"):
        assert getattr(on, name) == getattr(verdict, name)
    for one in (verdict, on):
        assert (one.margin < 0) == (one.cause in ("out of lane", "fell"))
        assert math.isfinite(one.margin)
        assert (
            (one.max_oob > WORLD.limits.oob_tolerance)
            == (one.oob_counter > 0)
            == (one.cause == "out of lane")
        )
