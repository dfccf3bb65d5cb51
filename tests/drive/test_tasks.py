"""Drivers that do themselves what a scene tells the car; what they did is told from the columns alone."""

import numpy as np
import pytest

from roadgpt.drive import simulate
from roadgpt.drive.drivers.reference import Reference
from roadgpt.errors import DriverError
from roadgpt.run import Setup, perform
from roadgpt.verdict import judge

ROAD = "straight 600 | lanes=2 map_size=700 && "


class Obeys(Reference):
    """Changes the speed as it is told; changes lanes because ``start`` gives it its new lane."""

    name, follows = "obeys", ("speed", "brake", "stop", "change_lane")
    seen = ()

    def steer(self, view):
        command, task = super().steer(view), view.task
        self.seen = (*self.seen, task)
        if task is None or not task.has_begun or "to" not in task.numbers:
            return command
        to, most = task.numbers["to"], task.numbers["accel"]
        wanted = min(max(2 * (to - view.vx), -most), most)
        if to == 0 and view.vx < 0.3:
            wanted = -3.0
        return command._replace(throttle=min(max(wanted, 0) / 4, 1), brake=max(-wanted, 0) / 9)


class Ignores(Reference):
    """Says that it follows, and goes on in its first lane, as fast as it is."""

    name, follows = "ignores", Obeys.follows
    begun = False

    def start(self, road, world, seed):
        if not self.begun:
            super().start(road, world, seed)
        self.begun = True


def drive(does, driver, scene=ROAD):
    run = perform(scene + does, 1, setup=Setup(reader="plan", drives=False))
    assert run.is_valid, run.description
    found = simulate(run.road, run.world, driver, 1)
    return run, found, judge(run.road, found, run.world)


@pytest.mark.parametrize(
    ("does", "what"),
    [
        ("ego v=50: speed 70 s=60", "speed"),
        ("ego v=50: brake 4 to=20 s=60", "brake"),
        ("ego v=50: change_lane left s=60", "change_lane"),
    ],
)
def test_a_driver_does_what_it_follows_itself_or_fails(does, what):
    driver = Obeys()
    run, made, verdict = drive(does, driver)
    assert verdict.outcome == "PASS", verdict.description
    assert not made.handovers
    assert {each.what for each in driver.seen if each} == {what}
    (event,) = verdict.events
    assert event.who == "tested car"
    assert 3.0 < event.time < event.until
    assert {each.has_begun for each in driver.seen if each} == {False, True}
    speed, t = made["speed"] * 3.6, made["t"]
    if what == "speed":
        assert speed.max() > 68.0
    elif what == "brake":
        assert 17.0 < speed[made["time"] > 1.0].min() < 22.0
    else:
        width = float(run.world.profile_of(run.road).width(100.0))
        assert np.ptp(t) == pytest.approx(width, abs=0.4)
    _, made, verdict = drive(does, Ignores())
    assert (verdict.outcome, verdict.cause) == ("FAIL", "task"), verdict.description
    assert "did not do what it was told" in verdict.description
    assert {"speed": "changes its speed", "brake": "brakes", "change_lane": "changes lane"}[
        what
    ] in verdict.description
    assert not made.handovers


def test_without_follows_the_script_does_it_and_nobody_has_a_task():
    class Watches(Obeys):
        follows = ()

    driver = Watches()
    _, made, verdict = drive("ego v=50: brake 4 to=20 s=60", driver)
    assert {*driver.seen} == {None}
    assert made.handovers
    assert not made.tasks
    assert verdict.outcome == "PASS", verdict.description


def test_tasks_are_kept_in_files(tmp_path):
    _, made, _ = drive("ego v=50: change_lane left s=60", Obeys())
    (tmp_path / "drive.npz").write_bytes(made.to_bytes())
    assert type(made).load(tmp_path / "drive.npz").tasks == made.tasks != ()


def test_what_cannot_be_a_task_is_refused_by_name():
    class Wants(Obeys):
        follows = ("fly",)

    with pytest.raises(DriverError, match="cannot follow fly; name some of speed"):
        drive("ego v=50: brake 4 to=20 s=60", Wants())
