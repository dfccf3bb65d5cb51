"""The executor ``processes``: workers that are processes on this machine.

For each worker, a thread in the campaign's process sends it jobs and receives its answers, even while the
main thread is busy. This executor does not use ``ProcessPoolExecutor``, which loses all jobs when one
process dies."""

import math
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from pathlib import Path
from typing import TypeVar

from roadgpt.campaign.single_test import WorkerSetup
from roadgpt.campaign.workers import Worker, WorkerConfig, WorkerPool, set_paths, shorten, value_in
from roadgpt.drive.isolation.process import Child, pickled
from roadgpt.errors import RoadGPTError
from roadgpt.run.atomic import refuse_links
from roadgpt.stopping import look

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
START = 60.0  # s, at least, for a process to start on a busy machine, and to prepare itself


class Process(Child, Worker):
    """A worker that is a process of its own."""

    def __init__(self, staff: WorkerConfig) -> None:
        """Starts the process, which prints into the log. Raises OSError."""
        # every worker has one core, so libraries in it must not start threads of their own
        alone = {name: "1" for name in ONE_THREAD if name not in os.environ}
        with staff.log.open("ab") as file:
            Child.__init__(self, "roadgpt.campaign.workers", stderr=file, env=alone)
        self._staff = staff

    def begin(self, prepare: Callable[[], object]) -> None:
        """Prepares the process for jobs."""
        paths: tuple[object, ...] = (set_paths, ([*sys.path],), {})
        for call in (paths, (prepare, (), {})):
            value_in(self.ask(max(self._staff.patience, START), pickled(call)))

    def run(self, call: bytes) -> bytes:
        """Runs a job, and returns its value or error."""
        try:
            data: bytes = self.ask(self._staff.patience, call)
        finally:
            shorten(self._staff.log)
        return data


class Processes(WorkerPool):
    """Workers that are processes of this machine."""

    def __init__(self, staff: WorkerConfig) -> None:
        """Takes the settings; the workers start with the first jobs."""
        self.printed = staff.log
        super().__init__(staff)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Ends the workers when all jobs are done, or at once, even in the middle of a job."""
        super().shutdown(wait, cancel_futures=cancel_futures)
        shorten(self._staff.log)

    def _start(self) -> Process:
        try:
            return Process(self._staff)
        except OSError as error:
            raise RoadGPTError(
                f"a worker cannot be started ({error.strerror or error}); ask for fewer with -j"
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
