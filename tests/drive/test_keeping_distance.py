"""Drivers among others: the distance that they keep, and for whom they brake. Gaps are those of the published
formula; others are functions of time."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from roadgpt import plugins
from roadgpt.drive import Command, Drive, View, simulate
from roadgpt.drive.keeping_distance import KeepingDistance
from roadgpt.drive.path_ahead import look_ahead
from roadgpt.geometry.boxes import corners
from roadgpt.network import is_route
from roadgpt.road import Limits, Road, World
from roadgpt.run import Run, Setup, perform
from roadgpt.traffic import SIZES, Tracks
from roadgpt.traffic.lights import Lights
from roadgpt.verdict import judge
from staged import straight, tracks

V = 20.0
WORLD = World(limits=Limits(speed_limit=V))
ROAD = Road.through([[0, 0, 0], [300, 0, 0], [500, 0, 0]])
LANE, FRONT = -2.0, 2.25
DRIVERS = ("beamng_like", "lane_centring", "pure_pursuit", "reference")


@cache
def alone(driver: str) -> Drive:
    """A drive with somebody who is far away, so that the car rolls at the start."""
    return simulate(ROAD, WORLD, driver, replay=tracks(1.0, barrier=("barrier", straight(450, -90, 0, 0))))


def is_between(gap: float, left: float, v: float, walks: float) -> bool:
    """Whether an adult, ``left`` metres beside a strip of 2.26 m, is in it while the car of 5 m comes to
    it and passes, or within half a second of that: every centisecond, one after another."""
    t, half = np.arange(0.0, 30.0, 0.01), SIZES["adult"].width / 2
    y = 1.13 + left + half - walks * t
    front = v * t - gap
    there, here = np.abs(y) < 1.13 + half, (front >= 0) & (front <= 5.0 + 2 * half)
    times, others = t[there], t[here]
    return bool(times[0] <= others[-1] + 0.5 and others[0] <= times[-1] + 0.5)


@settings(max_examples=60, deadline=None)
@given(st.floats(3, 45), st.floats(0.2, 4), st.floats(4, 20), st.floats(1, 2.5), st.booleans())
def test_one_who_walks_into_the_path_counts_only_if_both_come_there_at_a_time(
    gap: float, left: float, v: float, walks: float, is_right: bool
) -> None:
    assume(left < 3 * walks)
    known = {is_between(gap * a, left, v * b, walks) for a in (0.94, 1.06) for b in (0.97, 1.03)}
    assume(len(known) == 1)
    side, (length, width) = -1 if is_right else 1, (SIZES["adult"].width,) * 2
    x = np.arange(0.0, 100.0, 0.5)
    path = np.column_stack([x, np.zeros((len(x), 2))])
    place = (1.13 + left + width / 2) * side
    adult = np.array([[10 + FRONT + gap + length / 2, place, -side * np.pi / 2, walks, length, width, 0.0]])
    found = look_ahead(path, 10.0, adult, np.array([10.0, 0, 0, v, FRONT]), np.array([1.5, 1.5, 2.0]))[0]
    assert np.isfinite(found[0]) == known.pop()
    assert found[0] in (np.inf, pytest.approx(gap, abs=1e-6))


def gaps(drive: Drive, others: Tracks, kind: str) -> np.ndarray:
    rear = others.at(drive["time"])[:, 0, 0] - SIZES[kind].length / 2
    return np.asarray(rear - drive["x"] - FRONT)


@pytest.mark.parametrize(("driver", "v"), [("reference", 6.0), *((driver, 13.0) for driver in DRIVERS)])
def test_behind_an_even_leader_the_gap_is_that_of_the_published_formula(driver: str, v: float) -> None:
    others = tracks(60.0, van=("van", straight(60, LANE, 0, v)))
    end = 60 + 34 * v  # 34 s after the start the van is at the end
    drive = simulate(Road.through([[0, 0, 0], [end / 2, 0, 0], [end, 0, 0]]), WORLD, driver, replay=others)
    followed = (drive["time"] > 28.0) & (drive["time"] < 32.0)
    # Treiber, Hennecke, Helbing (2000), equation 4, where the acceleration and the change of the gap are 0
    assert gaps(drive, others, "van")[followed] == pytest.approx(2.0 + 1.5 * v, abs=0.3)
    assert drive.ended == "goal"


@pytest.mark.parametrize(
    ("driver", "kind", "y", "heading"),
    [("reference", "truck", LANE, 0.0), *((driver, "car", LANE - 2.3, 0.3) for driver in DRIVERS)],
)
def test_the_car_stops_behind_who_stands_in_its_path(
    driver: str, kind: str, y: float, heading: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("roadgpt.drive.drive_monitor.STUCK_AMONG_OTHERS", 20.0)
    others = tracks(1.0, other=(kind, straight(200, y, heading, 0)))
    drive = simulate(ROAD, WORLD, driver, replay=others)
    assert drive.ended == "stuck"
    box = shapely.Polygon(corners(others.states[0, 0, :2], others.states[0, 0, 3], np.array(SIZES[kind])))
    strip = shapely.box(0, LANE - 0.93, 900, LANE + 0.93)
    assert 1.0 < box.intersection(strip).bounds[0] - drive["x"][-1] - FRONT < 4.0
    assert drive["speed"][-500:].max() < 0.02  # it does not creep


@pytest.mark.parametrize("driver", DRIVERS)
def test_nobody_brakes_for_who_is_beside_the_path(driver: str) -> None:
    oncoming = {
        f"{kind}_{n}": (kind, straight(300 + 90 * n, 2.0, np.pi, 18.0))
        for n, kind in enumerate(["truck", "car", "van", "bus"] * 3)
    }
    parked = {f"car_{n}": ("car", straight(20 * n - 240, LANE - 2.4, 0, 0)) for n in range(20, 40)}
    walker = {"adult_9": ("adult", straight(100, LANE - 3, 0, 1.4))}
    drive = simulate(ROAD, WORLD, driver, replay=tracks(60.0, **oncoming, **parked, **walker))
    for name in ("speed", "brake", "throttle", "steer", "t"):
        assert drive[name].tolist() == alone(driver)[name].tolist()


@pytest.mark.parametrize(
    ("driver", "kind"),
    [*((driver, "adult") for driver in DRIVERS), ("reference", "bicycle"), ("reference", "animal")],
)
def test_the_car_lets_pass_who_crosses_and_goes_on(driver: str, kind: str) -> None:
    speed = {"adult": 1.5, "bicycle": 4.0, "animal": 3.0}[kind]
    arrival = float(np.interp(200, alone(driver)["x"], alone(driver)["time"]))
    across = straight(200, LANE - speed * arrival, np.pi / 2, speed)
    drive = simulate(ROAD, WORLD, driver, replay=tracks(60.0, other=(kind, across)))
    assert drive.ended == "goal"
    assert drive.duration > alone(driver).duration + 0.5


def test_cruise_control_brakes_within_its_standard_and_an_emergency_harder() -> None:
    slower = simulate(ROAD, WORLD, "lane_centring", replay=tracks(60, car=("car", straight(120, LANE, 0, 8))))
    assert 1.0 < -slower["ax"].min() < 3.5 + 0.3
    for ahead, speed in ((30.0, 2.0), (15.0, 0.5)):
        late = straight(200, LANE - 1.7 - speed * (200 - ahead - FRONT) / V, np.pi / 2, speed)
        drive = simulate(ROAD, WORLD, "lane_centring", replay=tracks(60, adult=("adult", late)))
        assert -drive["ax"].min() > 5.0


@pytest.mark.parametrize(
    ("kind", "kmh", "most"), [("adult", 20, 0), ("adult", 40, 0), ("bicycle", 40, 0), ("adult", 60, 35)]
)
def test_emergency_braking_meets_its_standard(kind: str, kmh: float, most: float) -> None:
    """UN R152, 02 series, cars in running order: who crosses at 5 or 15 km/h and would be hit in the middle
    of the front is hit with these km/h at most. Nobody at the wheel reacts."""
    world = World(limits=Limits(speed_limit=V)).changed(scene=f"ego robot v={kmh}")
    speed = (15 if kind == "bicycle" else 5) / 3.6
    crossing = straight(200, LANE - speed * (200 - FRONT) / (kmh / 3.6), np.pi / 2, speed)
    drive = simulate(ROAD, world, "lane_centring", replay=tracks(60.0, other=(kind, crossing)))
    assert -drive["ax"].min() > 5.0
    hit = judge(ROAD, drive, world).first_contact
    assert (3.6 * hit.speed if hit else 0.0) <= most
    assert hit or drive.ended == "goal"


class Watched:
    """A driver whose views are kept."""

    def __init__(self, name: str) -> None:
        self.driver = plugins.find("drivers", name)()
        self.start, self.views = self.driver.start, list[View]()

    def steer(self, view: View) -> Command:
        self.views.append(view)
        return Command(*self.driver.steer(view))


@cache
def crossing_with_lights() -> Run:
    world = World(limits=Limits(speed_limit=50 / 3.6))
    plan = "straight 160 // crossroads straight lights // straight 60 && light"
    return perform(plan, 3, world, Setup(reader="plan", drives=False))


GREEN, RED, LATE_YELLOW = 0, 1, 52  # seeds


@pytest.mark.parametrize(
    ("driver", "seeds"),
    [
        (driver, (GREEN, RED, LATE_YELLOW) if driver == "reference" else (RED, LATE_YELLOW))
        for driver in DRIVERS
    ],
)
def test_the_car_stops_before_the_line_at_red_and_passes_it_at_green_or_late_yellow(
    driver: str, seeds: tuple[int, ...]
) -> None:
    run = crossing_with_lights()
    assert is_route(run.road)
    route, world = run.road, run.world
    (way,) = route.passages
    line = way.start - 0.5  # the stop line is 0.5 m wide and lies next to the junction: German RMS-1
    stopped = 0
    for seed in seeds:
        watched, lights = Watched(driver), Lights(route.network, seed)
        simulate(route, world, watched, seed)
        before = [view for view in watched.views if view.s + FRONT < line]
        for view in before:
            (seen,) = view.lights
            assert seen.distance == pytest.approx(line - view.s, abs=0.01)
            assert seen.shows == ("green", "yellow", "red")[lights.shown(way.arrival, view.time)]
        assert all(not view.lights for view in watched.views if view.s > line)
        assert len(before) < len(watched.views)  # it goes on
        last = before[-1]
        assert last.lights[0].shows != "red"
        if last.lights[0].shows == "yellow":
            began = max(n for n, view in enumerate(before) if view.lights[0].shows == "green") + 1
            assert before[began].speed ** 2 / 2 / (line - before[began].s - FRONT) > 3.0
        stands = [line - view.s - FRONT for view in before if view.speed < 0.05]
        assert all(0.3 < left < 2.0 for left in stands)
        stopped += bool(stands)
    assert 0 < stopped < len(seeds)
    assert last.lights[0].shows == "yellow"


def test_further_lights_that_come_into_sight_change_nothing_at_the_first() -> None:
    """A car that could stop at 2 m/s2 when its lights became yellow goes on to stop, though it is late."""
    seen = [(30.0, 10.0, ((30.0, "yellow"),)), (48.0, 9.0, ((12.0, "yellow"), (80.0, "red")))]
    for begins in (0, 1):
        keeping, stops = KeepingDistance(None), list[float]()
        for s, speed, lights in seen[begins:]:
            stops = keeping._to_stop_at(SimpleNamespace(s=s, speed=speed, lights=lights))
        assert stops == ([12.0, 80.0] if begins == 0 else [80.0])
