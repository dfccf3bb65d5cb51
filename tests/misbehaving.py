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


def write(folder: Path, last_words: str, name: str = "misbehaves") -> None:
    """A module whose generator brings two tests and then does something else."""
    indented = "".join(f"        {line}\n" for line in last_words.splitlines())
    (folder / f"{name}.py").write_text(HEAD + indented)
