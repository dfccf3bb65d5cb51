"""Controls one worker process from its parent: starts it, sends it jobs, receives its messages, ends it."""

import os
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from roadgpt import children
from roadgpt.campaign.workers.messages import receive, send
from roadgpt.campaign.workers.process_loop import ALIVE, JobMessage

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
FAREWELL = 10.0  # s for an idle or killed process to end
PATIENCE = 1.0  # s for a process in the middle of a job to end its child processes and itself


class Worker:
    """One process and the thread that receives its messages; the executor's lock guards its fields."""

    def __init__(self, name: str, log: Path, hear: "Callable[[Worker, int | None, bytes], None]") -> None:
        """Starts the process.

        Args:
            name: shown to people.
            log: the file that receives what the process prints.
            hear: called with (worker, kind, value) for every message except signs of life; called with kind
                None when the process has ended.
        """
        self.name = name
        self.is_ready = False
        self.job: Any = None
        """The job that the worker is running; None if it runs no job."""
        self.begun = self.heard = time.monotonic()
        self.has: set[str] = set()
        """Names of the shared values that were sent to the worker."""
        self.fault = ""
        """Why the worker was killed; empty if it ended by itself."""
        self._asked = 0.0  # s on the monotonic clock, when the worker was asked to end; 0: it was not
        self._hear = hear
        # every worker has one core, so libraries in it must not start threads of their own
        alone = {name: "1" for name in ONE_THREAD if name not in os.environ}
        with log.open("ab") as file:
            self._process = children.python("roadgpt.campaign.workers.process_loop", stderr=file, env=alone)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._down: IO[bytes] = self._process.stdin
        self._thread = threading.Thread(
            target=self._listen, args=(self._process.stdout,), name=name, daemon=True
        )

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    def begin(self, prepare: bytes) -> None:
        """Sends the worker the messages that prepare it for jobs, and starts the thread that receives its
        messages.
        """
        self._thread.start()
        self._say([*sys.path])
        self._say(prepare)

    def give(self, order: JobMessage) -> None:
        """Sends the worker a job."""
        self._say(order)

    def _say(self, message: Any) -> None:
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
        """Asks the worker and all processes that it has started, such as a simulator, to end; does not
        wait.
        """
        if self.is_ready and self.job is None:
            with suppress(OSError, ValueError):
                self._down.close()  # it sees the end of its input, and closes its simulator properly
        else:
            children.ask_to_end(self._process)
        self._asked = time.monotonic()

    def kill(self, fault: str = "") -> None:
        """Ends the process and all processes that it has started; uses force if it does not end within a
        second.
        """
        self.fault = self.fault or fault
        children.ask_to_end(self._process)
        self._asked = self._asked or time.monotonic()
        self.join(max(0.0, self._asked + PATIENCE - time.monotonic()))
        children.kill(self._process)

    def bury(self) -> str:
        """Cleans up after the process has ended, and returns how it ended; the worker's thread calls this
        last.
        """
        status = children.end(self._process)
        for stream in (self._down, self._process.stdout):
            with suppress(OSError):
                if stream is not None:
                    stream.close()
        return self.fault or children.ending(status)

    def join(self, patience: float = FAREWELL) -> None:
        """Waits at most ``patience`` seconds for the worker's thread to end; the thread ends after its
        process.
        """
        self._thread.join(patience)
