"""The executor ``processes``: workers that are processes on this machine.

For each worker, a thread in the campaign's process receives the worker's messages and sends it the next job,
even while the main thread is busy. One more thread watches for workers that hang. This executor does not use
``concurrent.futures``, whose pool loses all jobs when one process dies.
"""

import threading
import time

from roadgpt.campaign.executors.processes.worker import FAREWELL, Worker
from roadgpt.campaign.jobs import MOST_DEATHS, RunningJob, WorkerConfig
from roadgpt.campaign.workers.job_queue import JobQueue
from roadgpt.campaign.workers.messages import pickled, unpickled
from roadgpt.campaign.workers.process_loop import READY, JobMessage
from roadgpt.campaign.workers.worker_log import shorten
from roadgpt.errors import RoadGPTError

SILENCE = 60.0  # s without a sign of life, after which a worker is killed; it sends one every second
ROUND = 0.5  # s between two looks at all workers


class Processes(JobQueue):
    """Workers that are processes of this machine."""

    def __init__(self, staff: WorkerConfig) -> None:
        """Starts the workers.

        Raises:
            RoadGPTError: the operating system cannot start a process.
        """
        super().__init__(staff.workers)
        self._staff = staff
        self._prepare = pickled(staff.prepare)
        self._in_vain = 0  # workers that ended before they were ready, since one last became ready
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

    def under_way(self) -> list[RunningJob]:
        """Returns the running jobs, and the worker of each."""
        now = time.monotonic()
        with self._changed:
            return [
                RunningJob(worker.job.key, f"{worker.name} ({worker.pid})", now - worker.begun)
                for worker in self._workers
                if worker.job is not None and worker.job.key is not None
            ]

    def stop(self) -> None:
        """Ends every worker."""
        self._stops.set()
        with self._changed:
            leaving = [*self._workers]
            idle = [worker for worker in leaving if worker.is_ready and worker.job is None]
            for worker in leaving:
                worker.ask_to_end()
        due = time.monotonic() + FAREWELL
        for worker in idle:
            worker.join(max(0.0, due - time.monotonic()))
        for worker in leaving:
            worker.kill()
        for worker in leaving:
            worker.join()
        shorten(self._staff.log)

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
        """Handles a message of a worker, or its end; called by the worker's thread."""
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
                self._broken = unpickled(what)
            if not self._broken:
                self._next(worker)
            self._changed.notify_all()

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
        worker.give(JobMessage(work.call, *self._news(worker.has, [work])))

    def _bury(self, worker: Worker) -> None:
        """Replaces a worker that has ended, and gives its job to another."""
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
                    f"{self._staff.log} has what they printed"
                )
            if self._broken is None:
                try:
                    self._hire()
                except RoadGPTError as error:
                    self._broken = error
            self._changed.notify_all()

    def _watch(self) -> None:
        """Ends workers that hang, and shortens the log.

        Takes no lock, since a thread that writes to a hanging worker may hold it.
        """
        last = time.monotonic()
        while not self._stops.wait(ROUND):
            now = time.monotonic()
            for worker in [*self._workers]:
                if now - last > 10 * ROUND:  # this process was suspended, and received nothing
                    worker.heard = now
                elif now - worker.heard > SILENCE:
                    worker.kill(f"gave no sign of life for {SILENCE:g} s")
                elif (worker.job or not worker.is_ready) and now - worker.begun > self._staff.patience:
                    worker.kill(f"took longer than {self._staff.patience:g} s")
            shorten(self._staff.log)
            last = now
