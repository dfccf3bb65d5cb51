"""The job queue of an executor: waiting jobs, finished jobs, and the error that stopped all workers, if any.

An executor inherits from JobQueue and defines how a waiting job gets to a worker (``_hand_out``). The
executor's threads hold the condition ``_changed`` while they access the queue, and notify it when a job has
ended.
"""

import threading
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from roadgpt.campaign.jobs import MOST_DEATHS, FinishedJob, Job
from roadgpt.campaign.workers.messages import pickled, unpickled
from roadgpt.campaign.workers.process_loop import VALUE, apply_each
from roadgpt.errors import RoadGPTError

T = TypeVar("T")
U = TypeVar("U")

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


class JobQueue(ABC):
    """The waiting and finished jobs of an executor."""

    def __init__(self, workers: int) -> None:
        """Makes an empty queue for this number of workers."""
        self._size = workers
        self._changed = threading.Condition()
        self._shared: dict[str, bytes] = {}
        self._urgent: deque[QueuedJob] = deque()
        self._waiting: deque[QueuedJob] = deque()
        self._ended: deque[tuple[QueuedJob, int, bytes]] = deque()
        self._lost: deque[FinishedJob] = deque()
        self._broken: Exception | None = None

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
            self._changed.wait_for(lambda: self._ended or self._lost or self._broken, seconds)
            ended, lost = [*self._ended], [*self._lost]
            self._ended.clear()
            self._lost.clear()
            if self._broken is not None and not ended and not lost:
                raise self._broken
        return [_finished_job(work, kind, what) for work, kind, what in ended] + lost

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """Returns the results of ``function`` for all items, in order; raises any error that ``function``
        raises.

        Raises:
            RoadGPTError: three workers died while computing the same items, or no workers are left.
        """
        size = max(1, -(-len(items) // (CHUNKS * self._size)))
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

    @abstractmethod
    def _hand_out(self) -> None:
        """Gives waiting jobs to workers that are free, urgent jobs first."""

    def _news(self, has: set[str], works: Sequence[QueuedJob]) -> tuple[dict[str, bytes], tuple[str, ...]]:
        """Returns the shared values that a worker lacks for these jobs, and the names that it can drop.

        Updates ``has``, the names that the worker has.
        """
        old = tuple(name for name in has if name not in self._shared)
        wanted = [name for work in works for name in work.needs]
        new = {name: self._shared[name] for name in wanted if name not in has}
        has.difference_update(old)
        has.update(new)
        return new, old

    def _end(self, work: QueuedJob, kind: int, what: bytes) -> None:
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
            return
        end = FinishedJob(
            work.key or 0, lost=f"given up: {MOST_DEATHS} workers ended over it (the last one {how})"
        )
        if work.key is None:
            work.end = end
        else:
            self._lost.append(end)


def _finished_job(work: QueuedJob, kind: int, what: bytes) -> FinishedJob:
    try:
        value = unpickled(what)
    except Exception as error:  # an error whose class cannot be unpickled, for example
        return FinishedJob(work.key or 0, error=RuntimeError(f"an answer cannot be read: {error}"))
    return (
        FinishedJob(work.key or 0, value=value) if kind == VALUE else FinishedJob(work.key or 0, error=value)
    )
