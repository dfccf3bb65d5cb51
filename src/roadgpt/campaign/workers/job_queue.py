"""What executors share: the queue of jobs, and the workers that they are sent to.

The executor's threads hold the condition ``_changed`` while they access the queue, and notify it when a job
has ended.
"""

import threading
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from roadgpt.campaign.jobs import MOST_DEATHS, FinishedJob, Job, RunningJob, WorkerConfig
from roadgpt.campaign.workers.process_loop import ERROR, READY, JobMessage, apply_each, pickled, unpickled
from roadgpt.errors import RoadGPTError

T = TypeVar("T")
U = TypeVar("U")

LOST = "lost"  # kind of the end of a job that was given up
CHUNKS = 4  # parts per worker into which ``map`` divides its items: few messages, no long wait for the last


@dataclass(eq=False)
class QueuedJob:
    """A job in the queue."""

    call: bytes
    needs: tuple[str, ...]
    key: int | None
    """Identifies the job; None for a job that computes some of the items of a ``map``."""
    deaths: int = 0
    end: FinishedJob | None = None


@dataclass(eq=False)
class QueueWorker:
    """A worker, as the campaign's process sees it."""

    name: str
    """Shown to people."""
    is_ready: bool = False
    works: list[QueuedJob] = field(default_factory=list)
    """The jobs that were sent to the worker and have not ended."""
    begun: float = field(default_factory=time.monotonic)
    """When these jobs were sent, or else when the worker was started."""
    has: set[str] = field(default_factory=set)
    """Names of the shared values that were sent to the worker."""
    fault: str = ""
    """Why the worker was ended; empty if it ended by itself."""


W = TypeVar("W", bound=QueueWorker)


class JobQueue(ABC, Generic[W]):
    """The jobs and the workers of an executor, which defines how a worker is hired and how it gets jobs."""

    def __init__(self, staff: WorkerConfig) -> None:
        self._staff = staff
        self._prepare = pickled(staff.prepare)
        self._changed = threading.Condition()
        self._stops = threading.Event()
        self._workers: list[W] = []
        self._started = 0
        self._in_vain = 0  # workers that ended before they were ready, since one last became ready
        self._shared: dict[str, bytes] = {}
        self._urgent: deque[QueuedJob] = deque()
        self._waiting: deque[QueuedJob] = deque()
        self._ended: deque[tuple[QueuedJob, str, bytes]] = deque()
        self._broken: Exception | None = None

    @abstractmethod
    def _hire(self) -> None:
        """Starts one more worker; raises RoadGPTError."""

    @abstractmethod
    def _send(self, worker: W, works: Sequence[QueuedJob]) -> None:
        """Sends jobs to a worker."""

    def share(self, name: str, value: Any) -> None:
        """Keeps a value under a name, for the jobs that list this name in ``Job.needs``."""
        self._shared[name] = pickled(value)

    def forget(self, name: str) -> None:
        """Drops a shared value."""
        with self._changed:
            self._shared.pop(name, None)

    def submit(self, jobs: Sequence[Job]) -> None:
        """Queues jobs and returns at once."""
        works = [QueuedJob(pickled((job.function, job.item, job.needs)), job.needs, job.key) for job in jobs]
        with self._changed:
            self._waiting.extend(works)
            self._hand_out()

    def done(self, seconds: float) -> list[FinishedJob]:
        """Returns the jobs that have ended since the last call; waits at most ``seconds`` for the first one.

        Raises:
            RoadGPTError: no worker could be started; if an error of another type was the cause, that error is
                raised instead.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._ended or self._broken, seconds)
            ended = [*self._ended]
            self._ended.clear()
            if self._broken is not None and not ended:
                raise self._broken
        return [_finished_job(*each) for each in ended]

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """Returns the results of ``function`` for all items, in order; raises any error of ``function``.

        Raises:
            RoadGPTError: three workers died while computing the same items, or no workers are left.
        """
        size = max(1, -(-len(items) // (CHUNKS * self._staff.workers)))
        parts = [items[first : first + size] for first in range(0, len(items), size)]
        works = [QueuedJob(pickled((apply_each, (function, [*part]), ())), (), None) for part in parts]
        with self._changed:
            self._urgent.extend(works)
            self._hand_out()
            self._changed.wait_for(lambda: self._broken or all(work.end for work in works))
            if self._broken is not None:
                raise self._broken
        found: list[U] = []
        for work in works:
            assert work.end is not None
            if work.end.lost:
                raise RoadGPTError(work.end.lost)
            if work.end.error is not None:
                raise work.end.error
            found += work.end.value
        return found

    def under_way(self) -> list[RunningJob]:
        """Returns the jobs that were sent to workers and have not ended, and the worker of each."""
        now = time.monotonic()
        with self._changed:
            return [
                RunningJob(work.key, worker.name, now - worker.begun)
                for worker in self._workers
                for work in worker.works
                if work.key is not None
            ]

    def _hand_out(self) -> None:
        """Gives waiting jobs to workers that are free, urgent jobs first."""
        for worker in self._workers:
            if worker.is_ready and not worker.works:
                self._next(worker)

    def _next(self, worker: W) -> None:
        works = self._some(self._urgent or self._waiting)
        if works:
            worker.begun, worker.works = time.monotonic(), works
            self._send(worker, works)

    def _some(self, waiting: deque[QueuedJob]) -> list[QueuedJob]:
        """Takes the jobs for one message."""
        return [waiting.popleft()] if waiting else []

    def _message(self, worker: W, work: QueuedJob) -> JobMessage:
        """Returns the message of a job, and notes in ``worker.has`` which values the worker then has."""
        old = tuple(name for name in worker.has if name not in self._shared)
        new = {name: self._shared[name] for name in work.needs if name not in worker.has}
        worker.has.difference_update(old)
        worker.has.update(new)
        return JobMessage(work.call, new, old)

    def _hear(self, worker: W, answers: Sequence[tuple[str, bytes]]) -> None:
        """Handles the answers of a worker to its jobs, or its answer when it was prepared."""
        if worker.is_ready:
            works, worker.works = worker.works, []
            for work, (kind, what) in zip(works, answers, strict=True):
                self._end(work, kind, what)
        elif answers[0][0] == READY:
            worker.is_ready, self._in_vain = True, 0
        else:
            self._broken = unpickled(answers[0][1])
        if self._broken is None:
            self._next(worker)

    def _end(self, work: QueuedJob, kind: str, what: bytes) -> None:
        if work.key is None:
            work.end = _finished_job(work, kind, what)
        else:
            self._ended.append((work, kind, what))

    def _give_again(self, work: QueuedJob, how: str) -> None:
        """Puts the job of a dead worker at the head of the queue; gives the job up if too many workers died
        while running it."""
        work.deaths += 1
        if work.deaths < MOST_DEATHS:
            (self._waiting if work.key is not None else self._urgent).appendleft(work)
        else:
            lost = f"given up: {MOST_DEATHS} workers ended over it (the last one {how})"
            self._end(work, LOST, pickled(lost))

    def _replace(self, worker: W, how: str, printed: object) -> None:
        """Hires another worker for one that has ended, unless workers end before they are ready; ``printed``
        is where people find what it printed."""
        self._in_vain += not worker.is_ready
        if self._in_vain >= MOST_DEATHS and self._broken is None:
            self._broken = RoadGPTError(
                f"workers end before they begin (the last one {how}); {printed} has what they printed"
            )
        if self._broken is None:
            try:
                self._hire()
            except RoadGPTError as error:
                self._broken = error


def _finished_job(work: QueuedJob, kind: str, what: bytes) -> FinishedJob:
    key = work.key or 0
    try:
        found = unpickled(what)
    except Exception as error:  # an error whose class cannot be unpickled, for example
        return FinishedJob(key, error=RuntimeError(f"an answer cannot be read: {error}"))
    if kind == LOST:
        return FinishedJob(key, lost=found)
    return FinishedJob(key, error=found) if kind == ERROR else FinishedJob(key, value=found)
