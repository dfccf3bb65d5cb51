"""Ends calls to BeamNG that do not return.

beamngpy blocks for ever if BeamNG hangs: after a timeout it silently reconnects without the first message
(Hello), and waits again. A thread therefore watches the time: when a call is overdue, it kills BeamNG's
process and closes the sockets, also new ones, until the blocked call fails.
"""

import socket
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress

TICK = 0.1  # s between two checks of the clock


class OverdueError(Exception):
    """Raised when a call to BeamNG did not return in time."""


class Watchdog:
    """Limits the time of each call to BeamNG in one session."""

    def __init__(self, sockets: Callable[[], Iterable[socket.socket]], kill: Callable[[], None]) -> None:
        """``sockets`` returns those on which a call may be blocked at present; ``kill`` ends a BeamNG process
        that RoadGPT started."""
        self._sockets, self._kill = sockets, kill
        self._due: float | None = None
        self.has_fired = False

    @contextmanager
    def within(self, seconds: float, doing: str) -> Iterator[None]:
        """Ends a call that takes longer than ``seconds``, and raises OverdueError in place of what the call
        raised; ``doing`` says what the call does."""
        done = threading.Event()
        self.due_in(seconds)
        watcher = threading.Thread(target=self._watch, args=(done,), name="roadgpt-beamng", daemon=True)
        watcher.start()
        try:
            yield
        except Exception as error:
            if self.has_fired:
                raise OverdueError(f"BeamNG gave no answer within {seconds:g} s while {doing}") from error
            raise
        finally:
            done.set()
            watcher.join()

    def due_in(self, seconds: float) -> None:
        """Restarts the time limit, so that a loop in one ``within`` block can limit each call."""
        self._due = time.monotonic() + seconds

    def pause(self) -> None:
        """Suspends the time limit until the next ``due_in``, for example while the driver computes."""
        self._due = None

    def _watch(self, done: threading.Event) -> None:
        while not done.wait(TICK):
            due = self._due
            if due is not None and time.monotonic() > due:
                if not self.has_fired:
                    self.has_fired = True
                    self._kill()
                for each in self._sockets():
                    with suppress(OSError):
                        each.shutdown(socket.SHUT_RDWR)
