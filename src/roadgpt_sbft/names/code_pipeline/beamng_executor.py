"""Defines the executor that a generator receives, under the name of the competition's executor for BeamNG. It
sends road points to RoadGPT, which validates and drives the road, and returns the results to the generator.
"""

from __future__ import annotations

import time
from typing import Any, Optional, Tuple

from code_pipeline.executors import HANDED, AbstractTestExecutor, TestResult, settle
from code_pipeline.tests_generation import RoadTestFactory
from self_driving.simulation_data import SimulationDataRecord

FloatDTuple = Tuple[float, float, float, float]
KMH = 3.6


class BeamngExecutor(AbstractTestExecutor):
    """Sends tests to ``roadgpt compete sbft``. A deep copy shares the connection and the budget's count of
    tests, but counts outcomes separately."""

    def __init__(
        self,
        result_folder: str,
        map_size: int,
        time_budget: Optional[float] = None,
        oob_tolerance: float = 0.95,
        max_speed_in_kmh: float = 70,
        beamng_home: Optional[str] = None,
        beamng_user: Optional[str] = None,
        road_visualizer: Any = None,
        debug: bool = False,
        test_budget: Optional[int] = None,
        connection: Any = None,
    ) -> None:
        if connection is None:
            raise RuntimeError(HANDED)
        super().__init__(result_folder, map_size, time_budget, road_visualizer, debug, test_budget)
        self.risk_value = 0.7
        """Aggression of BeamNG's driver, as the competition sets it."""
        self.oob_tolerance = oob_tolerance
        self.max_speed_in_ms = max_speed_in_kmh / KMH
        self.beamng_home, self.beamng_user = beamng_home, beamng_user
        self.brewer = self.vehicle = self.last_observation = None
        self.min_delta_position = 1.0
        self._connection = connection

    def execute_test(self, the_test: Any) -> TestResult:
        """Validates and drives a test, as ``AbstractTestExecutor`` says."""
        with self._connection.turn:
            generating = time.monotonic() - self.start_generation_time
            is_test = type(the_test) is RoadTestFactory.RoadTest
            asked = {
                "op": "test",
                "is_test": is_test,
                "id": getattr(the_test, "id", None) if is_test else None,
                "points": [[float(x), float(y)] for x, y in the_test.road_points] if is_test else [],
                "generating": generating,
            }
            answer = {} if self.time_budget.is_over() else self._connection.ask(asked)
            if not answer or answer["is_over"]:
                self._leave()
            records = [SimulationDataRecord(*record) for record in answer["records"]]
            outcome, description = answer["outcome"], answer["description"]
            if is_test:
                the_test.set_validity(answer["is_valid"], answer["message"])
                if answer["is_valid"]:
                    settle(the_test, outcome, description, records, answer["features"])
            tried = outcome, description, [] if outcome == "ERROR" else records
            self.time_budget.tests += 1
            self._count(tried, generating, answer["seconds"])
            if self.road_visualizer:
                self.road_visualizer.visualize_road_test(the_test)
            return tried

    def _execute(self, the_test: Any) -> TestResult:
        return self.execute_test(the_test)

    def end_iteration(self) -> None:
        """Does nothing; it exists because generators call it."""

    def _close(self) -> None: ...
