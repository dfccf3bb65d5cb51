"""Failures that count: how stable each is, which are the same, why it happened, what is left of it."""

from roadgpt.campaign.faults.book import Failure, Line, look_into, table, write_table
from roadgpt.campaign.faults.change import Difference, SmallestChange, smallest_change
from roadgpt.campaign.faults.distinct import Surroundings, faults_of, surroundings
from roadgpt.campaign.faults.failed import cells_of, failed_runs
from roadgpt.campaign.faults.minimise import Simplest, simplest
from roadgpt.campaign.faults.stability import Repeated, Stability, repeated
from roadgpt.campaign.faults.why import Why, why

__all__ = [
    "Difference",
    "Failure",
    "Line",
    "Repeated",
    "Simplest",
    "SmallestChange",
    "Stability",
    "Surroundings",
    "Why",
    "cells_of",
    "failed_runs",
    "faults_of",
    "look_into",
    "repeated",
    "simplest",
    "smallest_change",
    "surroundings",
    "table",
    "why",
    "write_table",
]
