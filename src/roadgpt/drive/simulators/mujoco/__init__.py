"""The simulator ``mujoco``.

The car can be changed: ``MujocoSimulator(replace(ETK_LIKE, max_drive_acceleration=4.0))`` uses a car with
weaker acceleration.
"""

from roadgpt.drive.simulators.mujoco.car import ETK_LIKE, Axle, Car, Tyre
from roadgpt.drive.simulators.mujoco.simulator import MujocoSimulator
from roadgpt.drive.simulators.mujoco.vehicle import Vehicle, plane

__all__ = ["ETK_LIKE", "Axle", "Car", "MujocoSimulator", "Tyre", "Vehicle", "plane"]
