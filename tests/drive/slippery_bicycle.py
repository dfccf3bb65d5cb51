"""A test double for the simulator: a single-track car with tyres that saturate, in plain Python.

It moves in road coordinates, so it needs no search for the place; it has load by grade, a steering rate,
and a friction ellipse, and none of the real simulator's code.
"""

import math
from typing import Any

import numpy as np

from roadgpt.drive import COLUMNS, Box, Columns, Command, Drive, View
from roadgpt.road import Road, World

A, B, MASS, INERTIA = 1.36, 1.47, 1700.0, 2800.0  # m, m, kg, kg m^2
STIFFNESS, SHAPE = 14.0, 1.35  # 1/rad over load; C of the magic formula
STEPS, DT = 5, 0.004  # of physics per control step
BOX = Box(4.7, 1.86, -0.1)
START, GOAL, STUCK, LONGEST = 2.5, 8.0, 10.0, 90.0


def tyre(slip: float, load: float, grip: float, along: float) -> float:
    side = grip * load * math.sin(SHAPE * math.atan(STIFFNESS / (SHAPE * grip) * slip))
    left = (grip * load) ** 2 - along**2
    return math.copysign(min(abs(side), math.sqrt(max(left, 0.0))), side)


class SlipperyBicycle:
    """The same protocol as the parts of the shelf ``simulators``."""

    def simulate(self, road: Road, world: World, driver: Any, seed: int, keep_driving: bool = False) -> Drive:
        if hasattr(driver, "start"):
            driver.start(road, world, seed)
        stations = np.arange(0.0, road.length + 20.0, 0.25)
        bend = np.where(stations > road.length, 0.0, road.curvature(stations)).tolist()
        ways = road.heading(np.minimum(stations, road.length)).tolist()
        slope = road.grade(np.minimum(stations, road.length)).tolist()
        middle = -world.section.lane_width / 2
        s, t, psi, vx, vy, r, steer, time = START, middle, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        rows: list[dict[str, float]] = []
        ended, still_since, still_at = "", 0.0, s
        while not ended:
            i, f = int(s / 0.25), s / 0.25 % 1
            k, heading = bend[i], ways[i] + f * (ways[i + 1] - ways[i])
            x, y, z = (float(v) for v in road.at(min(s, road.length), t))
            yaw = math.remainder(heading + psi, 2 * math.pi)
            speed = math.hypot(vx, vy)
            view = View(time, x, y, z + 0.5, yaw, speed, r, s, t, road, world, steer, 0.02, vx, vy)
            command: Command = driver.steer(view)
            out = share_outside(t, psi, k, world.section.lane_width)
            row = dict.fromkeys(COLUMNS, 0.0)
            row |= {"time": time, "x": x, "y": y, "z": z + 0.5, "heading": yaw, "vx": vx, "vy": vy}
            row |= {"yaw_rate": r, "speed": speed, "steer": steer, "throttle": command.throttle}
            row |= {"brake": command.brake, "s": s, "t": t, "outside": out}
            rows.append(row)
            if abs(s - still_at) > 1.0:
                still_since, still_at = time, s
            if road.length - s < GOAL:
                ended = "goal"
            elif time - still_since >= STUCK:
                ended = "stuck"
            elif out > world.limits.oob_tolerance and not keep_driving:
                ended = "out_of_lane"
            elif abs(t) - BOX.width / 2 > world.section.lane_width + world.section.shoulder:
                ended = "fell"
            elif time >= LONGEST:
                ended = "timeout"
            for _ in range(STEPS):
                k, grade = bend[int(s / 0.25)], slope[int(s / 0.25)]
                steer += min(max(command.steer - steer, -0.8 * DT), 0.8 * DT)
                pull = MASS * min(6.8, 82.0 / max(vx, 1.0)) * min(max(command.throttle, 0), 1)
                push = MASS * 13.0 * min(max(command.brake, 0), 1) if vx > 0.05 else 0.0
                most = world.site.friction * MASS * 9.81
                force = min(max(pull - push, -0.98 * most), 0.98 * most)
                front, rear = MASS * 9.81 * B / (A + B), MASS * 9.81 * A / (A + B)
                v = max(vx, 1.0)
                share = front / (front + rear)
                f = tyre(steer - math.atan2(vy + A * r, v), front, world.site.friction, force * share)
                b = tyre(-math.atan2(vy - B * r, v), rear, world.site.friction, force * (1 - share))
                fade = min(vx / 2.0, 1.0)
                ax = (force - f * math.sin(steer)) / MASS - 9.81 * grade - 3e-4 * vx * vx
                vx = max(vx + DT * (ax + vy * r), 0.0)
                if fade < 1.0:  # rolls without slip
                    vy, r = B * vx * math.tan(steer) / (A + B), vx * math.tan(steer) / (A + B)
                else:
                    vy += DT * ((f * math.cos(steer) + b) / MASS - vx * r)
                    r += DT * (A * f * math.cos(steer) - B * b) / INERTIA
                along = (vx * math.cos(psi) - vy * math.sin(psi)) / max(1 - k * t, 0.2)
                s, t = s + DT * along, t + DT * (vx * math.sin(psi) + vy * math.cos(psi))
                s = max(s, 0.0)
                psi += DT * (r - k * along)
            time += 0.02
        columns = Columns({name: np.array([row[name] for row in rows]) for name in COLUMNS})
        name = getattr(driver, "name", type(driver).__name__)
        return Drive(name, "slippery_bicycle", seed, columns, ended, BOX)  # type: ignore[arg-type]


def share_outside(t: float, psi: float, k: float, lane: float) -> float:
    """Of a grid of points in the box, those whose offset is not between 0 and one lane to the right."""
    u, v = AHEAD, ASIDE
    across = t + u * math.sin(psi) + v * math.cos(psi) - k / 2 * (u * math.cos(psi)) ** 2
    return 1.0 - np.count_nonzero((across <= 0) & (across >= -lane)) / across.size


GRID = (np.arange(40) + 0.5) / 40 - 0.5
AHEAD, ASIDE = BOX.ahead + BOX.length * GRID[None], BOX.width * GRID[:, None]
