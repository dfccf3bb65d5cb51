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


def _of_grid(name: str, parameter: str) -> set[float]:
    return {float(each.values[parameter]) for each in scenario(name).points("standard", True)}


def test_grids_have_the_speeds_of_the_texts_of_un_r152() -> None:
    assert _of_grid("r152:stationary_car", "ego") == {20, 42, 60}  # 6.4, category M1, mass in running order
    assert _of_grid("r152:moving_car", "ego") == {30, 60}  # 6.5
    assert _of_grid("r152:moving_car", "target") == {20}
    assert _of_grid("r152:pedestrian", "ego") <= {20, 25, 30, 35, 40, 42, 45, 50, 55, 60}  # 5.2.2.4
    assert _of_grid("r152:pedestrian", "target") == {5}
    assert _of_grid("r152:bicycle", "ego") <= {20, 25, 30, 35, 38, 40, 45, 50, 55, 60}  # 5.2.3.4
    assert _of_grid("r152:bicycle", "target") == {15}


def test_headways_are_the_least_ones_of_un_r157() -> None:
    speeds, gaps = (7.2, 10, 20, 30, 40, 50, 60), (1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6)  # 5.2.3.3, M1
    for each in scenario("r157:follow_lead_vehicle_emergency_brake").points("standard", True):
        assert float(each.values["headway"]) == pytest.approx(
            np.interp(float(each.values["ego"]), speeds, gaps)
        )


def test_bends_and_lane_changes_ask_for_what_un_r79_says() -> None:
    """Annex 8: 80 to 90 % of the greatest lateral acceleration in 3.2.1, over 0.3 m/s2 more in 3.2.2, where
    3 m/s2 are the greatest of category M1 (5.6.2.1.3); 55 m behind (5.6.4.8.1), 5 s (5.6.4.6.5)."""
    for name, least, most in (
        ("B1_lane_keeping", 0.8 * 3, 0.9 * 3),
        ("B1_most_lateral_acceleration", 3.3, 9),
    ):
        for each in scenario(f"r79:{name}").points("standard", True):
            road = _run(str(each), drives=False).road
            assert road is not None
            s = np.arange(START, road.length - GOAL, 0.25)
            steps = np.diff(road.at(s, WORLD.profile_of(road).middle(s))[:, :2], axis=0)
            turned = np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))
            curvature = np.median((turned / np.hypot(*steps[1:].T))[turned > 1e-4])
            assert least < (float(each.values["ego"]) / 3.6) ** 2 * curvature < most
    assert min(_of_grid("r79:C_rear_vehicle", "distance")) >= 55
    assert max(_of_grid("r79:C_lane_change", "lasts")) <= 5


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
