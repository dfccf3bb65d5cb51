"""The car on roads with superelevation, beside the surface of the road and the equilibrium of forces."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from roadgpt.drive import simulate
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.driving_line import line_along
from roadgpt.drive.sampled_road import locate_on, sample_road
from roadgpt.drive.simulators.mujoco import ETK_LIKE, MujocoSimulator
from roadgpt.drive.simulators.mujoco.dynamics import FX, FY, LOAD
from roadgpt.drive.simulators.mujoco.vehicle import Vehicle
from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Limits, Road, Site, World
from roadgpt.road.profile import Profile
from roadgpt.road.speed_profile import SLOWEST, DrivingLimits, plan_speed
from roadgpt.verdict import judge

G = 9.81
WORLD = World()


def held(angle: float) -> CubicProfile:
    """The same superelevation everywhere, in radians."""
    return CubicProfile((0.0,), ((angle, 0.0, 0.0, 0.0),))


def banked_circle(radius: float, ratio: float, hand: int = 1, laps: float = 4.0) -> Road:
    """A level circle that starts at the origin along +x; a positive ratio falls to the inside."""
    length = laps * 2 * math.pi * radius
    plan = PieceCurve(0.0, 0.0, 0.0, (Piece(length, hand / radius, hand / radius),))
    level = GradeProfile(0.0, (0.0, length), (0.0, 0.0))
    profile = Profile.of(superelevation_angle=held(-hand * math.atan(ratio)))
    return Road(plan, level, profile=profile)


def twisted() -> Road:
    """A road that bends, climbs, and is inclined from 8 % on one side to 8 % on the other."""
    plan = PieceCurve(
        10.0, 20.0, 0.4, (Piece(40.0, 0.0, 0.03), Piece(50.0, 0.03, -0.03), Piece(30.0, -0.03, 0))
    )
    grades = GradeProfile(2.0, (0.0, 50.0, 90.0, 120.0), (0.0, 0.1, -0.08, -0.08))
    rows, stations = [], (0.0, 30.0, 60.0, 80.0)
    for start, end, n in ((0.0, -0.08, 30.0), (-0.08, -0.08, 30.0), (-0.08, 0.08, 20.0)):
        rows.append((start, 0.0, 3 * (end - start) / n**2, -2 * (end - start) / n**3))
    angle = CubicProfile(stations, (*rows, (0.08, 0.0, 0.0, 0.0)))
    return Road(plan, grades, profile=Profile.of(superelevation_angle=angle))


def test_the_table_is_the_surface_of_the_road() -> None:
    road = twisted()
    sampled, rng = sample_road(road), np.random.default_rng(4)
    for s, t in zip(rng.uniform(1, 119, 100), rng.uniform(-7, 7, 100), strict=True):
        x, y, z = road.at(s, t)
        found = locate_on(sampled.table, sampled.first, sampled.step, x, y, s + rng.uniform(-2, 2))
        assert found[:3] == pytest.approx((s, t, z), abs=3e-4)
        # The normal, from differences of the road's own points.
        along = (road.at(s + 1e-4, t) - road.at(s - 1e-4, t)) / 2e-4
        across = (road.at(s, t + 1e-4) - road.at(s, t - 1e-4)) / 2e-4
        normal = np.cross(along, across)
        c, n = math.cos(road.heading(s)), math.sin(road.heading(s))
        slope = -(normal[0] * c + normal[1] * n) / normal[2]
        lateral = -(normal[1] * c - normal[0] * n) / normal[2]
        assert found[3:5] == pytest.approx((slope, lateral), abs=2e-3)


class Steady(dict):
    """Mean values of a car that is held in the middle of the road on a circle, at one speed."""

    def __init__(self, radius: float, ratio: float, speed: float, hand: int = 1) -> None:
        road = banked_circle(radius, ratio, hand)
        car = Vehicle.on(road, WORLD)
        car.put(20.0, 0.0, speed)
        # Steering that brings the car back to the middle at 1 rad/s, critically damped.
        reach, drift, pull, rows = 2.83 + 0.0025 * speed**2, 0.0, 0.0, []
        for step in range(1000):
            seen = car.see()
            turned = math.remainder(seen["heading"] - float(road.heading(seen["s"])), math.tau)
            drift += 0.02 * 0.3 * seen["t"] / speed**2
            steer = reach * (hand / radius - seen["t"] / speed**2 - 2 * turned / speed - drift)
            pull += 0.02 * 0.3 * (speed - seen["speed"])
            pedal = 0.6 * (speed - seen["speed"]) + pull
            car.move(steer, min(max(pedal, 0.0), 1.0), min(max(-pedal, 0.0), 1.0))
            if step >= 750:
                rows.append(self._row(car, radius, hand))
        values = np.array(rows)
        super().__init__(zip(("force", "load", "speed", "radius"), values.mean(axis=0), strict=True))
        self.spread = float(values[:, 0].std())

    @staticmethod
    def _row(car: Vehicle, radius: float, hand: int) -> tuple[float, ...]:
        seen, wheels = car.see(), car.wheels
        inside = math.atan2(hand * radius - seen["y"], -seen["x"])
        tangent = math.tan(seen["steer"])  # Ackermann: both front axles point at the centre of the turn
        turned = [math.atan(tangent / (1 - side * tangent * 0.79 / 2.83)) for side in (1, -1)]
        off = seen["heading"] + np.array([*turned, 0.0, 0.0]) - inside
        force = (wheels[:, FX] * np.cos(off) - wheels[:, FY] * np.sin(off)).sum()
        return force, wheels[:, LOAD].sum(), seen["speed"], math.hypot(seen["x"], seen["y"] - hand * radius)


CASES = [
    (radius, ratio, share, hand)
    for radius, hand in ((25, 1), (250, -1))
    for ratio, share in ((-0.08, 0.55), (0.08, 0.15), (0.08, 0.55))
]


def test_the_tyres_carry_what_the_bank_leaves_them() -> None:
    """m g (v^2 / (g R) cos e - sin e) across the road, m g (cos e + v^2 / (g R) sin e) onto it."""
    worst, weight = 0.0, ETK_LIKE.mass * G
    for radius, ratio, share, hand in CASES:
        seen = Steady(radius, ratio, math.sqrt(share * G * radius), hand)
        bend, e = seen["speed"] ** 2 / (G * seen["radius"]), math.atan(ratio)
        across = weight * (bend * math.cos(e) - math.sin(e))
        assert seen.spread < 0.01 * weight, (radius, ratio, share)  # it is steady
        worst = max(worst, abs(seen["force"] / across - 1))
        assert seen["force"] == pytest.approx(across, rel=0.02), (radius, ratio, share)
        assert seen["load"] == pytest.approx(weight * (math.cos(e) + bend * math.sin(e)), rel=0.002)
    print(f"largest error of the lateral force over {len(CASES)} bends: {100 * worst:.2f} %")


def banked_straight(angle: float) -> Road:
    plan = PieceCurve(0.0, 0.0, 0.0, (Piece(120.0, 0.0, 0.0),))
    level = GradeProfile(0.0, (0.0, 120.0), (0.0, 0.0))
    return Road(plan, level, profile=Profile.of(4, 4, superelevation_angle=held(angle)))


def inclined(angle: float, t: float = 0.0, **world: float) -> Vehicle:
    car = Vehicle.on(banked_straight(angle), World().changed(**world))
    car.put(60.0, t)
    return car


@pytest.mark.parametrize("ratio", [-0.08, 0.08])
def test_a_parked_car_stays_on_the_bank(ratio: float) -> None:
    car = inclined(math.atan(ratio))
    before = car.see()
    assert math.tan(before["roll"]) == pytest.approx(ratio, abs=0.015)  # and it leans a little outwards
    assert car.wheels[:, LOAD].sum() == pytest.approx(
        ETK_LIKE.mass * G * math.cos(math.atan(ratio)), rel=1e-3
    )
    for _ in range(500):
        car.move(0.0, 0.0, 1.0)
    after = car.see()
    assert math.hypot(after["x"] - before["x"], after["y"] - before["y"]) < 1e-3
    assert abs(after["t"]) < 0.02


def test_what_slides_gains_speed_by_the_force_that_is_left() -> None:
    angle = math.atan(0.08)
    car = inclined(angle, t=15.0, friction=0.02)
    rows = []
    for _ in range(400):
        car.move(0.0, 0.0, 1.0)
        rows.append((car.see()["time"], car.see()["speed"], abs(car.wheels[:, FY].sum())))
    time, speed, force = np.array([row for row in rows if row[1] > 1.0]).T
    left = G * math.sin(angle) - force.mean() / ETK_LIKE.mass
    assert np.polyfit(time, speed, 1)[0] == pytest.approx(left, rel=0.02)


def curve(bank: object, speed: float = 16.0) -> tuple[Road, World]:
    plan = PieceCurve(
        0.0,
        0.0,
        0.0,
        (
            Piece(60, 0, 0),
            Piece(30, 0, 1 / 60),
            Piece(60, 1 / 60, 1 / 60),
            Piece(30, 1 / 60, 0),
            Piece(50, 0, 0),
        ),
    )
    world = World(site=Site(map_size=500), limits=Limits(speed_limit=30.0), section=CrossSection(bank=bank))
    return world.lay(Road(plan, GradeProfile(0.0, (0.0, plan.length), (0.0, 0.0)))), world


@pytest.mark.parametrize("driver", ["reference", "pure_pursuit", "beamng_like"])
def test_drivers_take_a_banked_bend_faster(driver: str) -> None:
    fastest = {}
    for bank in ("none", "auto", 0.08):
        road, world = curve(bank)
        drive = simulate(road, world, driver, keep_driving=True)
        assert drive.ended == "goal"
        there = (drive["s"] > 95) & (drive["s"] < 145)
        fastest[bank] = float(drive["speed"][there].mean())
        if driver == "reference":
            assert judge(road, drive, world).max_oob == 0
            assert np.abs(drive["t"][there] + 2.0).max() < 0.4
    assert fastest["none"] < fastest["auto"] < fastest[0.08]
    # CD 109 gives a bend of 60 m its most, 7 %. The friction circle with 0.6 g lets 8 % gain as much:
    most = math.sqrt((0.6 + 0.08) / (1 - 0.6 * 0.08) / 0.6)
    assert fastest[0.08] / fastest["none"] < 1.01 * most


def test_the_drive_says_where_the_car_is_on_the_surface() -> None:
    road, world = curve(0.08)
    drive = MujocoSimulator().simulate(road, world, Reference(), 0, keep_driving=True)
    for step in range(0, len(drive), 25):
        s, t = float(drive["s"][step]), float(drive["t"][step])
        centre = np.array([drive[name][step] for name in "xyz"])
        foot, side = road.at(s, t), road.at(s, t + 1.0) - road.at(s, t)
        assert side @ (centre - foot) == pytest.approx(0.0, abs=2e-3)  # a right angle across the road
        assert np.linalg.norm(centre - foot) == pytest.approx(0.56, abs=0.06)


@pytest.mark.parametrize("ratio", [-0.12, -0.03, 0.0, 0.08])
@pytest.mark.parametrize(
    ("radius", "grip", "hand"), [(30, 0.64, 1), (80, 0.3, -1), (200, 0.64, -1), (60, 0.15, 1)]
)
def test_the_planned_speed_uses_all_of_the_grip(ratio: float, radius: float, grip: float, hand: int) -> None:
    """Beside the root of the balance of forces on an inclined plane."""
    road = banked_circle(radius, ratio, hand)
    limits = DrivingLimits(grip, 5.0, 5.0, 200.0, power=1e9)
    speed = plan_speed(line_along(road, 0.0), limits)[200]
    e = math.atan(ratio)

    def spare(v: float) -> float:
        inwards = v * v / radius
        return grip * (G * math.cos(e) + inwards * math.sin(e)) - (inwards * math.cos(e) - G * math.sin(e))

    if spare(SLOWEST) <= 0:  # the bank alone needs more than the grip
        assert speed == SLOWEST
    else:
        assert speed == pytest.approx(brentq(spare, SLOWEST, 300.0), rel=1e-9)


def test_braking_for_a_tighter_bend_gets_what_the_bank_spares() -> None:
    ends = {}
    for ratio in (0.0, 0.08):
        line = line_along(banked_circle(100.0, ratio), 0.0)
        at, e = len(line.grade) // 2, math.atan(ratio)
        curvature = [*line.curvature[:at], *[0.05] * (len(line.curvature) - at)]
        plan = plan_speed(replace(line, curvature=curvature), DrivingLimits(0.6, 0.6, 0.6, 50.0, power=1e9))
        v, after = plan[at - 1], plan[at]
        slowed = (v * v - after * after) / (2 * line.step)
        load = G * math.cos(e) + after * after / 100 * math.sin(e)
        across = after * after / 100 * math.cos(e) - G * math.sin(e)
        assert math.hypot(slowed, across) == pytest.approx(0.6 * load, rel=1e-6)
        ends[ratio] = after
    assert ends[0.08] > ends[0.0]
