"""Failures that count: which are the same, why they happened, how stable each is, what is left of it."""

from roadgpt.campaign.faults.book import Look, Looked, look_into, looked_into, write_tables
from roadgpt.campaign.faults.change import Difference, SmallestChange, smallest_change
from roadgpt.campaign.faults.distinct import Surroundings, faults_of, surroundings
from roadgpt.campaign.faults.failed import Departure, failed_run, failures_of
from roadgpt.campaign.faults.fault import Fault, Faults, faults_in
from roadgpt.campaign.faults.minimise import Simplest, simplest
from roadgpt.campaign.faults.stability import Repeated, Stability, repeated
from roadgpt.campaign.faults.why import Manner, Why, manner_of, why

__all__ = [
    "Departure",
    "Difference",
    "Fault",
    "Faults",
    "Look",
    "Looked",
    "Manner",
    "Repeated",
    "Simplest",
    "SmallestChange",
    "Stability",
    "Surroundings",
    "Why",
    "failed_run",
    "failures_of",
    "faults_in",
    "faults_of",
    "look_into",
    "looked_into",
    "manner_of",
    "repeated",
    "simplest",
    "smallest_change",
    "surroundings",
    "why",
    "write_tables",
]
