"""What is prescribed of each scenario against what happens before a tested car that keeps its lane
and its speed, up to the event: measured from tracks, prescribed by the numbers in ``prescribed.py``."""

from itertools import groupby
from types import SimpleNamespace

import numpy as np
import pytest
from shapely import Polygon

from boxed import corners
from measured import Measured
from prescribed import OF_ROBOT, PRESCRIBED, Row
from roadgpt.brief.plan import read_plan
from roadgpt.brief.scenarios import LANE_WIDTH, scenario, scenarios
from roadgpt.road import World
from roadgpt.road.road import GOAL, START
from roadgpt.run import Run, Setup, perform
from roadgpt.traffic import STEP, Actor, TestedCar, begin
from staged import BOX

TestedCar.__test__ = False
BY_POINT = {name: [*rows] for name, rows in groupby((*PRESCRIBED, *OF_ROBOT), lambda row: row.scenario)}
WORLD = World().changed(lane_width=LANE_WIDTH, map_size=1200)
FARTHEST = [
    name
    for name in dict.fromkeys(row.scenario for row in PRESCRIBED)
    if not any(each.startswith(f"{name} ") for each in BY_POINT)
]
"""Not at nominal values where ends of a grid are prescribed: ``test_scenarios.py`` compares those values."""
DRIVEN = (
    "ncap:CBLA", "r157:cut_in", "leaderboard:crossing_after_turn", "ncap:ELK_RE ego=90 lateral_speed=0.6",
    "ncap:CC_ELK_On lateral_speed=0.3", "ncap:CPMFC", "ncap:ACC_cut_out",
    "r157:lane_change lane=right ego=130", "r152:false_reaction_cars", "nhtsa:maneuver_opposite_direction",
)  # fmt: skip
"""Of those that came later, and of a few others; benchmarks/bench_scenarios.py has all."""


def test_something_is_prescribed_of_each() -> None:
    assert {*scenarios()} <= {*BY_POINT}
    assert all(row.tolerance > 0 for row in PRESCRIBED)


@pytest.mark.parametrize("name", FARTHEST)
def test_what_happens_is_what_is_prescribed(name: str) -> None:
    assert not _wrong(name, Measured(_rehearsal(name)))


@pytest.mark.parametrize("name", DRIVEN)
def test_what_the_test_robot_drives_is_what_is_prescribed(name: str) -> None:
    assert not _wrong(name, Measured(_run(name)))


def _wrong(name: str, measured: Measured) -> dict[tuple[int, str], tuple[float, Row]]:
    found = {
        (row.who, row.what): (getattr(measured, row.what)(row.who, row.want), row) for row in BY_POINT[name]
    }
    return {key: (value, row) for key, (value, row) in found.items() if abs(value - row.want) > row.tolerance}


def _run(name: str, drives: bool = True) -> Run:
    setup = Setup(driver="robot", reader="plan", scenario=name, drives=drives)
    return perform(read_plan(scenario(name).plan), 1, WORLD, setup)


class _Columns(dict[str, np.ndarray]):
    """A drive as far as it is measured."""

    car, others = BOX._replace(ahead=0.0), None


def _rehearsal(name: str) -> SimpleNamespace:
    """The others of a scenario, and a tested car in the middle of its lane at the prescribed speed, until 1 s
    after it first touches somebody, or, so that brakings end, 5 s; or else 20 s after everything has begun.
    """
    run = _run(name, drives=False)
    road, world = run.road, run.world
    assert road is not None, run.description
    stations = np.arange(START, road.length - GOAL, 0.25)
    middle = world.profile_of(road).middle(stations)
    lane = road.at(stations, middle)[:, :2]
    metres = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(lane, axis=0).T))])
    heading = np.unwrap(np.arctan2(*np.gradient(lane, axis=0).T[::-1]))
    time = np.arange(0.0, metres[-1] / world.first_speed, STEP)
    columns = [np.interp(time * world.first_speed, metres, each) for each in (*lane.T, heading)]
    places = [np.interp(time * world.first_speed, metres, each) for each in (stations, middle)]
    traffic, ends = begin(road, world, 1), np.inf
    for now, x, y, turned, s, t in zip(time, *columns, *places, strict=True):
        if now > ends or traffic is None:
            break
        car = TestedCar(x, y, turned, world.first_speed, s, t, BOX.length, BOX.width)
        traffic.advance(car)
        boxes = zip(traffic.around(now)[0], traffic.actors, strict=True)
        if np.isinf(ends) and not traffic.missed:
            ends = now + 20.0
        if any(_touch(car, *each) for each in boxes):
            ends = min(ends, now + 4.0 * any(row.what == "to" for row in BY_POINT[name]) + 1.0)
    columns = [time, *columns, np.full(len(time), world.first_speed)]
    columns = _Columns(zip(("time", "x", "y", "heading", "speed"), columns, strict=True))
    columns.others = traffic and traffic.tracks()
    return SimpleNamespace(drive=columns, road=road, world=world)


def _touch(car: TestedCar, state: np.ndarray, actor: Actor) -> bool:
    if not np.hypot(*(state[:2] - car[:2])) < 10.0:
        return False
    own = corners(np.array([car.x, car.y, 0.0, car.heading]), BOX)
    return bool(Polygon(own).intersects(Polygon(corners(state, actor.size))))
