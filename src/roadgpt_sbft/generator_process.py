"""Starts a generator's process, exchanges messages with it under time limits, and ends it. Two threads read
and write messages, so that RoadGPT is not blocked by a generator that does not.
"""

import os
import queue
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import IO

from roadgpt import children
from roadgpt.errors import UsageError
from roadgpt_sbft.client import Message, received, send

NAMES = Path(__file__).with_name("names")  # the folder that the generator's interpreter runs
OURS = "ROADGPT_PYTHON"  # names RoadGPT's interpreter, if the generator runs in another one


class GeneratorExitedError(Exception):
    """A generator's process has ended. ``status``: its exit status, negative after a signal, None if
    unknown."""

    def __init__(self, status: int | None) -> None:
        super().__init__(status)
        self.status = status


class GeneratorProcess:
    """The process in which one generator runs."""

    def __init__(self, log: Path, python: str | None = None) -> None:
        """Starts the process in the interpreter ``python`` (None: the one that runs RoadGPT). All that the
        generator prints is written to the file ``log``."""
        self._log = log.open("wb")
        own = {"PYTHONUNBUFFERED": "1", "MPLBACKEND": "Agg"}
        inherited = {name: value for name, value in os.environ.items() if name not in (OURS, "PYTHONHOME")}
        try:
            self._process = children.start(
                [sys.executable, "-P", "-m", "roadgpt_sbft.answers", str(NAMES)]
                if python is None
                else [python, str(NAMES)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._log,
                env=inherited | own | ({} if python is None else {OURS: sys.executable}),
            )
        except OSError as error:
            self._log.close()
            raise UsageError(
                f"{python} cannot be started: {error.strerror}; name a Python with --python"
            ) from error
        self._heard: queue.SimpleQueue[Message | None] = queue.SimpleQueue()
        self._to_tell: queue.SimpleQueue[Message | None] = queue.SimpleQueue()
        assert self._process.stdout is not None
        assert self._process.stdin is not None
        for work, stream in ((self._read, self._process.stdout), (self._write, self._process.stdin)):
            threading.Thread(target=work, args=(stream,), name="roadgpt-sbft", daemon=True).start()

    def _read(self, stream: IO[bytes]) -> None:
        with suppress(OSError, ValueError):
            for line in stream:
                message = received(line)
                if message is not None:
                    self._heard.put(message)
        self._heard.put(None)

    def _write(self, stream: IO[bytes]) -> None:
        with suppress(OSError, ValueError):
            while (message := self._to_tell.get()) is not None:
                send(stream, message)

    def tell(self, message: Message) -> None:
        """Queues a message for the generator; does not wait until the message is read."""
        self._to_tell.put(message)

    def hear(self, seconds: float) -> Message | None:
        """Returns the next message; None if none arrives within ``seconds``. Raises GeneratorExitedError when
        the process has ended and all its messages were read."""
        try:
            message = self._heard.get(timeout=max(seconds, 0.0))
        except queue.Empty:
            return None
        if message is None:
            try:
                raise GeneratorExitedError(self._process.wait(children.FAREWELL))
            except subprocess.TimeoutExpired:
                raise GeneratorExitedError(None) from None
        return message

    def stop(self) -> None:
        """Ends the generator's process and its child processes."""
        self._to_tell.put(None)
        children.end(self._process)
        self._log.close()
