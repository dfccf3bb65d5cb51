"""Tests, and what is counted of them."""

from roadgpt.sbft.road_test import RoadTestFactory
from roadgpt.sbft.statistic import TestGenerationStatistic

__all__ = ["RoadTestFactory", "TestGenerationStatistic"]
