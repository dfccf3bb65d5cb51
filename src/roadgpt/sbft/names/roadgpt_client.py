"""RoadGPT as a test generator in the SBFT tool competition's own environment, and in any other.

The competition pins Python below 3.11 and libraries that RoadGPT does not work with, so RoadGPT lives in an
environment of its own. This one file is all that the competition's environment needs: it is of the standard
library alone, runs on Python 3.8 and newer, starts RoadGPT over there and asks it for roads.

    export ROADGPT_PYTHON=/path/to/roadgpt/environment/bin/python
    python competition.py --time-budget 3600 --module-name roadgpt_client --class-name RoadGPTTestGenerator

What roads is said by the environment (ROADGPT_DESCRIPTION, ROADGPT_SEED, ROADGPT_DESIGNER, ROADGPT_READER) or
by a class of one's own:

    from roadgpt_client import RoadGPTTestGenerator

    class Hairpins(RoadGPTTestGenerator):
        description = "three hairpins"
        seed = 7

Licence: Apache-2.0, as RoadGPT's.
"""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
import threading
from importlib import import_module
from importlib.util import find_spec
from typing import IO, Any, Dict, Iterator, List, Optional, Tuple

log = logging.getLogger(__name__)

PYTHON = "ROADGPT_PYTHON"  # names the interpreter of the environment that RoadGPT is installed in
FAREWELL = 10.0  # s for a process that has nothing more to do

Message = Dict[str, Any]
Points = List[Tuple[float, float]]


class RoadGPTError(RuntimeError):
    """RoadGPT cannot be started, or cannot do what was asked for; its text is one sentence."""


def send(stream: IO[bytes], message: Message) -> None:
    """Write a message: one JSON value in a line. Numbers that are not finite travel as Python writes them."""
    stream.write(json.dumps(message, default=plain).encode() + b"\n")
    stream.flush()


def received(line: bytes) -> Optional[Message]:
    """The message in a line; None where there is none."""
    try:
        message = json.loads(line)
    except (ValueError, RecursionError):
        return None
    return message if isinstance(message, dict) else None


def plain(value: Any) -> Any:
    """Numbers and tables of other libraries, as numpy's."""
    listed = getattr(value, "tolist", None)
    return listed() if callable(listed) else str(value)


class RoadGPT:
    """RoadGPT at work in its own environment: a process that is asked, and answers."""

    def __init__(self, python: Optional[str] = None) -> None:
        """Starts it.

        Args:
            python: that RoadGPT is installed in; None: what ROADGPT_PYTHON says, or this one.

        Raises:
            RoadGPTError: it does not start.
        """
        self.python = python or os.environ.get(PYTHON) or _own()
        self._lock = threading.Lock()
        self._owner = os.getpid()
        try:
            self._process = subprocess.Popen(  # noqa: S603 - an interpreter that the user named
                [self.python, "-P", "-m", "roadgpt.sbft.answers"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={name: value for name, value in os.environ.items() if name != "PYTHONHOME"},
            )
        except OSError as error:
            raise RoadGPTError(
                f"{self.python} cannot be started ({error.strerror}); set {PYTHON} to the Python that "
                "RoadGPT is installed in"
            ) from error
        self.ask("hello")

    def ask(self, op: str, **values: Any) -> Any:
        """What is answered.

        Raises:
            RoadGPTError: RoadGPT says why it has no answer, or is gone.
        """
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
            raise RoadGPTError(
                f"RoadGPT ended without a word{self._status()}; is {self.python} the Python that it is "
                f"installed in? Else set {PYTHON} to that"
            )
        if "error" in answer:
            raise RoadGPTError(answer["error"])
        return answer["answer"]

    def _status(self) -> str:
        try:
            return f" (exit status {self._process.wait(FAREWELL)})"
        except subprocess.TimeoutExpired:
            return ""

    @property
    def is_ours(self) -> bool:
        """Was it started by this process, and not by the one that this one was forked from?"""
        return self._owner == os.getpid()

    def close(self) -> None:
        """Let it end."""
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
    raise RoadGPTError(
        f"RoadGPT is not installed in this Python ({sys.version.split()[0]}); set {PYTHON} to the Python "
        "that it is installed in"
    )


class RoadGPTTestGenerator:
    """Brings roads that keep a description, one after another, until the budget is over."""

    description: Optional[str] = None
    """What roads; where nobody says it, RoadGPT's usual ones."""
    seed = 0
    designer: Optional[str] = None
    reader: Optional[str] = None
    python: Optional[str] = None
    """The interpreter that RoadGPT is installed in, where ROADGPT_PYTHON does not say it."""

    def __init__(self, executor: Any = None, map_size: Optional[int] = None) -> None:
        """As the competition makes it."""
        self.executor = executor
        self.map_size = map_size

    def start(self) -> None:
        """Test after test.

        Raises:
            RoadGPTError: RoadGPT does not start, the description cannot be read, or no road can be designed.
        """
        factory = import_module("code_pipeline.tests_generation").RoadTestFactory
        for points in self.roads():
            if self.executor.is_over():
                return
            outcome, said, _ = self.executor.execute_test(factory.create_road_test(points))
            log.info("%s: %s", outcome, said)

    def roads(self) -> Iterator[Points]:
        """Road points without end, in metres: at most 2 m apart, at most 500, and valid for the competition.

        Raises:
            RoadGPTError: as ``start``.
        """
        asked = {
            name: getattr(self, name) for name in ("description", "seed", "designer", "reader", "map_size")
        }
        roadgpt = RoadGPT(os.environ.get(PYTHON) or self.python)
        try:
            roadgpt.ask("begin", **{name: value for name, value in asked.items() if value is not None})
            while True:
                yield [(x, y) for x, y in roadgpt.ask("next")]
        finally:
            roadgpt.close()
