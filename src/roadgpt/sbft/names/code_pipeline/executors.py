"""The executor, for annotations and tests of type; generators are handed theirs."""

from roadgpt.sbft.budget import Budget
from roadgpt.sbft.executor import AbstractTestExecutor

MockExecutor = AbstractTestExecutor

__all__ = ["AbstractTestExecutor", "Budget", "MockExecutor"]
