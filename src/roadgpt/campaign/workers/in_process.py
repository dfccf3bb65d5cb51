"""An executor without workers: it runs the next job in this process when the caller asks for results."""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from roadgpt.campaign.jobs import FinishedJob, Job, RunningJob, WorkerConfig

T = TypeVar("T")
U = TypeVar("U")


class InProcess:
    """Runs jobs one after another in this process; see ``campaign.executors`` for each method."""

    def __init__(self, staff: WorkerConfig) -> None:
        self._values: dict[str, Any] = {}
        self._jobs: deque[Job] = deque()

    def share(self, name: str, value: Any) -> None:
        """Keeps a value under a name, for the jobs that list this name in ``Job.needs``."""
        self._values[name] = value

    def forget(self, name: str) -> None:
        """Drops a shared value."""
        self._values.pop(name, None)

    def submit(self, jobs: Sequence[Job]) -> None:
        """Queues jobs."""
        self._jobs.extend(jobs)

    def done(self, seconds: float) -> list[FinishedJob]:
        """Runs the next job, and returns it as a FinishedJob; returns an empty list if no job is queued."""
        if not self._jobs:
            return []
        job = self._jobs.popleft()
        try:
            return [FinishedJob(job.key, job.function(job.item, *(self._values[name] for name in job.needs)))]
        except Exception as error:  # whatever it is, it ends the session and is raised there
            return [FinishedJob(job.key, error=error)]

    def under_way(self) -> list[RunningJob]:
        """Returns an empty list: no job runs between two calls."""
        return []

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """Returns the results of ``function`` for all items, in the order of the items."""
        return [function(item) for item in items]

    def stop(self) -> None:
        """Drops the jobs that have not begun."""
        self._jobs.clear()
