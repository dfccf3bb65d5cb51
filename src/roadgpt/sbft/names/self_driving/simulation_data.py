"""Records of a drive."""

from roadgpt.sbft.executor import SimulationDataRecord

SimulationDataRecordProperties = list(SimulationDataRecord._fields)
SimulationDataRecords = list[SimulationDataRecord]

__all__ = ["SimulationDataRecord", "SimulationDataRecordProperties", "SimulationDataRecords"]
