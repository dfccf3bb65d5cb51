"""Executors: plug-ins that run the jobs of a campaign on workers. Each file defines one kind of worker.

An executor is a class whose constructor takes a WorkerConfig; ``Executor`` describes its methods. An executor
only runs jobs. The process that created it chooses the tests, receives their results, and is the only one
that writes the store.

A job runs ``function(item, *values)`` with the shared values that it needs; the function must be defined at
the top level of a module. A worker hangs if it sends no sign of life, or takes longer for one job than
``WorkerConfig.patience``. A worker that dies or hangs is replaced, and its job runs again on another worker;
a job that has cost ``MOST_DEATHS`` workers is given up. Each job ends with exactly one FinishedJob. A job
that is run again, on any worker, returns the same value, so an executor keeps no record of past jobs.

``WorkerConfig.prepare`` runs once in each worker before its first job; it imports the modules that take
seconds to import.
"""

from collections.abc import Sequence
from typing import Any, Protocol

from roadgpt.campaign.jobs import MOST_DEATHS, FinishedJob, Job, RunningJob, WorkerConfig
from roadgpt.campaign.model import Pool

__all__ = ["MOST_DEATHS", "Executor", "FinishedJob", "Job", "RunningJob", "WorkerConfig"]


class Executor(Pool, Protocol):
    """The interface of executors. The items of ``map`` go to free workers before the jobs that wait."""

    def __init__(self, staff: WorkerConfig) -> None: ...

    def share(self, name: str, value: Any) -> None:
        """Keeps a value under a name, for the jobs that list this name in ``Job.needs``; it is sent to each
        worker at most once."""
        ...

    def forget(self, name: str) -> None:
        """Drops a shared value that no later job needs."""
        ...

    def submit(self, jobs: Sequence[Job]) -> None:
        """Queues jobs and returns at once; the jobs begin roughly in the given order."""
        ...

    def done(self, seconds: float) -> list[FinishedJob]:
        """Returns the jobs that have ended since the last call; waits at most ``seconds`` for the first one.

        Raises:
            RoadGPTError: no workers are left, and none can be started.
        """
        ...

    def under_way(self) -> list[RunningJob]:
        """Returns the jobs that are running, and the worker of each."""
        ...

    def stop(self) -> None:
        """Ends every worker at once."""
        ...
