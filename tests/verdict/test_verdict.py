"""Verdicts on drives written by hand: every number below is worked out on paper."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.drive import COLUMNS, Box, Columns, Drive
from roadgpt.errors import UsageError
from roadgpt.road import CrossSection, Limits, Road, World
from roadgpt.verdict import Verdict, consult, judge
from roadgpt.verdict.oracle import LateralExtent, allowed_overhang, margins
from staged import among, tracks

STRAIGHT = Road.through([[10, 20], [60, 20], [110, 20]])  # along +x, 100 m, y of its middle is 20
BOX = Box(4.7, 1.86)
WORLD = World().changed(oracle="thesis")


def drive_at(
    t: list[float], outside: list[float] | None = None, ended: str = "goal", turned: float = 0.0
) -> Drive:
    """A car on STRAIGHT, 5 m further at every step, at these offsets."""
    n = len(t)
    columns = {name: np.zeros(n) for name in COLUMNS}
    columns["time"] = 0.02 * np.arange(n)
    columns["s"] = 2.5 + 5.0 * np.arange(n)
    columns["x"], columns["y"] = 10 + columns["s"], 20 + np.array(t)
    columns["t"], columns["speed"] = np.array(t), np.full(n, 10.0)
    columns["heading"] = np.full(n, turned)
    columns["outside"] = np.array(outside) if outside else np.array([share(v) for v in t])
    return Drive("by hand", "paper", 0, Columns(columns), ended, BOX)  # type: ignore[arg-type]


def share(t: float) -> float:
    """Of a box that lies straight in the lane, outside it: the lane is 4 m wide, its left edge at 0."""
    right, left = t - 0.93, t + 0.93
    return max(1 - max(min(left, 0.0) - max(right, -4.0), 0.0) / (left - right), 0.0)


def test_a_car_in_the_middle_of_its_lane_passes_with_2_837_m() -> None:
    # 5 % of 1.86 m is 0.093 m: the box may go 2 + 0.93 - 0.093 m to either side
    verdict = judge(STRAIGHT, drive_at([-2.0] * 5), WORLD)
    assert verdict.kept
    assert verdict.outcome == "PASS"
    assert verdict.cause is verdict.at_s is verdict.at_xy is verdict.at_time is verdict.side is None
    assert verdict.margin == pytest.approx(2.837, abs=1e-6)
    assert verdict.max_oob == pytest.approx(0.0)
    assert verdict.oob_counter == 0
    assert verdict.sbft_description == "Successful test"
    assert (
        verdict.description
        == "kept its lane to the goal after 22 m, never less than 2.84 m sideways from failing"
    )


def test_a_car_that_goes_left_fails_where_it_first_did() -> None:
    drive = drive_at([-2.0, -0.5, 0.5, 0.9], ended="out_of_lane")
    verdict = judge(STRAIGHT, drive, WORLD)
    assert (verdict.outcome, verdict.cause, verdict.side) == ("FAIL", "out of lane", "left")
    assert not verdict.kept
    assert verdict.at_s == pytest.approx(17.5)
    assert verdict.at_xy == pytest.approx((27.5, 20.9))
    assert verdict.at_time == pytest.approx(0.06)
    assert verdict.max_oob == pytest.approx(1 - 0.03 / 1.86)
    assert verdict.margin == pytest.approx(0.837 - 0.9)  # its middle may be at +0.837
    assert verdict.description == (
        "left its lane to the left after 18 m at 36 km/h: more than 95 % of the car was outside"
    )
    assert verdict.sbft_description == "Car drove out of the lane"


def test_the_tolerance_decides_and_the_first_place_moves_with_it() -> None:
    drive = drive_at([-2.0, 0.0, 0.4, 0.95, -2.0, 0.95, -2.0])  # told to keep driving: came to the goal
    strict = judge(STRAIGHT, drive, World(limits=Limits(oob_tolerance=0.5)))
    loose = judge(STRAIGHT, drive, World(limits=Limits(oob_tolerance=0.95)))
    # at t = 0 exactly half of the box is outside, which is not above 0.5
    assert (strict.at_s, loose.at_s) == pytest.approx((12.5, 17.5))
    assert (strict.oob_counter, loose.oob_counter) == (2, 2)
    assert strict.margin == pytest.approx(-0.95)  # half of the box: its middle may be on the edge
    assert judge(STRAIGHT, drive, World(limits=Limits(oob_tolerance=1.0))).kept


def test_by_default_a_car_fails_where_more_than_half_of_it_is_outside() -> None:
    # its middle may be on the edge of the lane, which is 2 m from the middle of the lane
    assert judge(STRAIGHT, drive_at([-2.0] * 5), World()).margin == pytest.approx(2.0, abs=1e-6)
    kept = judge(STRAIGHT, drive_at([-2.0, -0.01, -2.0]), World())
    assert kept.description == (
        "kept its lane within the tolerance of 50 % to the goal after 12 m: at most 49 % of the car was "
        "outside, 0.86 m beyond the marking, 0.01 m sideways from failing"
    )
    failed = judge(STRAIGHT, drive_at([-2.0, 0.01, -2.0]), World())
    assert (failed.outcome, failed.cause, failed.at_s) == ("FAIL", "out of lane", pytest.approx(7.5))
    assert failed.description == (
        "left its lane to the left after 8 m at 36 km/h: more than half of the car was outside"
    )


def test_among_others_who_is_stuck_stood_longer() -> None:
    far = tracks(1.0, it=("car", lambda time: (-500 + 0 * time, 0 * time, 0.0)))
    verdict = judge(STRAIGHT, among(drive_at([-2.0, -2.0, -2.0], ended="stuck"), far), WORLD)
    assert verdict.description.endswith("it moved less than 1 m in 120 s")


def test_what_comes_first_decides() -> None:
    late = judge(STRAIGHT, drive_at([-2.0, 1.2, -2.0], ended="stuck"), WORLD)
    assert late.cause == "out of lane"
    assert judge(STRAIGHT, drive_at([-2.0, -2.0], ended="stuck"), WORLD).cause == "stuck"
    # at one and the same step the competition looks for the goal before it looks for the lane
    assert judge(STRAIGHT, drive_at([-2.0, 1.2], ended="goal"), WORLD).kept


@pytest.mark.parametrize(
    ("ended", "cause", "says", "sbft"),
    [
        ("fell", "fell", "fell off the road to the right after 8 m at 36 km/h", "Car drove out of the lane"),
        (
            "stuck",
            "stuck",
            "was stuck after 8 m: it moved less than 1 m in 10 s",
            "Car is not moving fast enough",
        ),
        ("timeout", "timeout", "ran out of time after 8 m of 100 m", "Timeout Simulation"),
    ],
)
def test_every_other_end_is_a_failure_with_its_cause(ended: str, cause: str, says: str, sbft: str) -> None:
    verdict = judge(STRAIGHT, drive_at([-2.0, -3.6], ended=ended), World(section=CrossSection(shoulder=0)))
    assert (verdict.outcome, verdict.cause, verdict.description) == ("FAIL", cause, says)
    assert verdict.sbft_description == sbft
    assert verdict.side == ("right" if cause == "fell" else None)
    assert verdict.at_s == pytest.approx(7.5)
    assert (verdict.margin < 0) == (cause == "fell")


def test_a_drive_ended_at_a_smaller_tolerance_cannot_be_judged_at_a_larger() -> None:
    drive = drive_at([-2.0, 0.5], ended="out_of_lane")
    with pytest.raises(
        UsageError, match=r"0\.769 of the car .* tolerance of 0\.95 allows: drive the road again"
    ):
        judge(STRAIGHT, drive, WORLD)


def test_a_verdict_survives_json() -> None:
    for verdict in (
        judge(STRAIGHT, drive_at([-2.0, 0.9], ended="out_of_lane"), WORLD),
        judge(STRAIGHT, drive_at([-2.0]), WORLD),
    ):
        assert Verdict.from_json(verdict.to_json()) == verdict
        assert verdict.to_json()["kept"] is verdict.kept
    with pytest.raises(UsageError, match="judge the drive again"):
        Verdict.from_json({"outcome": "PASS"})


def test_the_record_of_the_competition_step_by_step() -> None:
    shares = [0, 0.96, 0.99, 0.97, 0.2, 0.955, 0.953]
    drive = drive_at([-2, 0, 0, 0, -2.5, 0, 0], outside=shares, ended="timeout")
    record = consult(STRAIGHT, drive, WORLD)
    assert record.is_oob.tolist() == [False, True, True, True, False, True, True]
    assert record.oob_counter.tolist() == [0, 1, 1, 1, 1, 2, 2]
    assert record.max_oob_percentage.tolist() == [0, 0.96, 0.99, 0.99, 0.99, 0.955, 0.955]
    assert record.oob_percentage.tolist() == drive["outside"].tolist()
    assert record.oob_distance.tolist() == [2, 0, 0, 0, 1.5, 0, 0]


@given(
    angle=st.floats(0, math.pi / 2),
    tolerance=st.floats(0.01, 0.99),
)
def test_the_reach_is_where_the_share_of_a_grid_is_the_tolerance(angle: float, tolerance: float) -> None:
    a, b = 2.35 * math.sin(angle), 0.93 * math.cos(angle)
    box = LateralExtent(np.zeros(1), np.array([max(a, b)]), np.array([max(min(a, b), 1e-6)]))
    far = float(allowed_overhang(tolerance, box)[0])
    u = np.linspace(-1, 1, 801)[:-1] + 1 / 800
    across = a * u[:, None] + b * u[None, :]
    assert np.mean(across + far > 0) == pytest.approx(tolerance, abs=0.01)


@given(t=st.floats(-8, 4), tolerance=st.floats(0.5, 0.99), turned=st.floats(-0.5, 0.5))
def test_the_margin_falls_metre_by_metre(t: float, tolerance: float, turned: float) -> None:
    world = World(limits=Limits(oob_tolerance=tolerance))
    drive = drive_at([t, t + 0.01 * np.sign(t + 2)], outside=[0.0, 0.0], turned=turned, ended="timeout")
    here, there = margins(STRAIGHT, drive, world)
    assert here >= there >= 0.0
    beyond = replace(drive, columns=Columns({**drive.columns, "outside": np.ones(2)}))
    assert (margins(STRAIGHT, beyond, world) < 0).all()
