"""Starts and ends child processes.

Ctrl-C in the terminal does not reach these child processes. When a child process is ended, the processes that
it started are ended as well."""

import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import IO, Any

FAREWELL = 10.0  # s in which a killed process must have ended
_APART: Mapping[str, Any] = (
    {"start_new_session": True}
    if os.name == "posix"
    else {"creationflags": getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)}
)
_running: "set[subprocess.Popen[bytes]]" = set()


def start(words: Sequence[str], **how: Any) -> "subprocess.Popen[bytes]":
    """Starts a process in a new session, so that Ctrl-C in the terminal does not reach it. ``how`` has
    further arguments of ``subprocess.Popen``.

    Raises:
        OSError: The operating system cannot start the process.
    """
    process: subprocess.Popen[bytes] = subprocess.Popen(words, **_APART, **how)  # noqa: S603 - our callers' words
    _running.add(process)
    return process


def python(entry: str, **how: Any) -> "subprocess.Popen[bytes]":
    """Starts a Python process that runs ``main()`` of a module and communicates through its standard streams.

    ``how`` has further arguments of ``subprocess.Popen``; the variables in its ``env`` are added to the
    current environment.

    Raises:
        OSError: The operating system cannot start the process.
    """
    words = [
        sys.executable,
        "-P",  # modules in the user's current folder do not replace ours
        "-c",
        f"from {entry} import main; main()",
    ]
    extra = how.pop("env", {})
    env = {**os.environ, **extra, "PYTHONUNBUFFERED": "1", "MPLBACKEND": "Agg"}
    return start(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=env, **how)


def kill(process: "subprocess.Popen[bytes]") -> None:
    """Kills a process and its child processes, without waiting until they have ended. The process may
    already have ended.
    """
    if os.name == "posix":
        # the process group may outlive the process, so the group is signalled even if the process has ended
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    elif process.poll() is None:
        words = ["taskkill", "/F", "/T", "/PID", str(process.pid)]
        subprocess.run(words, capture_output=True, check=False)  # noqa: S603
    with suppress(OSError):
        process.kill()


def ask_to_end(process: "subprocess.Popen[bytes]") -> None:
    """Asks a process that has called ``ends_its_own`` to end itself and its child processes; does not wait
    for them. ``kill`` would not reach these child processes, because they run in separate sessions. On
    Windows, where ``kill`` reaches them, nothing is done.
    """
    if os.name == "posix" and process.poll() is None:
        with suppress(OSError):
            process.terminate()


def ends_its_own() -> None:
    """Makes SIGTERM end this process and every process that it has started with this module."""
    signal.signal(signal.SIGTERM, _end_all)


def _end_all(number: int, frame: object) -> None:
    kill_all()
    os._exit(128 + number)


def end(process: "subprocess.Popen[bytes]", patience: float = FAREWELL) -> int | None:
    """Ends a process and its child processes. Returns the exit status of the process; None if it has not
    ended within ``patience`` seconds.
    """
    kill(process)
    with suppress(subprocess.TimeoutExpired):
        process.wait(patience)
    _running.discard(process)
    return process.returncode


def kill_all() -> None:
    """Kills all processes that were started with this module, except those that were passed to ``end``."""
    for process in [*_running]:
        kill(process)


def ending(status: int | None) -> str:
    """Returns how a process ended, in words that can follow the name of the process, such as 'was ended by
    signal 9'.
    """
    if status is not None and status < 0:
        return f"was ended by signal {-status}"
    return f"ended with status {status}"


def private_streams() -> tuple[IO[bytes], IO[bytes]]:
    """Returns the standard input and output of this process, unbuffered and for the caller's exclusive use.

    Afterwards, other code that reads standard input gets no data, and what other code prints goes to standard
    error.
    """
    heard, said = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    return os.fdopen(heard, "rb"), os.fdopen(said, "wb")
