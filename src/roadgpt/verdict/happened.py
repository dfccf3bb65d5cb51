"""Finds out why something that a scene prescribes did not happen, though the car kept its lane.

A rehearsal tells whether it happens at the prescribed speed (``traffic.rehearsal``), or a drive of the test
robot where the tested car has a script; if not, the test is INVALID. If so, the driver was not as fast as
prescribed before. It may be slower where somebody ahead whom it sees calls for that: who is no more than NEAR
seconds away at the prescribed speed and that with which it comes from the side or towards the car, or is in
its lane and no faster than the car. Then it avoided what was prescribed before that began; else that is NOT
TESTED. Slower, or faster, is by more than SLACK for LASTS seconds. These bounds are ours.
"""

import math
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.brief.scene import NEVER
from roadgpt.brief.visibility import weather_drawn
from roadgpt.drive.company import heights_along, look, looks_of
from roadgpt.drive.drive import COLUMNS
from roadgpt.network.landscape import horizon_around
from roadgpt.traffic.actor import STEP, Size
from roadgpt.traffic.rehearsal import rehearsed
from roadgpt.verdict.criteria import ROBOT
from roadgpt.verdict.measures import measure
from roadgpt.verdict.oracle import BoolArray
from roadgpt.verdict.verdict import Outcome

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

NEAR, SLACK, LASTS = 4.0, 0.1, 1.0  # s, share of the prescribed speed, s
AVOIDED = "avoided before it began"


def told(road: "Road", drive: "Drive", world: "World") -> tuple[Outcome, str]:
    """Returns the outcome of a drive in which the car kept its lane and something of the scene did not
    happen, and why."""
    missed = [each.removeprefix(f"{NEVER} ") for each in drive.missed]
    box, prescribed, would = drive.car, world.first_speed, dict[str, float]()
    if drive.driver != ROBOT and world.scene.actions:
        from roadgpt.drive import simulate

        robots = simulate(road, world, ROBOT, drive.seed, keep_driving=True)
        lacks = {_did(each.removeprefix(f"{NEVER} ")) for each in robots.missed}
        would = {did: math.inf for did in map(_did, missed) if did not in lacks}
    elif drive.driver != ROBOT:
        size = Size(box.length, box.width, 2 * box.height)
        others = rehearsed(road, world, drive.seed, size, box.ahead)
        would = others.happened if others else would
    never = [each for each in missed if _did(each) not in would]
    speed = f"{prescribed * 3.6:.0f} km/h"
    if never:
        also = f", nor would it with the test robot at {speed}" * (drive.driver != ROBOT)
        return "INVALID", f"did not happen{also}: {' and '.join(never)}"
    if world.scene.actions:
        return "NOT TESTED", f"with the test robot it happens, but not here: {' and '.join(missed)}"
    did, at = max(((_did(each), would[_did(each)]) for each in missed), key=itemgetter(1))
    if wrong := _wrong_speed(road, drive, world, at):
        return "NOT TESTED", f"{did} when a car at the prescribed {speed} has come {at:.0f} m, but {wrong}"
    return "PASS", f"{AVOIDED}: {' and '.join(missed)}"


def _did(missed: str) -> str:
    return missed.rpartition(": ")[0]


def _wrong_speed(road: "Road", drive: "Drive", world: "World", until: float) -> str:
    """Returns in words how the car was slower than prescribed up to a station though nobody called for it, or
    faster; empty if it was not."""
    time = np.arange(0.0, drive.duration + 1e-6, STEP)
    s, speed = (np.interp(time, drive["time"], drive[name]) for name in ("s", "speed"))
    off = speed / max(world.first_speed, 1e-9) - 1.0
    wrong = (np.abs(off) > SLACK) & (s <= until) & (world.first_speed > 0)
    if drive.others is not None:
        wrong &= (off > 0) | ~_is_called(road, drive, world, wrong)
    lasts = round(LASTS / STEP)
    since = np.flatnonzero(np.convolve(wrong, np.ones(lasts), "valid") > lasts - 0.5)
    if not len(since):
        return ""
    worst = speed[wrong][np.argmax(np.abs(off[wrong]))] * 3.6
    why = "slower, though nobody whom it saw called for that" if off[since[0]] < 0 else "faster"
    return f"this one was {why}: {worst:.0f} km/h, from {s[since[0]]:.0f} m on"


def _is_called(road: "Road", drive: "Drive", world: "World", where: BoolArray) -> BoolArray:
    """Returns at which of the times that are asked for somebody whom the driver sees calls for less."""
    assert drive.others is not None
    measured = measure(road, drive, world)
    along, across = np.moveaxis(measured.others.velocity, -1, 0)
    far = NEAR * (world.first_speed + np.abs(across) + np.maximum(-along, 0.0))
    is_near = (measured.others.along > measured.car.along[:, None]) & (measured.distance < far)
    calls = is_near | (np.isfinite(measured.gap) & (along < measured.car.velocity[:, :1] + 1.0))
    looks = looks_of(drive.others.actors, weather_drawn(world.scene, drive.seed))
    box = np.array([drive.car.length, drive.car.width, drive.car.ahead, drive.car.height])
    line, horizon, count = heights_along(road), horizon_around(road, world), len(looks)
    states, order, seen = np.empty((count, 5)), np.empty(count, np.int64), np.empty((count, 7))
    found = np.zeros(len(where), bool)
    for n in np.flatnonzero(where & calls.any(axis=1)):
        step = min(int(np.searchsorted(drive["time"], n * STEP - 1e-6)), len(drive) - 1)
        now, row = drive.others.at(n * STEP), np.array([drive[name][step] for name in COLUMNS])
        some = order[: look(now, now, 0.0, looks, row, box, line, horizon, states, order, seen)[0]]
        found[n] = calls[n, some].any()
    return found
