"""The car as a value: masses, axles, tyres, engine, brakes, stability systems.

The default is a saloon of the size, drive and launch of BeamNG's ETK 800 (AWD, about 220 kW). Its numbers
are typical ones, tuned until the manoeuvres in ``tests/drive/test_simulator_manoeuvres.py`` lie in the
published ranges; they are not measured on one car.
"""

import math
from dataclasses import dataclass, fields
from types import SimpleNamespace
from typing import Any

import numpy as np

from roadgpt.drive.compiled import COMPILES
from roadgpt.drive.drive import Box

GRAVITY = 9.81  # m/s^2


@dataclass(frozen=True)
class Tyre:
    """Magic formula, similarity method: H. B. Pacejka, Tyre and Vehicle Dynamics, 3rd ed., 4.3 and 7.2."""

    grip_x: float = 1.17
    """Peak friction along, at nominal load, on a road of friction 1 (PAC2002 sets, dry: 1.1 to 1.25)."""
    grip_y: float = 1.02
    """Peak friction across."""
    grip_fade: float = 0.12
    """Share of the friction lost when the load doubles (typical 0.1 to 0.2)."""
    stiffness_x: float = 24.0
    """Slip stiffness over load, 1 (typical 20 to 30)."""
    stiffness_y: float = 18.0
    """Cornering stiffness over load, 1/rad; axle values, elasticity of suspension and steering counted."""
    stiffness_fade: float = 0.15
    """Share of the stiffness over load that is lost when the load doubles."""
    shape_x: float = 1.6
    """C of the magic formula; 1.6411 in CommonRoad's PAC2002 set."""
    shape_y: float = 1.35
    """C; 1.3507 in CommonRoad's set."""
    bend_x: float = 0.4
    """E of the magic formula; 0.464 in CommonRoad's set."""
    bend_y: float = -0.2
    """E; -0.0075 in CommonRoad's set."""
    relaxation_x: float = 0.25
    """m, the way in which a slip builds up."""
    relaxation_y: float = 0.45
    """m."""
    camber_shift: float = 0.03
    """Slip angle that one rad of camber is worth (p_Hy3)."""
    camber_thrust: float = 0.0
    """Share of the load per rad of camber (p_Vy3)."""
    camber_grip: float = 0.0
    """Change of friction per rad^2 of camber (p_Dy3)."""
    ply_shift: float = 0.0
    """rad of slip angle that any camber brings, by its sign (p_Hy1)."""
    ply_thrust: float = 0.0
    """Share of the load, likewise (p_Vy1)."""
    rolling_resistance: float = 0.011
    """Share of the load (typical 0.010 to 0.013)."""
    spring: float = 230e3
    """N/m, vertical."""
    damper: float = 400.0
    """Ns/m, vertical."""


@dataclass(frozen=True)
class Axle:
    """One axle with two wheels."""

    place: float
    """m, forward of the body's centre of gravity."""
    tyre: Tyre
    track: float = 1.58
    """m."""
    wheel_mass: float = 42.0
    """kg, unsprung, per wheel."""
    spring: float = 30e3
    """N/m at the wheel."""
    damper: float = 3200.0
    """Ns/m at the wheel."""
    anti_roll: float = 18e3
    """Nm/rad of the anti-roll bar."""
    roll_centre: float = 0.06
    """m above the road."""
    camber_gain: float = -0.4
    """rad of camber per metre of rebound, as CommonRoad's D_f: negative pulls the tops in on bump."""
    drive_share: float = 0.5
    """Of the engine's torque."""
    brake_share: float = 0.5
    """Of the brakes' torque."""

    @property
    def lean(self) -> float:
        """rad that the suspension's slides lean outward at the top, to put the roll centre in its place."""
        return math.atan2(self.roll_centre, self.track / 2)


@dataclass(frozen=True)
class Car:
    """Everything about a car that its motion depends on."""

    front: Axle
    rear: Axle
    length: float = 4.70
    """m."""
    width: float = 1.86
    """m, without mirrors."""
    box_ahead: float = -0.10
    """m, middle of the box ahead of the centre of gravity."""
    body_mass: float = 1532.0
    """kg, sprung, one person aboard."""
    roll_inertia: float = 560.0
    """kg m^2, of the body about its own centre."""
    pitch_inertia: float = 2300.0
    """kg m^2."""
    yaw_inertia: float = 2450.0
    """kg m^2."""
    height: float = 0.56
    """m, centre of gravity of the body above the road at rest."""
    clearance: float = 0.14
    """m, underbody above the road at rest."""
    roof: float = 1.44
    """m above the road."""
    wheel_radius: float = 0.33
    """m, free."""
    wheel_inertia: float = 1.2
    """kg m^2, about the axle, driveline counted."""
    tread: float = 0.225
    """m, width of the tyre."""
    bump: float = 0.09
    """m of spring travel either way before the stops."""
    bump_stop: float = 250e3
    """N/m of the stops."""
    drag_area: float = 0.62
    """m^2, c_d A."""
    power: float = 125e3
    """W at the wheels, mean over a run through the gears: 220 kW, of which 85 % pass the driveline, and two
    thirds of those are left by gear steps, shifts and turbo lag."""
    launch: float = 6.8
    """m/s^2, most that the engine can do in first gear (BeamNG recordings of an ETK 800: 6.7 to 7.2)."""
    brakes: float = 13.0
    """m/s^2 that the brakes could do if tyres held."""
    throttle_lag: float = 0.10
    """s."""
    brake_lag: float = 0.06
    """s."""
    steer_limit: float = 0.62
    """rad at the front wheels."""
    steer_rate: float = 0.8
    """rad/s at the front wheels."""
    ackermann: float = 1.0
    """1: the inner wheel turns more, as geometry asks; 0: parallel."""
    abs_slip: float = 0.11
    """Slip beyond which ABS lets go; 0: no ABS."""
    tcs_slip: float = 0.10
    """Slip beyond which TCS lets go; 0: no TCS."""
    esc: float = 9000.0
    """Nm of braking per rad/s of yaw rate beyond the tolerance; 0: no ESC."""
    characteristic: float = 0.0025
    """s^2/m, understeer that the ESC expects: yaw rate = v steer / (wheelbase + characteristic v^2)."""

    @property
    def mass(self) -> float:
        """kg, everything."""
        return self.body_mass + 2 * (self.front.wheel_mass + self.rear.wheel_mass)

    @property
    def wheelbase(self) -> float:
        """m."""
        return self.front.place - self.rear.place

    @property
    def box(self) -> Box:
        """Outline, front wheels, and lock."""
        return Box(
            self.length,
            self.width,
            self.box_ahead,
            self.steer_limit,
            axle=self.front.place,
            tyres=self.front.track + self.tread,
            height=self.height,
            under=self.height - self.clearance,
        )

    def load(self, axle: Axle) -> float:
        """N on one wheel of the axle, at rest on level ground."""
        other = self.rear if axle is self.front else self.front
        share = -other.place / (axle.place - other.place)
        return GRAVITY * (self.body_mass * share / 2 + axle.wheel_mass)


ETK_LIKE = Car(
    front=Axle(
        place=1.36,
        tyre=Tyre(stiffness_y=15.0),
        spring=31e3,
        anti_roll=22e3,
        drive_share=0.4,
        brake_share=0.62,
    ),
    rear=Axle(
        place=-1.47,
        tyre=Tyre(stiffness_y=20.5),
        spring=33e3,
        anti_roll=12e3,
        roll_centre=0.10,
        drive_share=0.6,
        brake_share=0.38,
    ),
)


def tables(car: Car) -> tuple[Any, Any]:
    """The car as the inner loop reads it: one record of the car, two of its axles (front, rear)."""
    body = _numbers(car) | {
        "mass": car.mass,
        "wheelbase": car.wheelbase,
    }
    axles = [
        _numbers(axle)
        | {f"tyre_{name}": value for name, value in _numbers(axle.tyre).items()}
        | {"load": car.load(axle), "carried": car.load(axle) - GRAVITY * axle.wheel_mass}
        | {"lean": axle.lean}
        for axle in (car.front, car.rear)
    ]
    if COMPILES:
        return _records([body]), _records(axles)
    return [SimpleNamespace(**body)], [SimpleNamespace(**axle) for axle in axles]


def _numbers(value: Any) -> dict[str, float]:
    every = {f.name: getattr(value, f.name) for f in fields(value)}
    return {name: float(number) for name, number in every.items() if isinstance(number, int | float)}


def _records(rows: list[dict[str, float]]) -> Any:
    kind = np.dtype([(name, np.float64) for name in rows[0]])
    return np.array([tuple(row.values()) for row in rows], dtype=kind)
