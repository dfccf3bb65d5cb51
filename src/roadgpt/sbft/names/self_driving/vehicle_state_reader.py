"""Imports the class that reads a car's state from a checkout of the competition's code. RoadGPT has no
such class, because it needs BeamNG.
"""

from __future__ import annotations

from collections import namedtuple

from self_driving.simulation_data import SimulationDataRecordProperties

VehicleStateProperties = SimulationDataRecordProperties[:12]
VehicleState = namedtuple("VehicleState", VehicleStateProperties)  # type: ignore[misc]
