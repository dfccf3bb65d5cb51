"""The jobs of a campaign, which executors run on workers."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

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
    """The result of a job: what its function returned or raised, or why the executor gave the job up."""

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
