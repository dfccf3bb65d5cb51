"""The executor ``processes``: workers that are processes on this machine.

For each worker, a thread in the campaign's process receives the worker's messages and sends it the next job,
even while the main thread is busy. One more thread watches for workers that hang. This executor does not use
``concurrent.futures``, whose pool loses all jobs when one process dies.
"""

import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from roadgpt import children
from roadgpt.campaign.jobs import WorkerConfig
from roadgpt.campaign.workers.job_queue import JobQueue, QueuedJob, QueueWorker
from roadgpt.campaign.workers.process_loop import ALIVE, receive, send
from roadgpt.campaign.workers.worker_log import shorten
from roadgpt.errors import RoadGPTError

SILENCE = 60.0  # s without a sign of life, after which a worker is killed; it sends one every second
ROUND = 0.5  # s between two looks at all workers

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
FAREWELL = 10.0  # s for an idle or killed process to end
PATIENCE = 1.0  # s for a process in the middle of a job to end its child processes and itself


class Worker(QueueWorker):
    """One process and the thread that receives its messages; the executor's lock guards its fields."""

    def __init__(self, name: str, log: Path, hear: "Callable[[Worker, str | None, bytes], None]") -> None:
        """Starts the process.

        Args:
            name: shown to people.
            log: the file that receives what the process prints.
            hear: called with (worker, kind, value) for every message except signs of life; called with kind
                None when the process has ended.
        """
        super().__init__(name)
        self.heard = self.begun
        self._asked = 0.0  # s on the monotonic clock, when the worker was asked to end; 0: it was not
        self._hear = hear
        # every worker has one core, so libraries in it must not start threads of their own
        alone = {name: "1" for name in ONE_THREAD if name not in os.environ}
        with log.open("ab") as file:
            self._process = children.python("roadgpt.campaign.workers.process_loop", stderr=file, env=alone)
        self.name += f" ({self._process.pid})"
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._down: IO[bytes] = self._process.stdin
        self._thread = threading.Thread(
            target=self._listen, args=(self._process.stdout,), name=name, daemon=True
        )

    def begin(self, prepare: bytes) -> None:
        """Prepares the worker for jobs, and starts the thread that receives its messages."""
        self._thread.start()
        self.say([*sys.path])
        self.say(prepare)

    def say(self, message: Any) -> None:
        """Sends the worker a message."""
        with suppress(OSError, ValueError):  # the process has ended; the listening thread reports this
            send(self._down, message)

    def _listen(self, stream: IO[bytes]) -> None:
        with suppress(EOFError, OSError, ValueError):
            while True:
                kind, what = receive(stream)
                self.heard = time.monotonic()
                if kind != ALIVE:
                    self._hear(self, kind, what)
        self._hear(self, None, b"")

    def ask_to_end(self) -> None:
        """Asks the worker and the processes it has started, such as a simulator, to end; does not wait."""
        if self.is_ready and not self.works:
            with suppress(OSError, ValueError):
                self._down.close()  # it sees the end of its input, and closes its simulator properly
        else:
            children.ask_to_end(self._process)
        self._asked = time.monotonic()

    def kill(self, fault: str = "") -> None:
        """Ends the worker's process and all processes it has started; after a second, by force."""
        self.fault = self.fault or fault
        children.ask_to_end(self._process)
        self._asked = self._asked or time.monotonic()
        self.join(max(0.0, self._asked + PATIENCE - time.monotonic()))
        children.kill(self._process)

    def bury(self) -> str:
        """Cleans up after the process, and returns how it ended; the worker's thread calls this last."""
        status = children.end(self._process)
        for stream in (self._down, self._process.stdout):
            with suppress(OSError):
                if stream is not None:
                    stream.close()
        return self.fault or children.ending(status)

    def join(self, patience: float = FAREWELL) -> None:
        """Waits at most ``patience`` seconds for the worker's thread, which ends after its process."""
        self._thread.join(patience)


class Processes(JobQueue[Worker]):
    """Workers that are processes of this machine."""

    def __init__(self, staff: WorkerConfig) -> None:
        """Starts the workers.

        Raises:
            RoadGPTError: the operating system cannot start a process.
        """
        super().__init__(staff)
        try:
            with self._changed:
                for _ in range(staff.workers):
                    self._hire()
        except RoadGPTError:
            self.stop()
            raise
        threading.Thread(target=self._watch, name="roadgpt-watch", daemon=True).start()

    def stop(self) -> None:
        """Ends every worker."""
        self._stops.set()
        with self._changed:
            leaving = [*self._workers]
            idle = [worker for worker in leaving if worker.is_ready and not worker.works]
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

    def _heard(self, worker: Worker, kind: str | None, what: bytes) -> None:
        """Handles a message of a worker, or its end; called by the worker's thread."""
        if kind is None:
            self._bury(worker)
            return
        with self._changed:
            self._hear(worker, [(kind, what)])
            self._changed.notify_all()

    def _send(self, worker: Worker, works: Sequence[QueuedJob]) -> None:
        worker.say(self._message(worker, works[0]))

    def _bury(self, worker: Worker) -> None:
        """Replaces a worker that has ended, and gives its job to another."""
        how = worker.bury()
        with self._changed:
            self._workers.remove(worker)
            if self._stops.is_set():
                return
            for work in worker.works:
                self._give_again(work, how)
            self._replace(worker, how, self._staff.log)
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
                elif (worker.works or not worker.is_ready) and now - worker.begun > self._staff.patience:
                    worker.kill(f"took longer than {self._staff.patience:g} s")
            shorten(self._staff.log)
            last = now
