"""What becomes of a test in which something that its scene prescribes did not happen: a car on a straight
road, moved as each case says, among the actors of the scene."""

from dataclasses import replace

import numpy as np
import pytest

from roadgpt.drive import Drive
from roadgpt.road import Limits, World
from roadgpt.traffic import STEP, TestedCar, begin
from roadgpt.verdict import judge
from staged import BOX, among, driven, level

TestedCar.__test__ = False
ROAD = level(0, 600)
FASTEST = Limits(speed_limit=130 / 3.6)
LEADER = "ego v=50; car ahead gap=60 v=30: brake 2 gap=20"


def drive_of(scene: str, speeds: list[tuple[float, float]], driver: str = "me", lane: float = -2.0) -> Drive:
    """The drive of a car whose speeds in km/h at some seconds are given, up to 20 s."""
    world = World(limits=FASTEST).changed(scene=scene)
    traffic = begin(ROAD, world, 0)
    assert traffic is not None
    fine = np.arange(0.0, 20.001, 0.02)
    v = np.interp(fine, *np.transpose(speeds)) / 3.6
    x = 2.5 + np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) / 2 * 0.02)])
    for n in range(201):
        place, speed = x[5 * n], v[5 * n]
        traffic.advance(TestedCar(place, -2.0, 0.0, speed, place, -2.0, BOX.length, BOX.width))
        if place > 590:
            break
    lasts = round(n * STEP, 3)
    drive = driven(lambda time: (np.interp(time, fine, x), lane, 0.0), lasts, ROAD)
    tracks = traffic.tracks()
    return replace(among(drive, tracks), driver=driver, missed=traffic.missed)


def judged(
    scene: str, speeds: list[tuple[float, float]], driver: str = "me", lane: float = -2.0
) -> tuple[str, str]:
    drive = drive_of(scene, speeds, driver, lane)
    verdict = judge(ROAD, drive, World(limits=FASTEST).changed(scene=scene))
    return verdict.outcome, verdict.description


HALF = [(0.0, 50.0), (1.0, 25.0)]
BEHIND_IT = [(0.0, 50.0), (3.5, 50.0), (6.0, 30.0)]  # 60 m - 3.5 s * 20 km/h = 40 m; then 7 m less


@pytest.mark.parametrize(
    ("scene", "speeds", "outcome", "says"),
    [
        (LEADER, HALF, "NOT TESTED", "slower, though nobody whom it saw called for that: 25 km/h, from"),
        (LEADER, BEHIND_IT, "PASS", "avoided before it began: car 1 brakes"),
        # what cannot be seen calls for nothing: 60 m and more are left when the car slows down
        (f"fog 30; {LEADER}", [(0.0, 50.0), (2.0, 30.0)], "NOT TESTED", "30 km/h, from"),
        (f"fog 50; {LEADER}", BEHIND_IT, "PASS", "avoided before it began"),
        ("ego v=50; car behind gap=30 v=55: overtake gap=10", [(0, 50), (1, 80)], "NOT TESTED", "faster: 80"),
        # nobody can bring that about: it does not come nearer, is too far ahead, or too late
        ("ego v=50; car ahead gap=60 v=60: brake gap=20", HALF, "INVALID", "did not happen"),
        ("ego v=50; car ahead gap=900 v=40: brake gap=10", HALF, "INVALID", "did not happen"),
        ("ego v=50; car ahead gap=60 v=40: brake time=60", HALF, "INVALID", "the drive ended before"),
    ],
)  # fmt: skip
def test_what_never_happened_is_no_pass_unless_it_was_avoided(
    scene: str, speeds: list[tuple[float, float]], outcome: str, says: str
) -> None:
    found, said = judged(scene, speeds)
    assert (found, says in said) == (outcome, True), said
    if outcome == "NOT TESTED":
        assert "at the prescribed 50 km/h" in said


def test_the_test_robot_needs_no_second_drive() -> None:
    scene = "ego v=50; car ahead gap=60 v=60: brake gap=20"
    outcome, said = judged(scene, [(0.0, 50.0)], "robot")
    assert (outcome, said.count("did not happen"), "robot" in said) == ("INVALID", 1, False)


def test_a_failure_stays_one() -> None:
    outcome, said = judged(LEADER, HALF, lane=2.0)
    assert (outcome, "it never happened that car 1 brakes" in said) == ("FAIL", True)


def test_what_happened_is_not_said_to_be_missed() -> None:
    assert drive_of(LEADER, [(0.0, 50.0), (7.4, 50.0), (9.0, 5.0)]).missed == ()
    # it reverses for as long as it is on the road, and beyond its begin
    assert drive_of("ego v=0.1; car ahead gap=5 v=0: reverse to=8 time=2", [(0.0, 0.1)]).missed == ()
    twice = drive_of("ego v=50; car ahead gap=60 v=50: swerve, brake time=9, swerve time=40", [(0.0, 50.0)])
    (said,) = twice.missed
    assert said == "it never happened that car 1 swerves within its lane again: the drive ended before"
