"""The simulator ``beamng``. Needs beamngpy, which is imported when the first road is driven."""

from roadgpt.drive.simulators.beamng.settings import Settings
from roadgpt.drive.simulators.beamng.simulator import BeamngSimulator

__all__ = ["BeamngSimulator", "Settings"]
