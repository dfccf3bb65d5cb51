"""Executors: the workers of a campaign, one way of having them per file.

An executor is a class, made with a WorkerConfig. It runs jobs and decides nothing: which tests there are, and what
becomes of their results, is the business of the one process that made it, which alone writes the store. So a
way of having workers needs six methods:

    share(name, value)      a value that jobs may need; sent to a worker at most once
    forget(name)            no later job needs it
    submit(jobs)            run these some time, in this order as far as it goes; returns at once
    done(seconds) -> list   what has ended since the last call; waits so long for the first of them
    map(function, items)    as ``campaign.model.Pool`` has it; goes before all jobs that have not begun
    stop()                  end every worker now, whatever it does

and ``under_way()``, which tells who does what. A job runs ``function(item, *values)`` with the values that
it needs; functions stand at the top of a module. It runs at least once: a worker that dies or hangs (no sign
of life, or longer at one job than the Staff's patience) is replaced, and its job given to another, until it
has cost ``MOST_DEATHS`` of them. A job ends with exactly one Done. Jobs of one campaign give the same values
wherever and however often they run, so an executor needs no memory of its own.

``prepare`` runs once in each worker, before its first job: it imports what takes seconds to import.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

T = TypeVar("T")
U = TypeVar("U")

MOST_DEATHS = 3  # of workers, over one job; then it is the job that kills them


@dataclass(frozen=True)
class WorkerConfig:
    """Whom a campaign works with."""

    workers: int
    prepare: Callable[[], object]
    patience: float
    """Seconds for one job; who takes longer hangs."""
    log: Path
    """Takes what workers print."""
    address: str = ""
    """Where the workers are, for executors that ask."""


@dataclass(frozen=True)
class Job:
    """Something to be done by whichever worker is free."""

    key: int
    """Comes back with what became of it."""
    function: Callable[..., Any]
    item: Any
    needs: tuple[str, ...] = ()
    """Names of shared values, which the function is given after the item."""


@dataclass(frozen=True)
class FinishedJob:
    """What became of a job: a value, an error that its function raised, or that it was given up."""

    key: int
    value: Any = None
    error: Exception | None = None
    lost: str = ""
    """Why it was given up; empty for one that ended."""


@dataclass(frozen=True)
class RunningJob:
    """Who does what."""

    key: int
    worker: str
    seconds: float
    """Since it was begun."""


class Executor(Protocol):
    """Workers; see the head of this module."""

    def __init__(self, staff: WorkerConfig) -> None: ...

    def share(self, name: str, value: Any) -> None:
        """Keep a value for jobs that need it."""
        ...

    def forget(self, name: str) -> None:
        """Let go of a shared value."""
        ...

    def submit(self, jobs: Sequence[Job]) -> None:
        """Have jobs done."""
        ...

    def done(self, seconds: float) -> list[FinishedJob]:
        """What has ended; none where nothing did in that time.

        Raises:
            RoadGPTError: there are no workers, and there will be none.
        """
        ...

    def under_way(self) -> list[RunningJob]:
        """What is being done now."""
        ...

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """``function`` of every item, in their order."""
        ...

    def stop(self) -> None:
        """End every worker."""
        ...


__all__ = ["MOST_DEATHS", "Executor", "FinishedJob", "Job", "RunningJob", "WorkerConfig"]
