"""Our end of the line: starts a generator's process, hears it with a time limit, and ends it in any case.

Two threads read and write, so that a process that neither speaks nor listens holds up nobody.
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
from roadgpt.sbft.line import Message, received, send

NAMES = Path(__file__).with_name("names")  # our half in the generator's process; Python runs the folder
OURS = "ROADGPT_PYTHON"  # tells that half which interpreter RoadGPT is installed in, where it is another one


class GoneError(Exception):
    """The process is there no more; its exit status, negative for a signal."""

    def __init__(self, status: int | None) -> None:
        super().__init__(status)
        self.status = status


class Host:
    """One generator's process."""

    def __init__(self, log: Path, python: str | None = None) -> None:
        """Starts it in an interpreter, None: this one; what it prints goes into the file.

        Raises:
            UsageError: the interpreter cannot be started.
        """
        self._log = log.open("wb")
        own = {"PYTHONUNBUFFERED": "1", "MPLBACKEND": "Agg"}
        inherited = {name: value for name, value in os.environ.items() if name not in (OURS, "PYTHONHOME")}
        try:
            self._process = children.start(
                [python or sys.executable, str(NAMES)],
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
        """Say something, and do not wait for anybody to listen."""
        self._to_tell.put(message)

    def hear(self, seconds: float) -> Message | None:
        """The next message; None where none came in time.

        Raises:
            GoneError: there will be none any more.
        """
        try:
            message = self._heard.get(timeout=max(seconds, 0.0))
        except queue.Empty:
            return None
        if message is None:
            raise GoneError(self._status())
        return message

    def _status(self) -> int | None:
        try:
            return self._process.wait(children.FAREWELL)
        except subprocess.TimeoutExpired:
            return None

    def stop(self) -> None:
        """End the process and those that it started."""
        self._to_tell.put(None)
        children.end(self._process)
        self._log.close()
