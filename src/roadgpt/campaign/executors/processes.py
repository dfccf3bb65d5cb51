"""The executor ``processes``: workers that are processes on this machine.

For each worker, a thread in the campaign's process sends it jobs and receives its answers, even while the
main thread is busy. This executor does not use ``ProcessPoolExecutor``, which loses all jobs when one
process dies.
"""

import math
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

from roadgpt import children
from roadgpt.campaign.single_test import WorkerSetup
from roadgpt.campaign.workers import (
    ERROR,
    Worker,
    WorkerConfig,
    WorkerEndedError,
    WorkerPool,
    pickled,
    receive,
    send,
    shorten,
    unpickled,
)
from roadgpt.errors import RoadGPTError
from roadgpt.run.atomic import refuse_links
from roadgpt.stopping import look

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
FAREWELL = 10.0  # s for an idle process to end
START = 60.0  # s, at least, for a process to start on a busy machine, and to prepare itself
PATIENCE = 1.0  # s for a process in the middle of a job to end its child processes and itself


class Process(Worker):
    """A worker that is a process of its own."""

    def __init__(self, name: str, staff: WorkerConfig) -> None:
        """Starts the process, which prints into the log. Raises OSError."""
        # every worker has one core, so libraries in it must not start threads of their own
        alone = {name: "1" for name in ONE_THREAD if name not in os.environ}
        with staff.log.open("ab") as file:
            self._process = children.python("roadgpt.campaign.workers", stderr=file, env=alone)
        super().__init__(f"{name} ({self._process.pid})")
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._down, self._up = self._process.stdin, self._process.stdout
        self._staff = staff
        self._asked = 0.0  # when it was asked to end, seconds of the monotonic clock; 0: it was not
        self._fault = ""  # why it was killed

    def begin(self, prepare: Callable[[], object]) -> None:
        """Prepares the process for jobs."""
        with suppress(OSError):  # the process has ended, which the next message reports
            send(self._down, [*sys.path])
        kind, what = self._answer(pickled((prepare, (), {})), max(self._staff.patience, START))
        if kind == ERROR:
            raise unpickled(what)

    def run(self, call: bytes) -> tuple[str, bytes]:
        """Runs a job, and returns how it ended."""
        return self._answer(call, self._staff.patience)

    def _answer(self, call: bytes, patience: float) -> tuple[str, bytes]:
        is_jobs_fault = self._process.poll() is None  # it may have ended while it had nothing to do
        limit = min(patience, threading.TIMEOUT_MAX)
        clock = threading.Timer(limit, self.kill, [f"took longer than {patience:g} s"])
        clock.daemon = True
        clock.start()
        try:
            send(self._down, call)
            kind, what = receive(self._up)
        except Exception:  # most often EOFError or OSError; whatever it is, there is no answer
            how = self._fault or children.ending(children.end(self._process))
            raise WorkerEndedError(how, is_jobs_fault) from None
        finally:
            clock.cancel()
            shorten(self._staff.log)
        return kind, what

    def ask_to_end(self) -> None:
        """Asks the process and those it has started, such as a simulator, to end."""
        children.ask_to_end(self._process)
        self._asked = self._asked or time.monotonic()

    def kill(self, fault: str = "") -> None:
        """Ends the process and those it has started; after a second, by force. ``fault`` says why."""
        self._fault = self._fault or fault
        self.ask_to_end()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(max(0.0, self._asked + PATIENCE - time.monotonic()))
        children.kill(self._process)

    def close(self) -> None:
        """Lets an idle process end, which sees the end of its input, and closes its simulator properly."""
        with suppress(OSError, ValueError):
            self._down.close()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(FAREWELL)
        children.end(self._process)
        self._up.close()


class Processes(WorkerPool):
    """Workers that are processes of this machine."""

    def __init__(self, staff: WorkerConfig) -> None:
        """Starts the workers."""
        self.printed = staff.log
        super().__init__(staff)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Ends the workers when all jobs are done, or at once, even in the middle of a job."""
        super().shutdown(wait, cancel_futures=cancel_futures)
        shorten(self._staff.log)

    def _start(self, name: str) -> Process:
        try:
            return Process(name, self._staff)
        except OSError as error:
            raise RoadGPTError(
                f"{name} cannot be started ({error.strerror or error}); ask for fewer with -j"
            ) from error


T = TypeVar("T")
U = TypeVar("U")

WAIT = 0.25  # s for results, between two looks for Ctrl-C


def unordered_map(function: Callable[[T], U], items: Sequence[T], workers: int, log: Path) -> Iterator[U]:
    """Runs a function at the top level of a module on many items, on worker processes or (with one) in this
    process, and yields each result as soon as it is ready. The workers end when the caller stops the
    iteration."""
    refuse_links(log)
    if workers <= 1:
        for item in items:
            look()
            yield function(item)
        return
    executor = Processes(WorkerConfig(workers, WorkerSetup(()), math.inf, log))
    try:
        left = {executor.submit(function, item) for item in items}
        while left:
            look()
            done, left = wait(left, WAIT, FIRST_COMPLETED)
            for future in done:
                yield future.result()
    finally:
        executor.shutdown(cancel_futures=True)
