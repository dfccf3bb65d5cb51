import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

from roadgpt.campaign.executors import Executor
from roadgpt.campaign.executors.processes import Processes
from roadgpt.campaign.jobs import Job, WorkerConfig
from roadgpt.campaign.single_test import WorkerSetup
from roadgpt.campaign.workers.in_process import InProcess
from roadgpt.errors import RoadGPTError
from roadgpt.run.atomic import refuse_links
from roadgpt.stopping import look

T = TypeVar("T")
U = TypeVar("U")

WAIT = 0.25  # s for results, between two looks for Ctrl-C


def unordered_map(function: Callable[[T], U], items: Sequence[T], workers: int, log: Path) -> Iterator[U]:
    """Runs a function on many items, on worker processes or in this process, and yields each result as soon
    as it is ready. The workers end when the caller stops the iteration, for example with Ctrl-C.

    Args:
        function: a function at the top level of a module, or a ``partial`` of one.
        items: the argument of each call; with several workers, items and results must be picklable.
        workers: number of processes; 1: the function runs in this process.
        log: the file that receives what worker processes print.

    Raises:
        UsageError: the log is a symbolic link.
        RoadGPTError: workers cannot be started, or three of them died while working on the same item.
        Exception: any error that ``function`` raises.
    """
    refuse_links(log)
    kind: type[Executor] = Processes if workers > 1 else InProcess
    executor = kind(WorkerConfig(workers, WorkerSetup(()), math.inf, log))
    try:
        executor.submit([Job(key, function, item) for key, item in enumerate(items)])
        left = len(items)
        while left:
            look()
            for job in executor.done(WAIT):
                if job.error is not None or job.lost:
                    raise job.error or RoadGPTError(job.lost)
                left -= 1
                yield job.value
    finally:
        executor.stop()
