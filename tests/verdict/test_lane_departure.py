"""A PASS says how far outside the car was, and a lane departure is a failure where it is asked for."""

import numpy as np
import pytest

from roadgpt.drive import simulate
from roadgpt.drive.drivers.beamng_like import BeamngLike
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.lane_position import MarkingMonitor
from roadgpt.road import Limits, World
from roadgpt.verdict import consult, judge
from roadgpt.verdict.oracle import margins
from verdict.test_verdict import STRAIGHT, WORLD, drive_at
from verdict.test_verdict_simulated import ROADS, NeverSteers

WATCHED = World(limits=Limits(lane_departure=True))


@pytest.mark.parametrize(
    ("t", "beyond"),
    [
        (-2.0, 0.0),
        (-3.07, 0.0),  # 0.93 m of body end at the lane's right edge
        (-3.6, 0.53),
        (-0.9, 0.0),  # 3 cm over the middle of the road, on the centre line of 12 cm
        (-0.5, 0.37),
    ],
)
def test_the_body_is_beyond_the_outer_edge_of_a_marking(t: float, beyond: float) -> None:
    assert judge(STRAIGHT, drive_at([-2.0, t, -2.0]), WORLD).beyond == pytest.approx(beyond, abs=1e-6)


def test_a_pass_that_was_partly_outside_says_so() -> None:
    verdict = judge(STRAIGHT, drive_at([-2.0, -4.22, -2.0]), WORLD)
    assert verdict.kept
    assert verdict.severity == "mostly outside"
    assert verdict.description == (
        "kept its lane within the tolerance of 95 % to the goal after 12 m: at most 62 % of the car was "
        "outside, 1.15 m beyond the marking, 0.62 m sideways from failing"
    )
    on_the_line = judge(STRAIGHT, drive_at([-2.0, -0.9, -2.0]), WORLD)
    assert "at most 2 % of the car was outside, on the marking" in on_the_line.description
    assert on_the_line.severity == "at most 10 % outside"
    inside = judge(STRAIGHT, drive_at([-2.0, -2.5, -2.0]), WORLD)
    assert inside.severity == "at most 10 % outside"
    assert "outside" not in inside.description


def test_a_front_tyre_beyond_the_marking_is_a_departure_and_the_body_is_not() -> None:
    # body 0.93 m to its side, tyres 0.9025 m; the centre line's far edge lies 0.06 m beyond the middle
    for t, fails in ((-3.09, False), (-3.10, True), (-0.85, False), (-0.84, True)):
        drive = drive_at([-2.0, t, -2.0])
        assert judge(STRAIGHT, drive, WATCHED).kept == (not fails)
        assert judge(STRAIGHT, drive, WORLD).kept
        record = consult(STRAIGHT, drive, WATCHED)
        assert record.is_oob.tolist() == [False, fails, False]
        assert record.oob_counter[-1] == fails


def test_a_departure_is_told_with_its_place_side_and_reason() -> None:
    verdict = judge(STRAIGHT, drive_at([-2.0, -3.2], ended="out_of_lane"), WATCHED)
    assert (verdict.outcome, verdict.cause, verdict.side) == ("FAIL", "out of lane", "right")
    assert verdict.description == (
        "left its lane to the right after 8 m at 36 km/h: a front tyre passed the marking"
    )
    assert verdict.margin == pytest.approx(4 - 3.2 - 0.9025)
    kept = judge(STRAIGHT, drive_at([-2.0, -3.09, -2.0]), WATCHED)
    assert kept.description == (
        "kept its front tyres within the markings to the goal after 12 m: at most 1 % of the car was "
        "outside, 0.02 m beyond the marking, 0.01 m sideways from failing"
    )
    assert kept.margin == pytest.approx(4 - 3.09 - 0.9025)


def test_the_margin_is_the_distance_to_a_departure() -> None:
    for t in np.linspace(-3.0, -1.0, 9):
        drive = drive_at([t] * 3, ended="timeout")
        margin = margins(STRAIGHT, drive, WATCHED)[0]
        for aside, fails in ((margin - 0.001, False), (margin + 0.001, True)):
            moved = drive_at([t + np.sign(t + 1.97) * aside] * 3, ended="timeout")
            assert consult(STRAIGHT, moved, WATCHED).is_oob.any() == fails


def test_a_drive_ends_where_a_tyre_departs_and_goes_on_where_it_is_told_to() -> None:
    for road in ROADS:
        for driver in (BeamngLike, NeverSteers):
            once = simulate(road, WATCHED, driver())
            verdict = judge(road, once, WATCHED)
            assert (once.ended, verdict.cause) == ("out_of_lane", "out of lane")
            beyond = MarkingMonitor.for_tyres(road, WATCHED, once.car).along(once)
            assert (beyond[:-1] <= 0).all()
            assert 0 < beyond[-1] < 0.1
            assert verdict.margin < 0
            on = simulate(road, WATCHED, driver(), keep_driving=True)
            later = judge(road, on, WATCHED)
            assert len(on) > len(once)
            assert (later.cause, later.at_s, later.side) == (verdict.cause, verdict.at_s, verdict.side)
        middle = simulate(road, WATCHED, Reference())
        assert judge(road, middle, WATCHED).kept
