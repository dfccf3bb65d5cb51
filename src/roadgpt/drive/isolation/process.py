"""Manages the processes in which drivers run: sends requests to them, limits their time and memory, ends
them, and keeps them for reuse.

RoadGPT sends requests as pickles. A driver's process answers with a line of JSON, which can be read without
running the driver's code.
"""

import json
import os
import pickle
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from subprocess import PIPE, SubprocessError, run
from typing import Any

from roadgpt import children
from roadgpt.drive.driver_files import WRITTEN, folder_of
from roadgpt.reading import digest

TICK = 0.2  # s between two checks of the clock and the memory
SHARE = 0.5  # of the machine's memory that a driver may take
MOST_IDLE = 4  # maximum number of idle processes that are kept for later drivers
MOST = 1 << 24  # bytes, the longest answer


class GoneError(Exception):
    """Raised when a driver's process has ended; its message continues a sentence that starts with the
    driver's name, such as "ended its own process"."""

    def __init__(self, why: str, is_late: bool = False) -> None:
        super().__init__(why)
        self.is_late = is_late


class DriverProcess:
    """A child process that holds one driver at a time, and no other than ``spec``."""

    def __init__(self, spec: str) -> None:
        """Starts the process; raises OSError if the system cannot."""
        self._process = children.python("roadgpt.drive.isolation.child", stderr=None)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._down, self._up = self._process.stdin, self._process.stdout
        self._due: float | None = None
        self._why, self._is_late = "", False
        self._most = memory_limit()
        self.is_broken = False
        self.spec, self.files = spec, dict[str, str]()  # digests of the files that its drivers have used
        self.has_served = False
        """Whether the process has already held a driver."""
        self._ends = threading.Event()
        threading.Thread(target=self._watch, name="roadgpt-driver", daemon=True).start()

    def ask(self, seconds: float, what: str, *given: Any) -> dict[str, Any]:
        """Calls the method ``what`` in the driver's process, on the object that holds the driver, and
        returns the answer.

        After an error in that process, the keys of the answer are ``said`` (the message), ``is_users``
        (whether to raise a UsageError) and ``trace`` (the traceback).

        Raises:
            GoneError: the process ended, or was ended because it did not answer within ``seconds``, took too
                much memory or sent an invalid answer.
        """
        self._due = time.monotonic() + seconds
        try:
            self._send(what, *given)
            answer: dict[str, Any] = dict(json.loads(self._up.readline(MOST)))
        except (OSError, EOFError, ValueError, TypeError, RecursionError):
            self.end()
            status = children.ending(self._process.returncode)
            raise GoneError(self._why or f"ended its own process (it {status})", self._is_late) from None
        except BaseException:  # this process is asked to stop; a late answer must not be read by others
            self.end()
            raise
        self._due = None
        return answer

    def forget(self) -> None:
        """Tells the process to discard its driver, without waiting for it."""
        with suppress(OSError):
            self._send("forget")

    def _send(self, *request: Any) -> None:
        pickle.dump(request, self._down, pickle.HIGHEST_PROTOCOL)
        self._down.flush()

    def end(self) -> None:
        """Ends the process immediately."""
        self.is_broken = True
        self._due = None
        self._ends.set()
        children.end(self._process)

    @property
    def is_alive(self) -> bool:
        """Whether the process is running and can take requests."""
        return not self.is_broken and self._process.poll() is None

    def _watch(self) -> None:
        """Kills a process that is late, uses too much memory, or has ended and left children that hold its
        pipes open."""
        last = time.monotonic()
        while not self._ends.wait(TICK):
            now, due = time.monotonic(), self._due
            if due is not None and now - last > 10 * TICK:  # this process was suspended: the clock was too
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
    """Returns the memory limit of a driver in bytes: half of the memory of the machine or the container,
    whichever is smaller. If the system does not state its memory, there is no limit (infinity)."""
    found = []
    with suppress(ValueError, OSError, AttributeError):
        found.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    with suppress(ValueError, OSError):
        found.append(int(Path("/sys/fs/cgroup/memory.max").read_text()))
    return SHARE * min(found) if found else float("inf")


def _memory(pid: int) -> int:
    """Returns the bytes of memory that a process uses; 0 where the system does not say (Windows)."""
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


_idle: list[DriverProcess] = []
_lock = threading.Lock()


def take(spec: str) -> DriverProcess:
    """Returns an idle process of a driver, or starts a new one; raises OSError if the system cannot."""
    with _lock:
        for process in [each for each in _idle if each.spec == spec]:
            _idle.remove(process)
            files = process.files.items()  # it may have loaded them, so they must still be the same
            is_current = all(its in (WRITTEN, digest(folder_of(spec) / name)) for name, its in files)
            if process.is_alive and is_current:
                return process
            process.end()
    return DriverProcess(spec)


def give_back(process: DriverProcess) -> None:
    """Discards the driver of a process, and keeps the process for the next drive. If more than MOST_IDLE
    processes are idle then, the one that has been idle longest is ended."""
    if not process.is_alive:
        process.end()
        return
    process.forget()
    with _lock:
        _idle.append(process)
        if len(_idle) > MOST_IDLE:
            _idle.pop(0).end()


if hasattr(os, "register_at_fork"):  # a fork of this process must not use its pipes
    os.register_at_fork(after_in_child=_idle.clear)
