"""What executors share: jobs and their shared values, the messages and main loop of a worker process, and a
pool of workers that may die.

A pool has a thread for each worker that gives it one job after another. A worker that has ended is replaced,
and its job runs again on another one, as soon as one is free.

The first jobs of a worker process set the module search paths, and prepare it. A worker sends the pickled
value or error of each job. Calls and values are pickled one by one; if one cannot be unpickled, only its own
job is lost. ``pickled`` and ``unpickled`` serve processes that RoadGPT started on one machine, and the
executor ``ray``, whose workers may run on other machines of its cluster. Nothing else is read."""

import os
import pickle
import sys
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import count
from pathlib import Path
from queue import Empty, PriorityQueue
from typing import Any, Generic, TypeVar

from roadgpt.drive.isolation.process import GoneError, pickled, serve
from roadgpt.errors import RoadGPTError

T = TypeVar("T")


@dataclass(frozen=True)
class WorkerConfig:
    """Settings of the workers, which a campaign passes to its executor."""

    workers: int
    prepare: Callable[[], object]
    patience: float  # longest time for one job, seconds; a worker that takes longer is treated as hanging
    log: Path  # the file to which the output of workers is written
    address: str = ""  # the address of the workers, for executors that connect to other machines


class LostWorkerError(RoadGPTError):
    """A job was given up, because each worker that ran it ended."""


class Shared(Generic[T]):
    """An argument of many jobs, such as a cell. The functions of jobs receive it as it is, and read its
    ``value``. It is pickled once, and unpickled once in each worker that meets the same bytes again soon."""

    def __init__(self, value: T) -> None:
        self.value = value

    @cached_property
    def _data(self) -> bytes:
        return pickled(self.value)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._data,)


@lru_cache(maxsize=256)  # blocks of designs of two cells, up to 100 MB
def _restored(data: bytes) -> Shared[Any]:
    return Shared(unpickled(data))


VALUE, ERROR = "value", "error"  # how a job ended


def main() -> None:
    """Runs the jobs that the parent process sends, until the parent ends."""
    serve(answer)


def set_paths(paths: list[str]) -> None:
    """Sets the module search paths, which the jobs after this one need."""
    sys.path[:] = paths


def answer(call: bytes) -> bytes:
    """Runs a job: a pickled function, its arguments and its keyword arguments; returns its value or error for
    ``value_in``."""
    try:
        function, args, named = unpickled(call)
        return pickled((VALUE, function(*args, **named)))
    except Exception as error:  # whatever it is, the parent has to hear of it
        return portable(error)


def portable(error: Exception) -> bytes:
    """Returns an error for ``value_in``; if it cannot be pickled, a RuntimeError with its type and text."""
    try:
        data = pickled((ERROR, error))
        unpickled(data)
    except Exception:  # pickling may fail in any way
        return pickled((ERROR, RuntimeError(f"{type(error).__name__}: {error}")))
    return data


def value_in(data: bytes) -> Any:
    """Returns the value of a job, or raises its error."""
    kind, found = unpickled(data)
    if kind == ERROR:
        raise found
    return found


def unpickled(data: bytes) -> Any:
    """Returns the value that was pickled into these bytes."""
    return pickle.loads(data)  # noqa: S301 - from our own process


MOST_DEATHS = 3  # of workers that ran the same job; after that many, the job is to blame
FIRST, LATER = 0, 1  # calls of ``map`` go before other jobs


class Job(Future[Any]):
    """A call that any worker may run, and what becomes of it."""

    def __init__(self, call: tuple[Any, ...], urgency: int, number: int) -> None:
        super().__init__()
        self.call = call  # the function, its arguments and its keyword arguments
        self.place = urgency, number  # jobs begin in this order; a job that runs again keeps its place
        self.deaths = 0

    def __lt__(self, other: "Job") -> bool:
        return self.place < other.place


class Worker(ABC):
    """A worker, as the campaign's process sees it."""

    is_ready = is_busy = False

    @abstractmethod
    def begin(self, prepare: Callable[[], object]) -> None:
        """Prepares the worker for jobs; raises any error of ``prepare``, or GoneError."""

    @abstractmethod
    def run(self, call: bytes) -> bytes:
        """Runs a job, see ``answer``, and returns its value or error; raises GoneError."""

    @abstractmethod
    def kill(self) -> None:
        """Ends a busy worker."""

    @abstractmethod
    def close(self) -> None:
        """Ends an idle worker properly, and cleans up after one that has ended."""


class WorkerPool(Executor, ABC):
    """The jobs and workers of an executor; a subclass defines how a worker is started. Each thread of a
    ThreadPoolExecutor has a worker of its own."""

    printed: object = "the log"  # where people find what workers printed

    def __init__(self, staff: WorkerConfig) -> None:
        """Takes the settings; the workers start with the first jobs."""
        self._staff = staff
        self._waiting: PriorityQueue[Job] = PriorityQueue()
        self._workers: list[Worker] = []
        self._broken: Exception | None = None
        self._in_vain = 0  # workers that ended before they were ready, since one last became ready
        self._jobs = count(1)
        self._own = threading.local()  # its ``worker`` is that of this thread
        self._threads = ThreadPoolExecutor(staff.workers, initializer=self._hire)

    @abstractmethod
    def _start(self) -> Worker:
        """Starts a worker; raises RoadGPTError if this is impossible."""

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Queues a job."""
        return self._add(LATER, fn, args, kwargs)

    def map(
        self,
        fn: Callable[..., T],
        *iterables: Iterable[Any],
        timeout: float | None = None,
        chunksize: int = 1,
    ) -> Iterator[T]:
        """Yields the results of calls, in order; these calls go to free workers before the jobs that wait."""
        calls = [*zip(*iterables, strict=False)]
        parts = [calls[first : first + chunksize] for first in range(0, len(calls), chunksize)]
        jobs = [self._add(FIRST, _for_each, (fn, part), {}) for part in parts]
        return (one for job in jobs for one in job.result(timeout))

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Ends the workers when all jobs are done, or at once, even in the middle of a job."""
        with ThreadPoolExecutor(self._staff.workers) as at_once:
            if cancel_futures:
                self._broken = self._broken or CancelledError()
                at_once.map(lambda each: each.kill(), [each for each in self._workers if each.is_busy])
            self._threads.shutdown(wait)
            if wait:
                at_once.map(self._dismiss, [*self._workers])

    def _add(self, urgency: int, function: Any, args: tuple[Any, ...], named: dict[str, Any]) -> Job:
        if self._broken is not None:
            raise self._broken
        job = Job((function, args, named), urgency, next(self._jobs))
        self._waiting.put(job)
        self._threads.submit(self._run_all)
        return job

    def _hire(self) -> None:
        """Starts the worker of this thread, again if it ends before it is ready."""
        self._own.worker = None
        while self._broken is None:
            worker = None
            try:
                worker = self._start()
                self._workers.append(worker)
                worker.is_busy = True
                if self._broken is not None:  # the executor was stopped meanwhile
                    worker.kill()
                worker.begin(self._staff.prepare)
                worker.is_ready, worker.is_busy, self._in_vain = True, False, 0
                self._own.worker = worker
                return
            except GoneError as ended:
                self._in_vain += 1
                if self._in_vain >= MOST_DEATHS:
                    sentence = f"workers end before they begin (the last one {ended})"
                    error = RoadGPTError(f"{sentence}; {self.printed} has what they printed")
                    self._broken = self._broken or error
            except Exception as error:  # whatever it is, those who wait for jobs have to hear of it
                self._broken = self._broken or error
            if worker is not None:
                self._dismiss(worker)

    def _dismiss(self, worker: Worker) -> None:
        worker.close()
        self._workers.remove(worker)

    def _run_all(self) -> None:
        """Runs the jobs that wait, the most urgent first, also one that another thread has not begun yet."""
        with suppress(Empty):
            while True:
                job = self._waiting.get_nowait()
                if job.running() or job.set_running_or_notify_cancel():
                    self._run(job)

    def _run(self, job: Job) -> None:
        worker: Worker | None = self._own.worker
        if worker is not None:
            worker.is_busy = True  # before the look: who stops the executor kills the busy ones
        if worker is None or self._broken is not None:
            job.set_exception(self._broken or CancelledError())
            return
        try:
            data = worker.run(pickled(job.call))
        except GoneError as ended:
            self._dismiss(worker)
            self._give_again(job, ended)
            self._hire()
            return
        except Exception as error:  # the call cannot be pickled, for example
            data = portable(error)
        worker.is_busy = False
        try:
            job.set_result(value_in(data))
        except Exception as error:  # that of the job, or its value cannot be read
            job.set_exception(error)

    def _give_again(self, job: Job, ended: GoneError) -> None:
        """Queues the job of a worker that has ended; gives it up if too many workers ended over it."""
        job.deaths += not ended.is_blameless
        if job.deaths >= MOST_DEATHS and self._broken is None:
            workers = f"{MOST_DEATHS} workers ended over it (the last one {ended})"
            job.set_exception(LostWorkerError(f"given up: {workers}"))
            return
        self._waiting.put(job)
        with suppress(RuntimeError):  # after a shutdown, threads still run what waits
            self._threads.submit(self._run_all)


def _for_each(function: Callable[..., T], calls: Sequence[tuple[Any, ...]]) -> list[T]:
    return [function(*args) for args in calls]


class InProcess(Executor):
    """Runs each job in this process, as soon as it is submitted."""

    def __init__(self, staff: WorkerConfig) -> None:
        """Takes the settings that every executor takes, and needs none of them."""

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Runs the job; the Future that is returned has its result."""
        ended: Future[T] = Future()
        try:
            ended.set_result(fn(*args, **kwargs))
        except Exception as error:  # whatever it is, it is raised where the result is asked for
            ended.set_exception(error)
        return ended


LOG = "workers.log"
LONGEST_LOG = 4_000_000  # bytes; then only the end is kept
KEPT_OF_LOG = 1_000_000  # bytes of it
NOTE = b"[what was printed before is left out]\n"


def shorten(log: Path) -> None:
    """Keeps only the end of a log that has become too long, to which workers still append; a log that cannot
    be read or written must not stop a campaign."""
    with suppress(OSError):
        if log.stat().st_size <= LONGEST_LOG:
            return
        with log.open("rb") as file:
            file.seek(-KEPT_OF_LOG, os.SEEK_END)
            _, _, end = file.read(KEPT_OF_LOG).partition(b"\n")
        os.truncate(log, 0)
        with log.open("ab") as file:
            file.write(NOTE + end)
