"""Defines VehicleState, the state of a car. VehicleStateReader, the class that reads the state, needs BeamNG
and is not defined here: it is imported from a checkout of the competition's code."""

from __future__ import annotations

from collections import namedtuple

from self_driving.simulation_data import SimulationDataRecordProperties

VehicleStateProperties = SimulationDataRecordProperties[:12]
VehicleState = namedtuple("VehicleState", VehicleStateProperties)  # type: ignore[misc]
