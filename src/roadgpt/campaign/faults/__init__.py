"""Groups failures by fault, and analyses each fault: why it occurs, how often it recurs, and the simplest
road on which it occurs.
"""

from roadgpt.campaign.faults.change import Difference, SmallestChange, smallest_change
from roadgpt.campaign.faults.distinct import Surroundings, faults_of, surroundings
from roadgpt.campaign.faults.failures import LocatedFailure, failures_of
from roadgpt.campaign.faults.fault import Fault, Faults, faults_in
from roadgpt.campaign.faults.fault_log import (
    AnalysisTask,
    FailureAnalysis,
    analyse,
    kept_analysis,
    write_tables,
)
from roadgpt.campaign.faults.minimise import Simplest, simplest
from roadgpt.campaign.faults.reason import FailureReason, Manner, manner_of, reason_of
from roadgpt.campaign.faults.stability import Repeated, Stability, repeated

__all__ = [
    "AnalysisTask",
    "Difference",
    "FailureAnalysis",
    "FailureReason",
    "Fault",
    "Faults",
    "LocatedFailure",
    "Manner",
    "Repeated",
    "Simplest",
    "SmallestChange",
    "Stability",
    "Surroundings",
    "analyse",
    "failures_of",
    "faults_in",
    "faults_of",
    "kept_analysis",
    "manner_of",
    "reason_of",
    "repeated",
    "simplest",
    "smallest_change",
    "surroundings",
    "write_tables",
]
