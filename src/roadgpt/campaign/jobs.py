"""Defines the jobs of a campaign, and the Executor, which runs them on workers (see ``executors``)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

T = TypeVar("T")
U = TypeVar("U")

MOST_DEATHS = 3  # of workers that ran the same job; after that many, the job is to blame


@dataclass(frozen=True)
class WorkerConfig:
    """Settings of the workers, which a campaign passes to its executor."""

    workers: int
    prepare: Callable[[], object]
    patience: float
    """Longest time for one job, seconds; a worker that takes longer is treated as hanging."""
    log: Path
    """The file to which the output of workers is written."""
    address: str = ""
    """The address of the workers, for executors that connect to other machines."""


@dataclass(frozen=True)
class Job:
    """A call that any free worker may run."""

    key: int
    """A value that identifies the job; its FinishedJob has the same key."""
    function: Callable[..., Any]
    item: Any
    needs: tuple[str, ...] = ()
    """Names of the shared values that the function receives after the item."""


@dataclass(frozen=True)
class FinishedJob:
    """The result of a job: the value that its function returned, the error that its function raised, or
    the reason why the executor gave the job up.
    """

    key: int
    value: Any = None
    error: Exception | None = None
    lost: str = ""
    """Why the job was given up; empty if its function returned or raised an error."""


@dataclass(frozen=True)
class RunningJob:
    """A job that a worker is running."""

    key: int
    worker: str
    seconds: float
    """Seconds since the job began."""


class Executor(Protocol):
    """The interface of executors."""

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

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """Returns the results of ``function`` for all items, in order. See ``campaign.model.Pool.map``.

        The items go to free workers before the jobs that wait in the queue.
        """
        ...

    def stop(self) -> None:
        """Ends every worker at once."""
        ...
