"""Executors: what takes tests, one at a time, until the budget is over."""

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
from roadgpt_inside import elsewhere
from self_driving.simulation_data import SimulationDataRecord

log = logging.getLogger(__name__)

OVER = 123  # exit status with which the competition ends a generator that asks for more than its budget
HANDED = "roadgpt compete sbft makes the executor and hands it to the generator; start the generator with it"

Tried = Tuple[str, str, List[Any]]


REMAINING = "time-budget"  # the competition's key
PER_TEST = 35.0  # s: what one test takes in the competition's own pipeline


class Remaining(Dict[str, float]):
    """What is left. Since 2022 a dictionary; before, it was a number, and compares like one still."""

    def __float__(self) -> float:
        return self[REMAINING]

    def __lt__(self, other: Any) -> bool:
        return float(self) < float(other)

    def __le__(self, other: Any) -> bool:
        return float(self) <= float(other)

    def __gt__(self, other: Any) -> bool:
        return float(self) > float(other)

    def __ge__(self, other: Any) -> bool:
        return float(self) >= float(other)

    def __sub__(self, other: Any) -> float:
        return float(self) - float(other)

    def __rsub__(self, other: Any) -> float:
        return float(other) - float(self)

    def __format__(self, spec: str) -> str:
        return format(float(self), spec) if spec else str(self)


class Count:
    """A number that copies share."""

    tests = 0

    def __deepcopy__(self, memo: Any) -> Count:
        return self


class Budget:
    """Seconds of wall time, a number of tests, or both.

    Where tests alone are counted, the time that is left is told as what they would take in the competition:
    35 s each. So a generator that plans by the clock plans as it does there.
    """

    def __init__(
        self,
        time_budget: Optional[float] = None,
        generation_budget: Optional[float] = None,
        execution_budget: Optional[float] = None,
        test_budget: Optional[int] = None,
    ) -> None:
        """The second and third exist for the sake of their names; nothing has used them since 2022."""
        self.generation_budget = generation_budget
        self.execution_budget = execution_budget
        self._has_clock = time_budget is not None
        self.time_budget = PER_TEST * (test_budget or 0) if time_budget is None else time_budget
        """Seconds; generators multiply it, so it is always a number."""
        self.test_budget = test_budget
        self._count = Count()
        self.start_real_time: float = time.monotonic()

    @property
    def tests(self) -> int:
        """How many there were so far; copies of a budget count together."""
        return self._count.tests

    @tests.setter
    def tests(self, tests: int) -> None:
        self._count.tests = tests

    def start(self) -> None:
        """The clock runs from now on."""
        self.start_real_time = time.monotonic()

    def get_start_time(self) -> float:
        """On the monotonic clock."""
        return self.start_real_time

    def get_remaining_real_time(self) -> float:
        """Seconds."""
        if self._has_clock:
            return self.time_budget - (time.monotonic() - self.start_real_time)
        return PER_TEST * max((self.test_budget or 0) - self.tests, 0)

    def get_remaining_time(self) -> Remaining:
        """Under the competition's key, ``time-budget``."""
        return Remaining({REMAINING: self.get_remaining_real_time()})

    def can_run_a_test(self) -> bool:
        """Is anything left?"""
        has_tests = self.test_budget is None or self.tests < self.test_budget
        return has_tests and self.get_remaining_real_time() > 0

    def is_over(self) -> bool:
        """Is nothing left?"""
        return not self.can_run_a_test()


class AbstractTestExecutor(ABC):
    """Validates, executes, counts and writes tests; one of one's own says how a test is executed."""

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
        """The budget runs from now on."""
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
        """The budget runs from now on."""
        self.time_budget.start()
        self.start_time = time.time()
        self.start_generation_time: float = self.time_budget.get_start_time()

    def execute_test(self, the_test: Any) -> Tried:
        """Validate and execute a test: (outcome, description, execution data).

        Raises:
            SystemExit: the budget is over; the test is dropped, as the competition drops it.
        """
        generating = time.monotonic() - self.start_generation_time
        if self.time_budget.is_over():
            self._leave()
        self.time_budget.tests += 1
        is_valid, message = self.validate_test(the_test)
        the_test.set_validity(is_valid, message)
        if self.road_visualizer:
            self.road_visualizer.visualize_road_test(the_test)
        tried: Tried = ("INVALID", message, [])
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

    def _count(self, tried: Tried, generating: float, executing: float) -> None:
        outcome, description, records = tried
        self.stats.add(outcome, description)
        self.stats.test_generation_real_times.append(generating)
        if outcome != "INVALID":
            self.stats.test_execution_real_times.append(executing)
            self.stats.test_execution_simulation_times.append(records[-1].timer if records else 0.0)
        self.start_generation_time = time.monotonic()

    def _leave(self) -> None:
        self.timeout_forced = True
        log.warning("the budget is over")
        sys.exit(OVER)

    def validate_test(self, the_test: Any) -> Tuple[bool, str]:
        """(is it valid, and the first complaint); costs no budget but time."""
        return self.test_validator.validate_test(the_test)

    def store_test(self, the_test: Any) -> None:
        """Write a test's file."""
        path = Path(self.result_folder, f"test.{the_test.id:04d}.json")
        path.write_text(the_test.to_json(), encoding="utf-8")

    def is_over(self) -> bool:
        """Is the budget over?"""
        return self.time_budget.is_over()

    def is_force_timeout(self) -> bool:
        """Was the generator told to leave?"""
        return self.timeout_forced

    def get_remaining_time(self) -> Remaining:
        """Seconds, under the key ``time-budget``."""
        return self.time_budget.get_remaining_time()

    def get_elapsed_time(self) -> float:
        """Seconds of wall time."""
        return time.monotonic() - self.time_budget.get_start_time()

    def get_stats(self) -> TestGenerationStatistic:
        """Counts so far."""
        return self.stats

    def close(self) -> None:
        """Tests are over."""
        self._close()

    @abstractmethod
    def _close(self) -> None:
        """Let go of what was used."""

    @abstractmethod
    def _execute(self, the_test: Any) -> Tried:
        """Drive a valid test."""
        if not self.time_budget.can_run_a_test():
            self._leave()
        return "ERROR", "an executor says itself how a test is executed", []


class MockExecutor(AbstractTestExecutor):
    """The competition's invents outcomes; here there are real ones, of the executor that is handed over."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        """Not to be made.

        Raises:
            RuntimeError: always.
        """
        raise RuntimeError(HANDED)

    def _close(self) -> None:
        """Nothing is open."""

    def _execute(self, the_test: Any) -> Tried:
        raise RuntimeError(HANDED)


def settle(test: Any, outcome: str, description: str, records: List[Any], features: Dict[str, float]) -> None:
    """Set on a test what became of it."""
    test.execution_data = records
    test.test_outcome = outcome
    test.description = description
    test.features = features


__all__ = ["AbstractTestExecutor", "Budget", "MockExecutor", "SimulationDataRecord"]


def __getattr__(name: str) -> Any:
    return elsewhere.other(__name__, name)
