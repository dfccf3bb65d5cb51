"""Starts and ends child processes, and says what memory they take.

Ctrl-C in the terminal does not reach these child processes. When a child process is ended, the processes that
it started are ended as well."""

import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

FAREWELL = 10.0  # s in which a killed process must have ended
SHARE = 0.5  # of the machine's memory that one process may take
_APART: Mapping[str, Any] = (
    {"start_new_session": True}
    if os.name == "posix"
    else {"creationflags": getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)}
)
_running: "set[subprocess.Popen[bytes]]" = set()


def start(words: Sequence[str], **how: Any) -> "subprocess.Popen[bytes]":
    """Starts a process in a new session; ``how`` has further arguments of ``subprocess.Popen``. Raises
    OSError if it cannot be started."""
    process: subprocess.Popen[bytes] = subprocess.Popen(words, **_APART, **how)  # noqa: S603 - our callers' words
    _running.add(process)
    return process


def kill(process: "subprocess.Popen[bytes]") -> None:
    """Kills a process, which may have ended, and its child processes; does not wait for them."""
    if os.name == "posix":
        # the process group may outlive the process, so the group is signalled even if the process has ended
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    elif process.poll() is None:
        words = ["taskkill", "/F", "/T", "/PID", str(process.pid)]
        subprocess.run(words, capture_output=True, check=False)  # noqa: S603
    with suppress(OSError):
        process.kill()


def end(process: "subprocess.Popen[bytes]", patience: float = FAREWELL) -> None:
    """Ends a process and its child processes, and waits until it has ended, at most ``patience`` seconds."""
    kill(process)
    with suppress(subprocess.TimeoutExpired):
        process.wait(patience)
    _running.discard(process)


def kill_all() -> None:
    """Kills all processes that were started with this module, except those that were passed to ``end``."""
    for process in [*_running]:
        kill(process)


def end_with_all() -> None:
    """Ends this process and all that it has started."""
    kill_all()
    if os.name == "posix":
        os.killpg(os.getpgrp(), signal.SIGKILL)
    os._exit(1)


def private_streams() -> tuple[IO[bytes], IO[bytes]]:
    """Returns the standard input and output of this process, unbuffered, for the caller alone: other code
    then reads no input, and what it prints goes to standard error."""
    heard, said = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    return os.fdopen(heard, "rb"), os.fdopen(said, "wb")


def memory_limit() -> float:
    """Returns the memory limit of a process in bytes: half of the memory of the machine or the container,
    whichever is smaller. If the system does not state its memory, there is no limit (infinity)."""
    found = []
    with suppress(ValueError, OSError, AttributeError):
        found.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    with suppress(ValueError, OSError):
        found.append(int(Path("/sys/fs/cgroup/memory.max").read_text()))
    return SHARE * min(found) if found else float("inf")


def memory_of(pid: int) -> int:
    """Returns the bytes of memory that a process uses; 0 where the system does not say (Windows)."""
    if sys.platform == "linux":
        with suppress(OSError, ValueError, IndexError):
            pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
            return pages * os.sysconf("SC_PAGE_SIZE")
    elif os.name == "posix":
        words = ["/bin/ps", "-o", "rss=", "-p", str(pid)]
        with suppress(OSError, ValueError, subprocess.SubprocessError):
            told = subprocess.run(words, stdout=subprocess.PIPE, timeout=10, check=False)  # noqa: S603
            return 1024 * int(told.stdout)
    return 0
