"""The main loop of a worker process: runs one job after another, and ends when its parent ends.

The parent sends the module search paths, the function that prepares the worker, and then jobs. The message of
a job holds the call (function, item, names of shared values), the shared values that the worker does not have
yet, and the names of shared values that the worker can drop. The worker sends a sign of life every second,
and the pickled value or error of each job. Calls and values are pickled one by one; if one cannot be
unpickled, only its own job is lost.

A message is a pickled value after its length. ``send`` and ``receive`` connect processes that RoadGPT started
on one machine. ``pickled`` and ``unpickled`` also serve the executor ``ray``, whose workers may run on other
machines of its cluster. Nothing else is read.
"""

import os
import pickle
import signal
import struct
import sys
import threading
import time
from collections.abc import Callable, Sequence
from typing import IO, Any, NamedTuple

from roadgpt.children import ends_its_own, private_streams

HEAD = struct.Struct("<Q")
BEAT = 1.0  # s between signs of life
ALIVE, READY, VALUE, ERROR = "alive", "ready", "value", "error"
"""Kinds of messages from a worker to its parent."""


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

    def send(self, kind: str, what: bytes = b"") -> None:
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


def answer(order: JobMessage, shared: dict[str, Any]) -> tuple[str, bytes]:
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
    """Returns a pickled error, or else a RuntimeError with its type and text if it cannot be pickled."""
    try:
        data = pickled(error)
        unpickled(data)
    except Exception:  # pickling may fail in any way
        return pickled(RuntimeError(f"{type(error).__name__}: {error}"))
    return data


def pickled(value: Any) -> bytes:
    """Returns a value as bytes."""
    return pickle.dumps(value, pickle.HIGHEST_PROTOCOL)


def unpickled(data: bytes) -> Any:
    """Returns the value that was pickled into these bytes."""
    return pickle.loads(data)  # noqa: S301 - from our own process


def send(stream: IO[bytes], message: Any) -> None:
    """Sends a message; raises OSError if the other process has ended."""
    body = pickled(message)
    stream.write(HEAD.pack(len(body)) + body)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """Returns the next message; raises EOFError if the other process has ended."""
    (length,) = HEAD.unpack(_exactly(stream, HEAD.size))
    return unpickled(_exactly(stream, length))


def _exactly(stream: IO[bytes], count: int) -> bytes:
    data = stream.read(count)
    if len(data) != count:
        raise EOFError
    return data
