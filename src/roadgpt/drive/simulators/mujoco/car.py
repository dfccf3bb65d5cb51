"""Defines the parameters of the car: masses, axles, tyres, engine, brakes and stability systems.

The default is a saloon with the size, drive and acceleration of BeamNG's ETK 800 (AWD, about 220 kW). Its
numbers are typical values, tuned until the results of the manoeuvres in
``tests/drive/test_simulator_manoeuvres.py`` lie in published ranges; they were not measured on an actual car.
"""

import math
from dataclasses import dataclass, fields
from types import SimpleNamespace
from typing import Any

import numpy as np

from roadgpt.compiled import COMPILES
from roadgpt.drive.drive import Box
from roadgpt.road.speed_profile import GRAVITY


@dataclass(frozen=True)
class Tyre:
    """Parameters of a tyre for the Magic Formula with the similarity method: H. B. Pacejka, Tyre and Vehicle
    Dynamics, 3rd ed., 4.3 and 7.2."""

    peak_friction_x: float = 1.17
    """Longitudinal peak friction at nominal load, on a road of friction 1 (PAC2002 sets, dry: 1.1 to
    1.25)."""
    peak_friction_y: float = 1.02  # lateral peak friction at nominal load, on a road of friction 1
    friction_load_sensitivity: float = 0.12
    """Share by which the friction coefficient decreases when the load doubles (typical 0.1 to 0.2)."""
    slip_stiffness: float = 24.0
    """Longitudinal slip stiffness divided by the load, dimensionless (typical 20 to 30)."""
    cornering_stiffness: float = 18.0
    """Cornering stiffness divided by the load, 1/rad; it includes the compliance of suspension and
    steering."""
    stiffness_load_sensitivity: float = 0.15
    """Share by which the ratio of stiffness to load decreases when the load doubles."""
    shape_factor_x: float = 1.6
    """Longitudinal shape factor C of the Magic Formula; 1.6411 in CommonRoad's PAC2002 set."""
    shape_factor_y: float = 1.35  # lateral shape factor C of the Magic Formula; 1.3507 in CommonRoad's set
    curvature_factor_x: float = 0.4
    """Longitudinal curvature factor E of the Magic Formula; 0.464 in CommonRoad's set."""
    curvature_factor_y: float = -0.2
    """Lateral curvature factor E of the Magic Formula; -0.0075 in CommonRoad's set."""
    relaxation_length_x: float = 0.25  # distance in m over which a longitudinal slip builds up
    relaxation_length_y: float = 0.45  # distance in m over which a slip angle builds up
    camber_horizontal_shift: float = 0.03
    """Slip angle in rad that has the same effect as a camber of one rad (p_Hy3)."""
    camber_vertical_shift: float = 0.0  # lateral force per rad of camber, as a share of the load (p_Vy3)
    camber_friction_loss: float = 0.0  # relative loss of lateral friction per rad^2 of camber (p_Dy3)
    horizontal_shift: float = 0.0
    """Slip angle in rad that is added with the sign of the camber, however small the camber is (p_Hy1)."""
    vertical_shift: float = 0.0
    """Lateral force, as a share of the load, that is added with the sign of the camber, however small the
    camber is (p_Vy1)."""
    rolling_resistance: float = 0.011  # rolling resistance as a share of the load (typical 0.010 to 0.013)
    vertical_stiffness: float = 230e3  # vertical stiffness of the tyre, N/m
    vertical_damping: float = 400.0  # vertical damping of the tyre, Ns/m


@dataclass(frozen=True)
class Axle:
    """Parameters of one axle with two wheels."""

    position: float
    """Position of the axle in m ahead of the centre of gravity of the sprung mass; negative for the rear
    axle."""
    tyre: Tyre
    track_width: float = 1.58  # distance in m between the centres of the two wheels
    unsprung_mass: float = 42.0  # unsprung mass in kg per wheel
    wheel_rate: float = 30e3  # stiffness of the spring in N/m, measured at the wheel
    damping: float = 3200.0  # damping in Ns/m, measured at the wheel
    anti_roll_stiffness: float = 18e3  # stiffness of the anti-roll bar in Nm/rad
    roll_centre_height: float = 0.06  # height of the roll centre in m above the road
    camber_gain: float = -0.4
    """Camber in rad per metre of rebound (CommonRoad's D_f). If it is negative, the tops of the wheels move
    inwards in compression."""
    drive_torque_share: float = 0.5  # share of the engine's torque that goes to this axle, 0 to 1
    brake_torque_share: float = 0.5  # share of the brakes' torque that goes to this axle, 0 to 1

    @property
    def inclination(self) -> float:
        """Angle in rad by which the axes of suspension travel lean outwards at the top; it determines the
        height of the roll centre."""
        return math.atan2(self.roll_centre_height, self.track_width / 2)


@dataclass(frozen=True)
class Car:
    """All parameters that determine how a car moves."""

    front: Axle
    rear: Axle
    length: float = 4.70  # length of the car in m
    width: float = 1.86  # width of the car in m, without mirrors
    box_offset: float = -0.10
    """Distance in m from the centre of gravity forward to the middle of the car's box; negative if the middle
    is behind."""
    sprung_mass: float = 1532.0  # sprung mass in kg, with one person on board
    roll_inertia: float = 560.0  # roll inertia in kg m^2 of the sprung mass about its own centre of gravity
    pitch_inertia: float = 2300.0
    """Pitch inertia in kg m^2 of the sprung mass about its own centre of gravity."""
    yaw_inertia: float = 2450.0  # yaw inertia in kg m^2 of the sprung mass about its own centre of gravity
    cg_height: float = 0.56  # height in m of the sprung mass's centre of gravity above the road, at rest
    ground_clearance: float = 0.14  # height in m of the underbody above the road, at rest
    overall_height: float = 1.44  # height in m of the car's roof above the road
    unloaded_radius: float = 0.33  # radius in m of a tyre without load
    wheel_inertia: float = 1.2  # inertia in kg m^2 of a wheel about its axle, driveline included
    tyre_width: float = 0.225  # width of a tyre in m
    bump_travel: float = 0.09  # suspension travel in m, in either direction, before the bump stops
    bump_stop_rate: float = 250e3  # stiffness of the bump stops in N/m
    drag_area: float = 0.62  # drag coefficient times frontal area, m^2
    max_power: float = 125e3
    """Power in W at the wheels, averaged over a run through the gears: 85 % of the engine's 220 kW pass the
    driveline, and gear ratios, shifts and turbo lag leave two thirds of that."""
    max_drive_acceleration: float = 6.8
    """Largest acceleration in m/s^2 that the engine can produce, in first gear (BeamNG recordings of an ETK
    800: 6.7 to 7.2)."""
    max_brake_deceleration: float = 13.0
    """Largest deceleration in m/s^2 that the brakes can produce if the tyres have unlimited friction."""
    throttle_time_constant: float = 0.10  # time constant in s of the response to the throttle
    brake_time_constant: float = 0.06  # time constant in s of the response to the brake
    max_steer_angle: float = 0.62  # steering angle at full lock, in rad at the front wheels
    max_steer_rate: float = 0.8  # largest steering rate, in rad/s at the front wheels
    ackermann: float = 1.0
    """Ackermann fraction: 1 turns the inner wheel as far as geometry requires, 0 keeps both wheels
    parallel."""
    abs_slip_threshold: float = 0.11  # slip beyond which ABS reduces the brake torque; 0 for no ABS
    tcs_slip_threshold: float = 0.10
    """Slip beyond which traction control reduces the drive torque; 0 for no traction control."""
    esc_gain: float = 9000.0
    """Braking torque in Nm per rad/s of yaw rate error beyond the tolerance; 0 for no ESC."""
    esc_understeer_gradient: float = 0.0025
    """Understeer gradient in s^2/m that the ESC expects: yaw rate = v steer / (wheelbase + gradient v^2)."""

    @property
    def mass(self) -> float:
        """Mass of the whole car in kg."""
        return self.sprung_mass + 2 * (self.front.unsprung_mass + self.rear.unsprung_mass)

    @property
    def wheelbase(self) -> float:
        """Distance between the axles in m."""
        return self.front.position - self.rear.position

    @property
    def box(self) -> Box:
        """The outline of the car, and the position and lock angle of its front wheels."""
        return Box(
            self.length,
            self.width,
            self.box_offset,
            self.max_steer_angle,
            axle=self.front.position,
            tyres=self.front.track_width + self.tyre_width,
            height=self.cg_height,
            under=self.cg_height - self.ground_clearance,
        )

    def static_wheel_load(self, axle: Axle) -> float:
        """Returns the load in N on one wheel of the axle, at rest on level ground."""
        other = self.rear if axle is self.front else self.front
        share = -other.position / (axle.position - other.position)
        return GRAVITY * (self.sprung_mass * share / 2 + axle.unsprung_mass)


ETK_LIKE = Car(
    front=Axle(
        position=1.36,
        tyre=Tyre(cornering_stiffness=15.0),
        wheel_rate=31e3,
        anti_roll_stiffness=22e3,
        drive_torque_share=0.4,
        brake_torque_share=0.62,
    ),
    rear=Axle(
        position=-1.47,
        tyre=Tyre(cornering_stiffness=20.5),
        wheel_rate=33e3,
        anti_roll_stiffness=12e3,
        roll_centre_height=0.10,
        drive_torque_share=0.6,
        brake_torque_share=0.38,
    ),
)


def tables(car: Car) -> tuple[Any, Any]:
    """Returns the car's parameters in the form that the inner loop reads: one record for the car, and two
    records for its axles (front, rear)."""
    body = _numbers(car) | {"mass": car.mass, "wheelbase": car.wheelbase}
    axles = [
        _numbers(axle)
        | {f"tyre_{name}": value for name, value in _numbers(axle.tyre).items()}
        | {
            "nominal_load": car.static_wheel_load(axle),
            "sprung_load": car.static_wheel_load(axle) - GRAVITY * axle.unsprung_mass,
            "inclination": axle.inclination,
        }
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
