"""The executor ``processes``: workers that are processes of this machine, as many as are wished for.

A thread for each worker hears it and hands it its next job at once, whatever the campaign thinks about in the
meantime. One more thread watches for those that hang. concurrent.futures would not do: when one of its
processes dies, all that it was given is lost.
"""

import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from roadgpt.campaign.executors import MOST_DEATHS, Doing, Done, Job, Staff
from roadgpt.campaign.executors.processes.inside import READY, VALUE, Order, each
from roadgpt.campaign.executors.processes.wire import frozen, thawed
from roadgpt.campaign.executors.processes.worker import Worker
from roadgpt.errors import RoadGPTError

T = TypeVar("T")
U = TypeVar("U")

SILENCE = 60.0  # s without a sign of life, after which a worker is given up; one comes every second
ROUND = 0.5  # s between two looks at all workers
CHUNKS = 4  # per worker, that ``map`` makes of its items: few messages, and nobody waits long for the last


@dataclass(eq=False)
class _Work:
    """A job on its way."""

    call: bytes
    needs: tuple[str, ...]
    key: int | None
    """None for a part of a ``map``."""
    deaths: int = 0
    end: Done | None = None


class Processes:
    """Workers that are processes of this machine."""

    def __init__(self, staff: Staff) -> None:
        """Starts them.

        Raises:
            RoadGPTError: the system refuses.
        """
        self._staff = staff
        self._prepare = frozen(staff.prepare)
        self._changed = threading.Condition()
        self._shared: dict[str, bytes] = {}
        self._urgent: deque[_Work] = deque()
        self._waiting: deque[_Work] = deque()
        self._ended: deque[tuple[_Work, int, bytes]] = deque()
        self._lost: deque[Done] = deque()
        self._broken: Exception | None = None
        self._in_vain = 0  # workers that ended before they were ready, since the last that was
        self._started = 0
        self._stops = threading.Event()
        self._workers: list[Worker] = []
        try:
            with self._changed:
                for _ in range(staff.workers):
                    self._hire()
        except RoadGPTError:
            self.stop()
            raise
        threading.Thread(target=self._watch, name="roadgpt-watch", daemon=True).start()

    def share(self, name: str, value: Any) -> None:
        """Keep a value for jobs that need it."""
        self._shared[name] = frozen(value)

    def forget(self, name: str) -> None:
        """Let go of a shared value."""
        with self._changed:
            self._shared.pop(name, None)

    def submit(self, jobs: Sequence[Job]) -> None:
        """Have jobs done."""
        works = [_Work(frozen((job.function, job.item, job.needs)), job.needs, job.key) for job in jobs]
        with self._changed:
            self._waiting.extend(works)
            self._hand_out()

    def done(self, seconds: float) -> list[Done]:
        """What has ended; none where nothing did in that time.

        Raises:
            RoadGPTError: no worker could be made ready, or whatever prevented that.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._ended or self._lost or self._broken, seconds)
            ended, lost = [*self._ended], [*self._lost]
            self._ended.clear()
            self._lost.clear()
            if self._broken is not None and not ended and not lost:
                raise self._broken
        return [_told(work, kind, what) for work, kind, what in ended] + lost

    def under_way(self) -> list[Doing]:
        """What is being done now, by the workers' numbers."""
        now = time.monotonic()
        with self._changed:
            return [
                Doing(worker.job.key, f"{worker.name} ({worker.pid})", now - worker.begun)
                for worker in self._workers
                if worker.job is not None and worker.job.key is not None
            ]

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """``function`` of every item, in their order; what it raises is raised here.

        Raises:
            RoadGPTError: it ended three workers.
        """
        size = max(1, -(-len(items) // (CHUNKS * self._staff.workers)))
        parts = [items[first : first + size] for first in range(0, len(items), size)]
        works = [_Work(frozen((each, (function, [*part]), ())), (), None) for part in parts]
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

    def stop(self) -> None:
        """End every worker."""
        self._stops.set()
        with self._changed:
            leaving = [*self._workers]
        for worker in leaving:
            worker.kill()
        for worker in leaving:
            worker.join()

    def _hire(self) -> None:
        self._started += 1
        try:
            worker = Worker(f"worker {self._started}", self._staff.log, self._heard)
        except OSError as error:
            raise RoadGPTError(
                f"worker {self._started} cannot be started ({error.strerror or error}); ask for fewer with -j"
            ) from error
        self._workers.append(worker)
        worker.begin(self._prepare)

    def _heard(self, worker: Worker, kind: int | None, what: bytes) -> None:
        """By the worker's thread: it says something, or nothing ever again."""
        if kind is None:
            self._bury(worker)
            return
        with self._changed:
            if kind == READY:
                worker.is_ready, self._in_vain = True, 0
            elif worker.is_ready:
                self._end(worker.job, kind, what)
                worker.job = None
            else:
                self._broken = thawed(what)
            if not self._broken:
                self._next(worker)
            self._changed.notify_all()

    def _end(self, work: _Work, kind: int, what: bytes) -> None:
        if work.key is None:
            work.end = _told(work, kind, what)
        else:
            self._ended.append((work, kind, what))

    def _hand_out(self) -> None:
        for worker in self._workers:
            if worker.is_ready and worker.job is None:
                self._next(worker)

    def _next(self, worker: Worker) -> None:
        queue = self._urgent or self._waiting
        if not queue:
            return
        work = queue.popleft()
        worker.job, worker.begun = work, time.monotonic()
        old = tuple(name for name in worker.has if name not in self._shared)
        new = {name: self._shared[name] for name in work.needs if name not in worker.has}
        worker.has.difference_update(old)
        worker.has.update(new)
        worker.give(Order(work.call, new, old))

    def _bury(self, worker: Worker) -> None:
        """A worker is gone: its job is given to another, and another takes its place."""
        how = worker.bury()
        with self._changed:
            self._workers.remove(worker)
            if self._stops.is_set():
                return
            if worker.job is not None:
                self._give_again(worker.job, how)
            self._in_vain += not worker.is_ready
            if self._in_vain >= MOST_DEATHS and self._broken is None:
                self._broken = RoadGPTError(
                    f"workers end before they begin (the last one {how}); "
                    f"{self._staff.log} has what they said"
                )
            if self._broken is None:
                try:
                    self._hire()
                except RoadGPTError as error:
                    self._broken = error
            self._changed.notify_all()

    def _give_again(self, work: _Work, how: str) -> None:
        work.deaths += 1
        if work.deaths < MOST_DEATHS:
            (self._waiting if work.key is not None else self._urgent).appendleft(work)
            return
        end = Done(work.key or 0, lost=f"given up: {MOST_DEATHS} workers ended over it (the last one {how})")
        if work.key is None:
            work.end = end
        else:
            self._lost.append(end)

    def _watch(self) -> None:
        """Ends workers that hang; takes no lock, for whoever writes to a worker that hangs holds it."""
        last = time.monotonic()
        while not self._stops.wait(ROUND):
            now = time.monotonic()
            for worker in [*self._workers]:
                if now - last > 10 * ROUND:  # we were stopped ourselves, and have heard nobody
                    worker.heard = now
                elif now - worker.heard > SILENCE:
                    worker.kill(f"gave no sign of life for {SILENCE:g} s")
                elif (worker.job or not worker.is_ready) and now - worker.begun > self._staff.patience:
                    worker.kill(f"took longer than {self._staff.patience:g} s")
            last = now


def _told(work: _Work, kind: int, what: bytes) -> Done:
    try:
        value = thawed(what)
    except Exception as error:  # of a class that cannot be made again
        return Done(work.key or 0, error=RuntimeError(f"an answer cannot be read: {error}"))
    return Done(work.key or 0, value=value) if kind == VALUE else Done(work.key or 0, error=value)
