"""A worker process: does one job after another, gives a sign of life every second, ends with its parent.

Down the wire come the paths of modules, what prepares a worker, and then jobs: the call (function, item,
names of values), values by name that are new here, names that are needed no more. Up go kinds of messages
with what belongs to them. Calls and values travel frozen, so that one that cannot be read costs one job.
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
ALIVE, READY, VALUE, ERROR = range(4)  # kinds of messages that go up


class JobMessage(NamedTuple):
    """A job as it goes down."""

    call: bytes
    new: dict[str, bytes]
    old: tuple[str, ...]


def apply_each(work: tuple[Callable[[Any], Any], Sequence[Any]]) -> list[Any]:
    """A function of each of some items."""
    function, items = work
    return [function(item) for item in items]


class _Sender:
    """Sends messages, one at a time; when nobody listens any more the process ends."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self._lock = threading.Lock()

    def say(self, kind: int, what: bytes = b"") -> None:
        try:
            with self._lock:
                send(self._stream, (kind, what))
        except OSError:
            os._exit(1)

    def beat(self) -> None:
        while True:
            time.sleep(BEAT)
            self.say(ALIVE)


def main() -> None:
    """Work until the parent goes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent hears of Ctrl-C, and ends us
    ends_its_own()
    heard, said = private_streams()
    mouth = _Sender(said)
    threading.Thread(target=mouth.beat, daemon=True).start()
    try:
        sys.path[:] = receive(heard)
        try:
            unpickled(receive(heard))()
        except Exception as error:  # whatever it is, the parent has to hear of it
            mouth.say(ERROR, portable(error))
            return
        mouth.say(READY)
        shared: dict[str, Any] = {}
        while True:
            mouth.say(*answer(receive(heard), shared))
    except EOFError:
        return


def answer(order: JobMessage, shared: dict[str, Any]) -> tuple[int, bytes]:
    """What comes of a job, as kind of message and what belongs to it; keeps the shared values."""
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
    """The error, or where it cannot travel, one that says the same."""
    try:
        data = pickled(error)
        unpickled(data)
    except Exception:  # pickling may fail in any way
        return pickled(RuntimeError(f"{type(error).__name__}: {error}"))
    return data
