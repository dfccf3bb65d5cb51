"""Our end of a driver's process: asks it, minds time and memory, ends it, or keeps it for the next driver."""

import os
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from subprocess import PIPE, SubprocessError, run

from roadgpt import children
from roadgpt.drive.apart import wire

TICK = 0.2  # s between two looks at the clock and at the memory
SHARE = 0.5  # of the machine's memory that a driver may take
MOST_IDLE = 4  # processes that are kept for drivers to come
BEGIN = 60.0  # s for a new process to be there


class GoneError(Exception):
    """The process is there no more; says why, to follow the driver's name."""

    def __init__(self, why: str, is_late: bool = False) -> None:
        super().__init__(why)
        self.is_late = is_late


class Process:
    """A process in which one driver sits at a time."""

    def __init__(self) -> None:
        """Starts it.

        Raises:
            OSError: the system refuses.
        """
        self._process = children.python("roadgpt.drive.apart.inside", stderr=None)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._down, self._up = self._process.stdin.fileno(), self._process.stdout.fileno()
        self._due: float | None = None
        self._why, self._is_late = "", False
        self._most = memory_limit()
        self.is_broken = False
        self.has_served = False
        """Did a driver sit in it before?"""
        self._ends = threading.Event()
        threading.Thread(target=self._watch, name="roadgpt-driver", daemon=True).start()

    def ask(self, kind: int, body: bytes, seconds: float) -> wire.Message:
        """Say something, and hear what it is answered.

        Raises:
            GoneError: it ended, or did not answer within so many seconds; then it is ended.
        """
        self._due = time.monotonic() + seconds
        try:
            wire.send(self._down, kind, body)
            answer = wire.receive(self._up, wire.MOST)
        except (OSError, EOFError):
            self.end()
            status = children.ending(self._process.returncode)
            raise GoneError(self._why or f"ended its own process (it {status})", self._is_late) from None
        except BaseException:  # we are to stop, or its time is up: its answer may still come
            self.end()
            raise
        self._due = None
        return answer

    def tell(self, kind: int) -> None:
        """Say something that is not answered."""
        with suppress(OSError):
            wire.send(self._down, kind)

    def end(self) -> None:
        """End it now, whatever it does."""
        self.is_broken = True
        self._due = None
        self._ends.set()
        children.end(self._process)

    @property
    def is_alive(self) -> bool:
        """Can it be asked?"""
        return not self.is_broken and self._process.poll() is None

    def _watch(self) -> None:
        """Kills a process that is late, too big, or has left others behind that hold its line."""
        last = time.monotonic()
        while not self._ends.wait(TICK):
            now, due = time.monotonic(), self._due
            if due is not None and now - last > 10 * TICK:  # we were stopped ourselves, and so its time
                self._due = due + now - last
            elif due is not None and now > due:
                self._is_late = True
                children.kill(self._process)
            elif (taken := _memory(self._process.pid)) > self._most:
                self._why = (
                    f"took {taken / 1e9:.1f} GB of memory, more than {SHARE:.0%} of this machine's: "
                    "let it keep less"
                )
                children.kill(self._process)
            elif self._process.poll() is not None:
                children.kill(self._process)
            last = now


def memory_limit() -> float:
    """Bytes that a driver may take: half of what the machine, or the container, has."""
    found = []
    with suppress(ValueError, OSError, AttributeError):
        found.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    with suppress(ValueError, OSError):
        found.append(int(Path("/sys/fs/cgroup/memory.max").read_text()))
    return SHARE * min(found) if found else float("inf")


def _memory(pid: int) -> int:
    """Bytes that a process takes; 0 where nobody tells (Windows)."""
    if sys.platform == "linux":
        with suppress(OSError, ValueError, IndexError):
            pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
            return pages * os.sysconf("SC_PAGE_SIZE")
    elif os.name == "posix":
        words = ["/bin/ps", "-o", "rss=", "-p", str(pid)]
        with suppress(OSError, ValueError, SubprocessError):
            told = run(words, stdout=PIPE, timeout=10, check=False)  # noqa: S603 - the system's own
            return 1024 * int(told.stdout)
    return 0


_idle: list[Process] = []
_lock = threading.Lock()


def take() -> Process:
    """A process that waits, or a new one.

    Raises:
        OSError: the system refuses.
    """
    with _lock:
        while _idle:
            process = _idle.pop()
            if process.is_alive:
                return process
            process.end()
    return Process()


def give_back(process: Process) -> None:
    """Keep a process for the next driver; the one in it is forgotten."""
    if not process.is_alive:
        process.end()
        return
    process.tell(wire.FORGET)
    with _lock:
        if len(_idle) < MOST_IDLE:
            _idle.append(process)
            return
    process.end()


if hasattr(os, "register_at_fork"):  # a copy of this process must not speak on our lines
    os.register_at_fork(after_in_child=_idle.clear)
