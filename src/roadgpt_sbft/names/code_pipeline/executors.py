"""Defines executors, which take one test at a time until the budget is used up."""

from __future__ import annotations

import logging
import sys
import time
from abc import ABC, abstractmethod
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple

from code_pipeline.test_analysis import compute_all_features
from code_pipeline.tests_generation import TestGenerationStatistic
from code_pipeline.validation import TestValidator
from self_driving.simulation_data import SimulationDataRecord

log = logging.getLogger(__name__)

OVER = 123  # exit status with which the competition ends a generator that asks for more than its budget
HANDED = "roadgpt compete sbft makes the executor and passes it to the generator; start it with that"

TestResult = Tuple[str, str, List[Any]]


REMAINING = "time-budget"  # the competition's key
PER_TEST = 35.0  # s: what one test takes in the competition's own pipeline


class Remaining(Dict[str, float]):
    """The remaining budget in seconds, under the key ``time-budget`` as in the competition since 2022; it can
    also be compared with numbers, as in earlier competitions."""

    def __float__(self) -> float:
        return self[REMAINING]

    def __format__(self, spec: str) -> str:
        return format(float(self), spec) if spec else str(self)


def _as_number(name: str) -> Any:
    method = getattr(float, name)
    return lambda self, other: method(float(self), float(other))


for _name in ("__lt__", "__le__", "__gt__", "__ge__", "__sub__", "__rsub__"):
    setattr(Remaining, _name, _as_number(_name))


class SharedCounter:
    """A test counter that all copies of a budget share."""

    tests = 0

    def __deepcopy__(self, memo: Any) -> SharedCounter:
        return self


class Budget:
    """A budget: seconds of wall time, a number of tests, or both. Where only tests are limited, the remaining
    time is 35 s for each of them, so that generators that plan by it behave as in the competition."""

    def __init__(
        self,
        time_budget: Optional[float] = None,
        generation_budget: Optional[float] = None,
        execution_budget: Optional[float] = None,
        test_budget: Optional[int] = None,
    ) -> None:
        """Nothing has used ``generation_budget`` and ``execution_budget`` since 2022."""
        self.generation_budget = generation_budget
        self.execution_budget = execution_budget
        self._has_clock = time_budget is not None
        self.time_budget = PER_TEST * (test_budget or 0) if time_budget is None else time_budget
        """Seconds; generators calculate with it, so it is always a number."""
        self.test_budget = test_budget
        self._count = SharedCounter()
        self.start_real_time: float = time.monotonic()

    @property
    def tests(self) -> int:
        """Number of tests so far, including those of all copies of this budget."""
        return self._count.tests

    @tests.setter
    def tests(self, tests: int) -> None:
        self._count.tests = tests

    def start(self) -> None:
        self.start_real_time = time.monotonic()

    def get_start_time(self) -> float:
        return self.start_real_time

    def get_remaining_real_time(self) -> float:
        if self._has_clock:
            return self.time_budget - (time.monotonic() - self.start_real_time)
        return PER_TEST * max((self.test_budget or 0) - self.tests, 0)

    def get_remaining_time(self) -> Remaining:
        return Remaining({REMAINING: self.get_remaining_real_time()})

    def can_run_a_test(self) -> bool:
        has_tests = self.test_budget is None or self.tests < self.test_budget
        return has_tests and self.get_remaining_real_time() > 0

    def is_over(self) -> bool:
        return not self.can_run_a_test()


class AbstractTestExecutor(ABC):
    """Base class of executors: validates, executes, counts and writes tests; subclasses define how a test is
    executed."""

    start_time: Any = None

    def __init__(
        self,
        result_folder: str,
        map_size: int,
        time_budget: Optional[float] = None,
        road_visualizer: Any = None,
        debug: bool = False,
        test_budget: Optional[int] = None,
    ) -> None:
        self.debug = debug
        self.result_folder = result_folder
        self.map_size = map_size
        self.stats = TestGenerationStatistic()
        self.time_budget = Budget(time_budget=time_budget, test_budget=test_budget)
        self.test_validator = TestValidator(map_size)
        self.road_visualizer = road_visualizer
        self.timeout_forced = False
        self.start()

    def start(self) -> None:
        self.time_budget.start()
        self.start_time = time.time()
        self.start_generation_time: float = self.time_budget.get_start_time()

    def execute_test(self, the_test: Any) -> TestResult:
        """Validates and executes a test; returns (outcome, description, execution data). Raises SystemExit
        if the budget is used up; the test is then discarded, as in the competition."""
        generating = time.monotonic() - self.start_generation_time
        if self.time_budget.is_over():
            self._leave()
        self.time_budget.tests += 1
        is_valid, message = self.validate_test(the_test)
        the_test.set_validity(is_valid, message)
        if self.road_visualizer:
            self.road_visualizer.visualize_road_test(the_test)
        tried: TestResult = ("INVALID", message, [])
        begun = time.monotonic()
        if is_valid:
            outcome, description, records = self._execute(the_test)
            if records and self.time_budget.get_remaining_real_time() <= 0:
                self._leave()
            settle(the_test, outcome, description, records, compute_all_features(the_test, records))
            tried = (outcome, description, [] if outcome == "ERROR" else records)
        self.store_test(the_test)
        self._count(tried, generating, time.monotonic() - begun)
        return tried

    def _count(self, tried: TestResult, generating: float, executing: float) -> None:
        outcome, description, records = tried
        self.stats.add(outcome, description)
        self.stats.test_generation_real_times.append(generating)
        if outcome != "INVALID":
            self.stats.test_execution_real_times.append(executing)
            self.stats.test_execution_simulation_times.append(records[-1].timer if records else 0.0)
        self.start_generation_time = time.monotonic()

    def _leave(self) -> None:
        self.timeout_forced = True
        log.warning("budget used up")
        sys.exit(OVER)

    def validate_test(self, the_test: Any) -> Tuple[bool, str]:
        """Returns what the validator says; this takes time of the budget, but does not count as a test."""
        return self.test_validator.validate_test(the_test)

    def store_test(self, the_test: Any) -> None:
        path = Path(self.result_folder, f"test.{the_test.id:04d}.json")
        path.write_text(the_test.to_json(), encoding="utf-8")

    def is_over(self) -> bool:
        return self.time_budget.is_over()

    def is_force_timeout(self) -> bool:
        return self.timeout_forced

    def get_remaining_time(self) -> Remaining:
        return self.time_budget.get_remaining_time()

    def get_elapsed_time(self) -> float:
        return time.monotonic() - self.time_budget.get_start_time()

    def get_stats(self) -> TestGenerationStatistic:
        return self.stats

    def close(self) -> None:
        self._close()

    @abstractmethod
    def _close(self) -> None:
        """Releases resources."""

    @abstractmethod
    def _execute(self, the_test: Any) -> TestResult:
        if not self.time_budget.can_run_a_test():
            self._leave()
        return "ERROR", "the executor does not define how a test is executed", []


class MockExecutor(AbstractTestExecutor):
    """Cannot be used: RoadGPT drives the tests, and the competition's mock executor invents outcomes."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        raise RuntimeError(HANDED)

    def _close(self) -> None: ...

    def _execute(self, the_test: Any) -> TestResult:
        raise RuntimeError(HANDED)


def settle(test: Any, outcome: str, description: str, records: List[Any], features: Dict[str, float]) -> None:
    test.execution_data = records
    test.test_outcome = outcome
    test.description = description
    test.features = features


__all__ = ["AbstractTestExecutor", "Budget", "MockExecutor", "SimulationDataRecord"]
