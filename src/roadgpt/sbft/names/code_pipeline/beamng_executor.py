"""The executor that a generator is handed, under the name of the one that drives in BeamNG.

It validates nothing and drives nothing itself: it sends road points down the line, and gives the generator
what comes back. Only ``validate_test`` answers on the spot.
"""

from __future__ import annotations

import time
from copy import deepcopy
from typing import Any, Dict, Optional, Tuple

from code_pipeline.executors import HANDED, AbstractTestExecutor, Tried, settle
from code_pipeline.tests_generation import RoadTestFactory
from roadgpt_inside import elsewhere
from self_driving.simulation_data import SimulationDataRecord

FloatDTuple = Tuple[float, float, float, float]
KMH = 3.6


class BeamngExecutor(AbstractTestExecutor):
    """Sends tests to ``roadgpt compete sbft``. A deep copy shares the connection and has its own counts."""

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
        line: Any = None,
    ) -> None:
        """An executor at this end of a line.

        Raises:
            RuntimeError: there is no line.
        """
        if line is None:
            raise RuntimeError(HANDED)
        super().__init__(result_folder, map_size, time_budget, road_visualizer, debug, test_budget)
        self.risk_value = 0.7
        """BeamNG's own measure of how daring its driver is, as the competition sets it."""
        self.oob_tolerance = oob_tolerance
        self.max_speed_in_ms = max_speed_in_kmh / KMH
        self.beamng_home, self.beamng_user = beamng_home, beamng_user
        self.brewer = self.vehicle = self.last_observation = None
        self.min_delta_position = 1.0
        self._line = line

    def execute_test(self, the_test: Any) -> Tried:
        """Validate and drive a test: (outcome, description, execution data).

        Raises:
            SystemExit: the budget is over; the test is dropped, as the competition drops it.
        """
        with self._line.turn:
            generating = time.monotonic() - self.start_generation_time
            answer = {} if self.time_budget.is_over() else self._line.ask(_question(the_test, generating))
            if not answer or answer["is_over"]:
                self._leave()
            tried = _settled(the_test, answer)
            self.time_budget.tests += 1
            self._count(tried, generating, answer["seconds"])
            if self.road_visualizer:
                self.road_visualizer.visualize_road_test(the_test)
            return tried

    def _execute(self, the_test: Any) -> Tried:
        return self.execute_test(the_test)

    def end_iteration(self) -> None:
        """Nothing goes on."""

    def _close(self) -> None:
        """Nothing is open."""

    def __reduce__(self) -> Any:
        raise TypeError(
            "the executor works in the process that it was handed to; let others bring road points to it"
        )

    def __deepcopy__(self, memo: Dict[int, Any]) -> BeamngExecutor:
        made = object.__new__(type(self))
        memo[id(self)] = made
        made.__dict__.update({name: deepcopy(value, memo) for name, value in vars(self).items()})
        return made

    def __copy__(self) -> BeamngExecutor:
        made = object.__new__(type(self))
        made.__dict__.update(vars(self))
        return made


def _is_test(the_test: Any) -> bool:
    return type(the_test) is RoadTestFactory.RoadTest


def _question(the_test: Any, generating: float) -> Dict[str, Any]:
    """What is sent of a test; of something that is none, nothing."""
    is_test = _is_test(the_test)
    return {
        "op": "test",
        "is_test": is_test,
        "id": getattr(the_test, "id", None) if is_test else None,
        "points": [[float(x), float(y)] for x, y in the_test.road_points] if is_test else [],
        "generating": generating,
    }


def _settled(the_test: Any, answer: Dict[str, Any]) -> Tried:
    """The answer as the competition gives it, and set on the test."""
    records = [SimulationDataRecord(*record) for record in answer["records"]]
    outcome, description = answer["outcome"], answer["description"]
    if _is_test(the_test):
        the_test.set_validity(answer["is_valid"], answer["message"])
        if answer["is_valid"]:
            settle(the_test, outcome, description, records, answer["features"])
    return outcome, description, [] if outcome == "ERROR" else records


def __getattr__(name: str) -> Any:
    return elsewhere.other(__name__, name)
