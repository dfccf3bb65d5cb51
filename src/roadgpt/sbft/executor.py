"""The executor that a generator is handed, in the generator's own process.

It validates nothing and drives nothing itself: it sends road points down the line, and gives the generator
what comes back. Only ``validate_test`` answers on the spot.
"""

import logging
import sys
import threading
import time
from collections import namedtuple
from collections.abc import Callable
from pathlib import Path
from typing import Any

from roadgpt.sbft.budget import Budget, Remaining
from roadgpt.sbft.line import Message
from roadgpt.sbft.road_test import WRONG_TYPE, RoadTestFactory, TestValidator
from roadgpt.sbft.statistic import TestGenerationStatistic

log = logging.getLogger(__name__)

OVER = 123  # exit status with which the competition ends a generator that asks for more than its budget

# The competition's record of one moment; its fields are explained in roadgpt.run.execution.
SimulationDataRecord = namedtuple(
    "SimulationDataRecord",
    "timer pos dir vel steering steering_input brake brake_input throttle throttle_input wheelspeed vel_kmh "
    "is_oob oob_counter max_oob_percentage oob_distance oob_percentage",
)

Ask = Callable[[Message], Message]
Tried = tuple[str, str, list[SimulationDataRecord]]


class AbstractTestExecutor:
    """Takes tests, one at a time, until the budget is over."""

    def __init__(
        self,
        result_folder: str,
        map_size: int,
        time_budget: float | None = None,
        test_budget: int | None = None,
        ask: Ask | None = None,
        debug: bool = False,
    ) -> None:
        """An executor at this end of a line.

        Raises:
            RuntimeError: there is no line.
        """
        if ask is None:
            raise RuntimeError(
                "roadgpt sbft makes the executor and hands it to the generator; start the generator with it"
            )
        self.result_folder = result_folder
        self.map_size = map_size
        self.debug = debug
        self.stats = TestGenerationStatistic()
        self.time_budget = Budget(time_budget=time_budget, test_budget=test_budget)
        self.test_validator = TestValidator(map_size)
        self.road_visualizer: Any = None
        self.timeout_forced = False
        self.start_time = time.time()
        self.beamng_home = self.beamng_user = None
        self.start_generation_time: float | None = time.monotonic()
        self._ask = ask
        self._lock = threading.Lock()

    def start(self) -> None:
        """The budget runs from now on."""
        self.time_budget.start()
        self.start_time = time.time()
        self.start_generation_time = time.monotonic()

    def execute_test(self, the_test: Any) -> Tried:
        """Validate and drive a test: (outcome, description, execution data).

        Raises:
            SystemExit: the budget is over; the test is dropped, as the competition drops it.
        """
        with self._lock:
            begun = self.start_generation_time
            generating = 0.0 if begun is None else time.monotonic() - begun
            if self.time_budget.is_over():
                self._leave()
            answer = self._ask(_question(the_test, generating))
            if answer.get("is_over"):
                self._leave()
            tried = _settled(the_test, answer)
            self._count(tried, generating, answer["seconds"])
            self.start_generation_time = time.monotonic()
            return tried

    def _count(self, tried: Tried, generating: float, driving: float) -> None:
        outcome, description, records = tried
        self.time_budget.tests += 1
        self.stats.add(outcome, description)
        self.stats.test_generation_real_times.append(generating)
        if outcome != "INVALID":
            self.stats.test_execution_real_times.append(driving)
            self.stats.test_execution_simulation_times.append(records[-1].timer if records else 0.0)

    def _leave(self) -> None:
        self.timeout_forced = True
        log.warning("the budget is over")
        sys.exit(OVER)

    def validate_test(self, the_test: Any) -> tuple[bool, str]:
        """(is it valid, and the first complaint); costs no budget but time."""
        return self.test_validator.validate_test(the_test)

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

    def store_test(self, the_test: Any) -> None:
        """Write a test's file; every test that was executed has one already."""
        path = Path(self.result_folder, f"test.{the_test.id:04d}.json")
        path.write_text(the_test.to_json(), encoding="utf-8")

    def close(self) -> None:
        """Nothing is open."""


def _question(the_test: Any, generating: float) -> Message:
    """What is sent of a test; of something that is none, nothing."""
    is_test = type(the_test) is RoadTestFactory.RoadTest
    return {
        "op": "test",
        "is_test": is_test,
        "id": getattr(the_test, "id", None) if is_test else None,
        "points": [[float(x), float(y)] for x, y in the_test.road_points] if is_test else [],
        "generating": generating,
    }


def _settled(the_test: Any, answer: Message) -> Tried:
    """The answer as the competition gives it, and set on the test."""
    records = [SimulationDataRecord(*record) for record in answer["records"]]
    outcome, description = answer["outcome"], answer["description"]
    if answer["message"] != WRONG_TYPE:
        the_test.set_validity(answer["is_valid"], answer["message"])
        if answer["is_valid"]:
            the_test.execution_data = records
            the_test.test_outcome = outcome
            the_test.description = description
            the_test.features = answer["features"]
    return outcome, description, [] if outcome == "ERROR" else records
