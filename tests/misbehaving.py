"""Generators that do what generators should not, and some that do as they should."""

from pathlib import Path

HEAD = """
import os, sys, time, signal, subprocess, threading, multiprocessing
from code_pipeline.tests_generation import RoadTestFactory

def straight(y=100.0):
    return [(60.0, y), (80.0, y), (100.0, y)]

class Generator:
    def __init__(self, executor=None, map_size=None):
        self.executor = executor
        self.map_size = map_size

    def two(self):
        for y in (90.0, 110.0):
            outcome, said, records = self.executor.execute_test(RoadTestFactory.create_road_test(straight(y)))
            assert outcome == "PASS", said
            assert len(records) > 10 and records[-1].timer > 1

    def start(self):
        self.two()
"""


# A search for the smallest distance from the edge, as a stranger would write it from the contract.
SEARCHER = """
import logging as log
import numpy as np
from code_pipeline.test_analysis import max_curvature
from code_pipeline.tests_generation import RoadTestFactory
from code_pipeline.validation import TestValidator
from self_driving.simulation_data import SimulationDataRecord

class Searcher:
    def __init__(self, executor=None, map_size=None):
        self.executor, self.map_size = executor, map_size
        self.validator = TestValidator(map_size)

    def road(self, bends):
        heading = np.pi / 2 + np.cumsum(np.repeat(bends, 8)) * 2
        steps = np.column_stack([np.cos(heading), np.sin(heading)]) * 2
        return [*np.cumsum([[self.map_size / 2, 30.0], *steps], axis=0)]

    def start(self):
        whole, worst, bends = self.executor.get_remaining_time()["time-budget"], np.inf, np.zeros(5)
        random = np.random.default_rng(1)
        while not self.executor.is_over():
            tried = bends + random.normal(0, 0.03, 5)
            test = RoadTestFactory.create_road_test([list(point) for point in self.road(tried)])
            assert self.validator.validate_test(test) == self.executor.validate_test(test)
            outcome, said, states = self.executor.execute_test(test)
            name, bend = max_curvature(test)
            log.info("%s %s %s %.3f", outcome, said, name, bend)
            if outcome == "INVALID":
                assert (test.is_valid, test.validation_message, states) == (False, said, [])
                continue
            assert type(states[0]) is SimulationDataRecord and test.test_outcome == outcome
            assert abs(test.features["MAX_CURV"] - bend) < 1e-5 and states == test.execution_data
            near = min(state.oob_distance for state in states)
            if near < worst:
                worst, bends = near, tried
        assert self.executor.get_stats().test_generated == 12
        assert self.executor.get_remaining_time()["time-budget"] < whole
        self.executor.close()
"""


def write(folder: Path, last_words: str, name: str = "misbehaves") -> None:
    """A module whose generator brings two tests and then does something else."""
    indented = "".join(f"        {line}\n" for line in last_words.splitlines())
    (folder / f"{name}.py").write_text(HEAD + indented)
