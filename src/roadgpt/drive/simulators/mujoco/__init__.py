"""The simulator ``mujoco``.

Its car is a value: ``MujocoSimulator(replace(ETK_LIKE, max_drive_acceleration=4.0))`` drives a weaker one.
"""

from roadgpt.drive.simulators.mujoco.car import ETK_LIKE, Axle, Car, Tyre
from roadgpt.drive.simulators.mujoco.simulator import MujocoSimulator
from roadgpt.drive.simulators.mujoco.vehicle import Vehicle, plane

__all__ = ["ETK_LIKE", "Axle", "Car", "MujocoSimulator", "Tyre", "Vehicle", "plane"]
