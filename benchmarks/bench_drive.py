"""How fast and how right the car drives: speed per core, manoeuvres, and the table beside CommonRoad.

    python benchmarks/bench_drive.py [ROADS]

Speeds are simulated seconds per CPU second of this process, the driver in Python included, after compiling.
"""

import math
import sys
import time

import numpy as np

import multibody
from roadgpt.drive import Command, Drive, View, simulate
from roadgpt.drive.simulators.mujoco import ETK_LIKE, plane
from roadgpt.road import Design, Road, Segment, World, build

ROADS = int(sys.argv[1]) if sys.argv[1:] else 30
REPEATS = 3


class Pursuit:
    """Steers at a point ahead in its lane and holds 40 km/h: what a small driver in Python costs."""

    def start(self, road: Road, _world: World, _seed: int) -> None:
        step = 0.5
        lane = road.at(np.arange(0.0, road.length + step, step).clip(max=road.length), -2.0)
        self.points = lane[:, :2].tolist()

    def steer(self, view: View) -> Command:
        ahead = max(0.65 * view.speed, 5.0)
        x, y = self.points[min(int((view.s + ahead) / 0.5), len(self.points) - 1)]
        bearing = math.atan2(y - view.y, x - view.x) - view.heading
        angle = math.atan(2 * ETK_LIKE.wheelbase * math.sin(bearing) / ahead)
        want = 0.4 * (40 / 3.6 - view.vx)
        return Command(angle, max(want, 0.0), max(-want, 0.0))


def roads(count: int) -> list[Road]:
    """Hilly roads of about 200 m with three turns."""
    rng = np.random.default_rng(5)
    made = []
    for _ in range(count):
        parts = [(rng.uniform(20, 40), 0.0)]
        for _ in range(3):
            parts += [
                (rng.uniform(25, 45), rng.choice((-1, 1)) * rng.uniform(30, 70)),
                (rng.uniform(15, 30), 0.0),
            ]
        segments = tuple(
            Segment(
                distance=distance,
                direction="straight" if turn == 0 else "left" if turn > 0 else "right",
                turn_degrees=turn,
                incline=rng.uniform(-12, 12),
            )
            for distance, turn in parts
        )
        made.append(build(Design(starting_point=(125, 125, 0), theta=rng.uniform(0, 360), segments=segments)))
    return made


def speed(driver: object, over: list[Road]) -> tuple[float, float, list[Drive]]:
    """(simulated seconds per CPU second, median CPU ms per drive, the drives); the best of some repeats."""
    world = World()
    best, each, drives = 0.0, 0.0, []
    for _ in range(REPEATS):
        times, drives = [], []
        for road in over:
            begun = time.process_time()
            drives.append(simulate(road, world, driver, seed=1, keep_driving=True))  # type: ignore[arg-type]
            times.append(time.process_time() - begun)
        rate = sum(drive.duration for drive in drives) / sum(times)
        if rate > best:
            best, each = rate, 1000 * float(np.median(times))
    return best, each, drives


def manoeuvres() -> list[str]:
    """Figures of the default car on flat ground."""
    car = plane()
    while car.see()["vx"] < 100 / 3.6:
        car.move(0.0, 1.0, 0.0)
    sprint = car.see()["time"]
    car = plane()
    car.put(2500.0, 0.0, 100 / 3.6)
    begin = car.see()["x"]
    while car.see()["vx"] > 0.02:
        car.move(0.0, 0.0, 1.0)
    stop = car.see()["x"] - begin
    rows = []
    car = plane()
    car.put(2500.0, 0.0, 80 / 3.6)
    for step in range(900):
        seen = car.see()
        steer = 0.01 * step * 0.02
        lateral = seen["yaw_rate"] * seen["vx"] / 9.81
        rows.append((lateral, steer - ETK_LIKE.wheelbase * seen["yaw_rate"] / seen["vx"], seen["roll"]))
        car.move(steer, min(max(0.6 * (80 / 3.6 - seen["vx"]), 0.0), 1.0), 0.0)
    lateral, extra, roll = np.array(rows).T
    low = (lateral > 0.1) & (lateral < 0.4)
    under, lean = (math.degrees(np.polyfit(lateral[low], values[low], 1)[0]) for values in (extra, roll))
    hill = plane(grade=0.15)
    begin = hill.see()["x"]
    for _ in range(500):
        hill.move(0.0, 0.0, 1.0)
    return [
        f"0-100 km/h {sprint:.1f} s (saloons 6-7), 100-0 km/h {stop:.1f} m (36-40)",
        f"lateral limit {lateral.max():.2f} g (0.85-0.95), understeer {under:.1f} deg/g (1-2.5), "
        f"roll {lean:.1f} deg/g (3-6)",
        f"creep on a 15 % hill in 10 s, brakes on: {1000 * abs(hill.see()['x'] - begin):.3f} mm (0)",
    ]


def main() -> None:
    begun = time.perf_counter()
    plane().move(0.0, 0.0, 0.0)
    print(f"first step, compiling or loading what is kept on disk: {time.perf_counter() - begun:.2f} s")
    over = roads(ROADS)
    simulate(over[0], World(), Pursuit())
    for name, driver in (
        ("pursuit, here", Pursuit()),
        ("reference", "reference"),
        ("beamng_like", "beamng_like"),
    ):
        rate, each, drives = speed(driver, over)
        ends = [drive.ended for drive in drives]
        said = ", ".join(f"{ends.count(end)} {end}" for end in sorted(set(ends)))
        print(f"{name:14s} {rate:5.0f} times real time per core (goal 200); {each:.0f} ms a drive; {said}")
    one, other = (simulate(over[1], World(), Pursuit()).to_bytes() for _ in range(2))
    print(f"the same road and seed give the same bytes: {one == other}")
    for line in manoeuvres():
        print(line)
    print("step steer at 80 km/h beside CommonRoad's multibody model (goal: 6 % up to 0.65 g)")
    print(multibody.table())


if __name__ == "__main__":
    main()
