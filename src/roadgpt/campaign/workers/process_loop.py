"""The main loop of a worker process: runs one job after another, and ends when its parent ends.

The parent sends the module search paths, the function that prepares the worker, and then jobs. The message of
a job holds the call (function, item, names of shared values), the shared values that the worker does not have
yet, and the names of shared values that the worker can drop. The worker sends a sign of life every second,
and the pickled value or error of each job. Calls and values are pickled one by one; if one cannot be
unpickled, only its own job is lost.
"""

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence
from typing import IO, Any, NamedTuple

from roadgpt.campaign.workers.messages import pickled, receive, send, unpickled
from roadgpt.children import ends_its_own, private_streams

BEAT = 1.0  # s between signs of life
ALIVE, READY, VALUE, ERROR = range(4)  # kinds of messages from a worker to its parent


class JobMessage(NamedTuple):
    """A job as it is sent to a worker."""

    call: bytes
    new: dict[str, bytes]
    old: tuple[str, ...]


def apply_each(work: tuple[Callable[[Any], Any], Sequence[Any]]) -> list[Any]:
    """Returns the results of a function for each of the items, as a list."""
    function, items = work
    return [function(item) for item in items]


class _Sender:
    """Sends messages, one at a time; ends the process when the parent is gone."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self._lock = threading.Lock()

    def send(self, kind: int, what: bytes = b"") -> None:
        try:
            with self._lock:
                send(self._stream, (kind, what))
        except OSError:
            os._exit(1)

    def beat(self) -> None:
        while True:
            time.sleep(BEAT)
            self.send(ALIVE)


def main() -> None:
    """Runs the jobs that the parent process sends, until the parent ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent hears of Ctrl-C, and ends us
    ends_its_own()
    received, sent = private_streams()
    sender = _Sender(sent)
    threading.Thread(target=sender.beat, daemon=True).start()
    try:
        sys.path[:] = receive(received)
        try:
            unpickled(receive(received))()
        except Exception as error:  # whatever it is, the parent has to hear of it
            sender.send(ERROR, portable(error))
            return
        sender.send(READY)
        shared: dict[str, Any] = {}
        while True:
            sender.send(*answer(receive(received), shared))
    except EOFError:
        return


def answer(order: JobMessage, shared: dict[str, Any]) -> tuple[int, bytes]:
    """Runs a job and updates the shared values; returns how the job ended, and its pickled value or error."""
    try:
        for name in order.old:
            shared.pop(name, None)
        for name, value in order.new.items():
            shared[name] = unpickled(value)
        function, item, needs = unpickled(order.call)
        return VALUE, pickled(function(item, *(shared[name] for name in needs)))
    except Exception as error:
        return ERROR, portable(error)


def portable(error: Exception) -> bytes:
    """Returns a pickled error. An error that cannot be pickled is replaced by a RuntimeError with its type
    and text.
    """
    try:
        data = pickled(error)
        unpickled(data)
    except Exception:  # pickling may fail in any way
        return pickled(RuntimeError(f"{type(error).__name__}: {error}"))
    return data
