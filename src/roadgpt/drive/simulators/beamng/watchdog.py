"""Ends calls to BeamNG that do not come back.

beamngpy blocks for ever where BeamNG hangs, and where it has a timeout it connects anew in silence and waits
again, without its Hello and with the answer lost. So a thread of ours looks at the clock: what is overdue
loses its process and its sockets, which makes the blocked call raise; a call that connects anew loses the
next socket as well, until it gives up.
"""

import socket
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress

TICK = 0.1  # s between two looks at the clock


class OverdueError(Exception):
    """A call did not come back in time."""


class Watchdog:
    """Watches the calls of one session."""

    def __init__(self, sockets: Callable[[], Iterable[socket.socket]], kill: Callable[[], None]) -> None:
        """Watches nothing yet.

        Args:
            sockets: those that a call may be blocked on, now.
            kill: ends the process that they lead to, where it is ours.
        """
        self._sockets, self._kill = sockets, kill
        self._due: float | None = None
        self.has_bitten = False

    @contextmanager
    def within(self, seconds: float, doing: str) -> Iterator[None]:
        """While this is open, a call that takes longer is ended.

        Raises:
            OverdueError: in place of whatever the ended call raised.
        """
        done = threading.Event()
        self.due_in(seconds)
        watcher = threading.Thread(target=self._watch, args=(done,), name="roadgpt-beamng", daemon=True)
        watcher.start()
        try:
            yield
        except Exception as error:
            if self.has_bitten:
                raise OverdueError(f"BeamNG gave no answer within {seconds:g} s while {doing}") from error
            raise
        finally:
            done.set()
            watcher.join()

    def due_in(self, seconds: float) -> None:
        """Start the clock anew; for a loop of short calls under one watch."""
        self._due = time.monotonic() + seconds

    def pause(self) -> None:
        """Stop the clock while something else than BeamNG has its turn."""
        self._due = None

    def _watch(self, done: threading.Event) -> None:
        while not done.wait(TICK):
            due = self._due
            if due is not None and time.monotonic() > due:
                if not self.has_bitten:
                    self.has_bitten = True
                    self._kill()
                for each in self._sockets():
                    with suppress(OSError):
                        each.shutdown(socket.SHUT_RDWR)
