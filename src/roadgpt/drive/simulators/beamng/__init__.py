"""The simulator ``beamng``; it needs beamngpy, which is imported when the first road is driven."""

from roadgpt.drive.simulators.beamng.settings import BeamngSettings
from roadgpt.drive.simulators.beamng.simulator import BeamngSimulator

__all__ = ["BeamngSettings", "BeamngSimulator"]
