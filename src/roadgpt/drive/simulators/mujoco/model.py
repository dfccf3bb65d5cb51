"""Builds the rigid bodies of the car for MuJoCo: 16 degrees of freedom, and no force but gravity.

    body (6) --- slide along the suspension (4) --- steering hinge (2, front) --- wheel spin (4)

Springs, dampers, tyres, brakes, engine and air drag are computed in ``dynamics``; the MuJoCo model has no
contacts and no constraints. The wheels are numbered left front, right front, left rear, right rear."""

import math
from typing import Any

import mujoco

from roadgpt.drive.simulators.mujoco.car import GRAVITY, Axle, Car

STEP = 0.002  # s
WHEELS = ("lf", "rf", "lr", "rr")
WHEEL_SHARE = 0.7  # of the unsprung mass rotates with the wheel; the rest only steers
# kg m^2 of armature that hold the steering hinges at the angles that the steering prescribes.
STIFF_HINGE = 1e5

# Indices into qvel (qpos has one number more, for the quaternion), in the order of the tree below.
SLIDE_DOF = (6, 9, 12, 14)
STEER_DOF = (7, 10)
SPIN_DOF = (8, 11, 13, 15)
# Numbers of the bodies.
BODY = 1
CARRIER = (2, 4, 6, 8)
WHEEL = (3, 5, 7, 9)

_DISABLED = """constraint equality frictionloss limit contact spring damper clampctrl warmstart actuation
    sensor eulerdamp autoreset"""


def model_of(car: Car) -> Any:
    """Returns the compiled MuJoCo model of the car, with the masses and positions of its body and wheels."""
    flags = " ".join(f'{name}="disable"' for name in _DISABLED.split())
    wheels = "".join(
        _wheel(car, axle, name, side)
        for axle, pair in ((car.front, WHEELS[:2]), (car.rear, WHEELS[2:]))
        for name, side in zip(pair, (1, -1), strict=True)
    )
    inertia = f"{car.roll_inertia} {car.pitch_inertia} {car.yaw_inertia}"
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <compiler angle="radian" autolimits="false" balanceinertia="false"/>
      <option timestep="{STEP}" gravity="0 0 {-GRAVITY}" integrator="Euler" jacobian="dense">
        <flag {flags}/>
      </option>
      <worldbody>
        <body name="body">
          <freejoint/>
          <inertial pos="0 0 0" mass="{car.sprung_mass}" diaginertia="{inertia}"/>
          {wheels}
        </body>
      </worldbody>
    </mujoco>""")


def centre_height(car: Car, axle: Axle) -> float:
    """Returns the height in m of a wheel's centre above level ground, at rest."""
    return car.unloaded_radius - car.static_wheel_load(axle) / axle.tyre.vertical_stiffness


def _wheel(car: Car, axle: Axle, name: str, side: int) -> str:
    down = centre_height(car, axle) - car.cg_height
    lean = axle.inclination
    slide = f"0 {side * math.sin(lean)} {math.cos(lean)}"
    steer = f'<joint name="steer_{name}" axis="0 0 1" armature="{STIFF_HINGE}"/>' if axle is car.front else ""
    turning, carried = WHEEL_SHARE * axle.unsprung_mass, (1 - WHEEL_SHARE) * axle.unsprung_mass
    across = car.wheel_inertia / 2 + turning * car.tyre_width**2 / 12
    small = 0.01 * carried
    return f"""
      <body name="carrier_{name}" pos="{axle.position} {side * axle.track_width / 2} {down}">
        <joint name="slide_{name}" type="slide" axis="{slide}"/>{steer}
        <inertial pos="0 0 0" mass="{carried}" diaginertia="{small} {small} {small}"/>
        <body name="wheel_{name}">
          <joint name="spin_{name}" axis="0 1 0"/>
          <inertial pos="0 0 0" mass="{turning}" diaginertia="{across} {car.wheel_inertia} {across}"/>
        </body>
      </body>"""
