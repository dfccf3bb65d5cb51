"""A generator's budget as the competition hands it out: asked for, and counted down, in its process."""

import time
from typing import Any

REMAINING = "time-budget"  # the competition's key
PER_TEST = 35.0  # s: what one test takes in the competition's own pipeline


class Remaining(dict[str, float]):
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


class Budget:
    """Seconds of wall time, a number of tests, or both.

    Where tests alone are counted, the time that is left is told as what they would take in the competition:
    35 s each. So a generator that plans by the clock plans as it does there.
    """

    def __init__(
        self,
        generation_budget: float | None = None,
        execution_budget: float | None = None,
        time_budget: float | None = None,
        test_budget: int | None = None,
    ) -> None:
        """The first two exist for the sake of their names; the competition has not used them since 2022."""
        self.generation_budget = generation_budget
        self.execution_budget = execution_budget
        self._has_clock = time_budget is not None
        self.time_budget = PER_TEST * (test_budget or 0) if time_budget is None else time_budget
        """Seconds; generators multiply it, so it is always a number."""
        self.test_budget = test_budget
        self.tests = 0
        self.start_real_time = time.monotonic()

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
