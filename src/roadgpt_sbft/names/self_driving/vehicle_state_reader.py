"""The state of a car. VehicleStateReader, which reads it, needs BeamNG and comes from a checkout."""

from __future__ import annotations

from collections import namedtuple

from self_driving.simulation_data import SimulationDataRecordProperties

VehicleStateProperties = SimulationDataRecordProperties[:12]
VehicleState = namedtuple("VehicleState", VehicleStateProperties)  # type: ignore[misc]
