"""Defines a test generator that runs RoadGPT from the Python environment of the SBFT tool competition, or
from any other environment.

The competition requires Python below 3.11 and libraries that do not work with RoadGPT, so RoadGPT is
installed in an environment of its own. The competition's environment needs only this file: it uses the
standard library alone, runs on Python 3.8 and newer, starts RoadGPT in RoadGPT's own environment, and
requests roads from it.

    export ROADGPT_PYTHON=/path/to/roadgpt/environment/bin/python
    python competition.py --time-budget 3600 --module-name roadgpt_client --class-name RoadGPTTestGenerator

RoadGPT is told the outcome of every road, and searches for roads on which the car fails. The roads are
controlled by environment variables (ROADGPT_DESCRIPTION, ROADGPT_SEED, ROADGPT_DESIGNER, ROADGPT_READER,
ROADGPT_SEARCH) or by a subclass:

    from roadgpt_client import RoadGPTTestGenerator

    class Hairpins(RoadGPTTestGenerator):
        description = "three hairpins"
        seed = 7

Licence: Apache-2.0, the same as RoadGPT's.
"""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
import threading
from importlib.util import find_spec
from typing import IO, Any, Dict, Iterator, List, Optional, Sequence, Tuple

log = logging.getLogger(__name__)

PYTHON = "ROADGPT_PYTHON"  # names the interpreter of the environment that RoadGPT is installed in
FAREWELL = 10.0  # s within which a process must end after its connection is closed

Message = Dict[str, Any]
Points = List[Tuple[float, float]]


class ClientError(RuntimeError):
    """Raised if RoadGPT cannot be started or cannot do what was requested; the message is one sentence."""


def send(stream: IO[bytes], message: Message) -> None:
    """Writes a message as one line of JSON. Numbers that are not finite are written as NaN or Infinity."""
    stream.write(json.dumps(message, default=plain).encode() + b"\n")
    stream.flush()


def received(line: bytes) -> Optional[Message]:
    """Returns the message in a line; None if the line is not a JSON object."""
    try:
        message = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return message if isinstance(message, dict) else None


def plain(value: Any) -> Any:
    """Converts numbers and arrays of other libraries to plain Python values, and any other value to text."""
    listed = getattr(value, "tolist", None)
    return listed() if callable(listed) else str(value)


class RoadGPT:
    """A process that runs RoadGPT in its own Python environment and answers requests."""

    def __init__(self, python: Optional[str] = None) -> None:
        """Starts the interpreter that RoadGPT is installed in; None: the one that ROADGPT_PYTHON names, or
        else the one that runs this code."""
        self.python = python or os.environ.get(PYTHON) or _own()
        self._lock = threading.Lock()
        self._owner = os.getpid()
        try:
            self._process = subprocess.Popen(  # noqa: S603 - an interpreter that the user named
                [self.python, "-P", "-m", "roadgpt_sbft.answers"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={name: value for name, value in os.environ.items() if name != "PYTHONHOME"},
            )
        except OSError as error:
            raise ClientError(
                f"{self.python} cannot be started ({error.strerror}); set {PYTHON} to the Python that "
                "RoadGPT is installed in"
            ) from error
        self.ask("hello")

    def ask(self, op: str, **values: Any) -> Any:
        """Sends a request for the operation ``op`` and returns the answer."""
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        with self._lock:
            try:
                send(stdin, {"op": op, **values})
                answer = received(stdout.readline())
            except (OSError, ValueError):
                answer = None
        if answer is None:
            raise ClientError(
                f"RoadGPT ended without an answer{self._status()}; check that it is installed in "
                f"{self.python}, or set {PYTHON} to the Python that it is installed in"
            )
        if "error" in answer:
            raise ClientError(answer["error"])
        return answer["answer"]

    def _status(self) -> str:
        try:
            return f" (exit status {self._process.wait(FAREWELL)})"
        except subprocess.TimeoutExpired:
            return ""

    @property
    def is_ours(self) -> bool:
        """False in a process that was forked after the start."""
        return self._owner == os.getpid()

    def close(self) -> None:
        """Closes the connection and waits for the RoadGPT process to end."""
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                stream.close()
        try:
            self._process.wait(FAREWELL)
        except subprocess.TimeoutExpired:
            self._process.kill()


def _own() -> str:
    if sys.version_info >= (3, 11) and find_spec("roadgpt") is not None:
        return sys.executable
    raise ClientError(
        f"RoadGPT is not installed in this Python ({sys.version.split()[0]}); set {PYTHON} to the Python "
        "that it is installed in"
    )


class ClientTestGenerator:
    """Submits roads that meet a description, one after another, until the budget is used up."""

    description: Optional[str] = None
    """The description of the roads; None: RoadGPT's default description."""
    seed = 0
    designer: Optional[str] = None
    reader: Optional[str] = None
    search: Optional[bool] = None
    """False: roads are drafted one after another, without regard to outcomes. None: they are searched for."""
    python: Optional[str] = None
    """Path of the interpreter in which RoadGPT is installed; ROADGPT_PYTHON takes precedence."""

    def __init__(self, executor: Any = None, map_size: Optional[int] = None) -> None:
        self.executor = executor
        self.map_size = map_size
        self._roadgpt: Optional[RoadGPT] = None

    def start(self) -> None:
        """Submits tests to the executor, one after another, until the budget is used up. Raises ClientError
        if RoadGPT does not start, cannot read the description, or finds no road."""
        # the competition has loaded it: only tests of this class may be executed
        factory = sys.modules["code_pipeline.tests_generation"].RoadTestFactory
        for points in self.roads():
            if self.executor.is_over():
                return
            outcome, said, records = self.executor.execute_test(factory.create_road_test(points))
            log.info("%s: %s", outcome, said)
            self.tell(outcome, records)

    def tell(self, outcome: str, records: Any) -> None:
        """Reports the outcome of the last road and its execution data, so that the search learns from it.
        Each record has ``steering`` and ``oob_distance``, and should have ``pos``."""
        steering = [float(record.steering) for record in records or ()]
        distances = [float(record.oob_distance) for record in records or ()]
        outside = min(records, key=lambda record: float(record.oob_distance)) if records else None
        place = getattr(outside, "pos", None)
        where = None if place is None else [float(value) for value in place[:2]]
        self.tell_columns(outcome, steering, distances, where)

    def tell_columns(
        self,
        outcome: str,
        steering: Sequence[float],
        distances: Sequence[float],
        outside: Optional[Sequence[float]] = None,
    ) -> None:
        """Does the same as ``tell`` with columns: the angle of the steering wheel in degrees, and
        ``oob_distance`` in metres; ``outside`` is the position of its smallest value, if known."""
        if self._roadgpt is not None:
            told = {"outcome": outcome, "steering": steering, "distances": distances, "outside": outside}
            self._roadgpt.ask("tell", **told)

    def roads(self) -> Iterator[Points]:
        """Yields roads without end, each as its control points in metres. The points are at most 2 m apart,
        there are at most 500 per road, and every road is valid in the competition."""
        asked = {
            name: getattr(self, name)
            for name in ("description", "seed", "designer", "reader", "search", "map_size")
        }
        asked["oob_tolerance"] = getattr(self.executor, "oob_tolerance", None)
        roadgpt = self._roadgpt = RoadGPT(os.environ.get(PYTHON) or self.python)
        try:
            roadgpt.ask("begin", **{name: value for name, value in asked.items() if value is not None})
            while True:
                yield [(x, y) for x, y in roadgpt.ask("next")]
        finally:
            self._roadgpt = None
            roadgpt.close()


# The names under which it competes and is imported by users; those of RoadGPT itself are the same.
RoadGPTTestGenerator, RoadGPTError = ClientTestGenerator, ClientError
