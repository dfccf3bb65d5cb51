"""The validator."""

from roadgpt.sbft.road_test import TestValidator

__all__ = ["TestValidator"]
