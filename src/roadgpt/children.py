"""Starts and ends child processes.

Ctrl-C in the terminal does not reach these child processes. When a child process is ended, the processes that
it started are ended as well."""

import os
import signal
import subprocess
import sys
import threading
import time
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
    """Starts a process in a new session; ``how`` has further arguments of ``subprocess.Popen``. Raises
    OSError if it cannot be started."""
    process: subprocess.Popen[bytes] = subprocess.Popen(words, **_APART, **how)  # noqa: S603 - our callers' words
    _running.add(process)
    return process


def python(entry: str, **how: Any) -> "subprocess.Popen[bytes]":
    """Starts a Python process that runs ``main()`` of a module and communicates through its standard streams.
    ``how`` is as in ``start``, but the variables in its ``env`` are added to the environment."""
    # -P: modules in the user's current folder do not replace ours
    words = [sys.executable, "-P", "-c", f"from {entry} import main; main()"]
    extra = how.pop("env", {})
    env = {**os.environ, **extra, "PYTHONUNBUFFERED": "1", "MPLBACKEND": "Agg"}
    return start(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=env, **how)


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


def ask_to_end(process: "subprocess.Popen[bytes]") -> None:
    """Asks a process that has called ``ends_its_own`` to end itself and its child processes, whose sessions
    ``kill`` would not reach; does not wait for them. On Windows, where it reaches them, nothing is done."""
    if os.name == "posix" and process.poll() is None:
        with suppress(OSError):
            process.terminate()


def ends_its_own() -> None:
    """Makes SIGTERM end this process and every process that it has started with this module."""

    def end_all(number: int, frame: object) -> None:
        kill_all()
        os._exit(128 + number)

    signal.signal(signal.SIGTERM, end_all)


def ends_with_parent() -> None:
    """Makes this process end within a second after its parent process."""

    def stay_while(parent: int) -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    threading.Thread(target=stay_while, args=(os.getppid(),), daemon=True).start()


def end(process: "subprocess.Popen[bytes]", patience: float = FAREWELL) -> int | None:
    """Ends a process and its child processes. Returns its exit status; None if it has not ended within
    ``patience`` seconds."""
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
    """Returns how a process ended, in words that can follow its name."""
    return f"was ended by signal {-status}" if status and status < 0 else f"ended with status {status}"


def private_streams() -> tuple[IO[bytes], IO[bytes]]:
    """Returns the standard input and output of this process, unbuffered, for the caller alone: other code
    then reads no input, and what it prints goes to standard error."""
    heard, said = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    return os.fdopen(heard, "rb"), os.fdopen(said, "wb")
