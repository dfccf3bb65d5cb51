"""Assigns a port and a user folder to each of several worker processes that use BeamNG at the same time.

Each worker locks a file; the system releases the lock when the worker ends, even if it is killed.
"""

import os
import shutil
import signal
import subprocess
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from typing import IO

from roadgpt.drive.simulators.beamng.launch import is_taken
from roadgpt.drive.simulators.beamng.settings import BeamngSettings
from roadgpt.errors import SimulatorError, UsageError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

MOST = 64  # workers on one machine
KEY = "tech.key"  # licence of BeamNG.tech, in the user folder or in that of a version


class Slot:
    """A port and a user folder that no other RoadGPT process uses."""

    def __init__(self, port: int, user: Path | None, lock: IO[str]) -> None:
        self.port, self.user, self._lock = port, user, lock

    def note(self, pid: int) -> None:
        """Stores the id of the process that listens on the port. If this worker is killed, a later worker can
        find and end that process.
        """
        self._lock.seek(0)
        self._lock.truncate()
        self._lock.write(str(pid))
        self._lock.flush()

    def release(self) -> None:
        """Makes the slot available to other processes."""
        self._lock.seek(0)
        self._lock.truncate()
        self._lock.close()


def take(settings: BeamngSettings) -> Slot:
    """Returns the first free slot.

    If RoadGPT starts BeamNG itself, ports on which a program already listens are skipped, because that
    program may not be BeamNG.

    Raises:
        UsageError: BeamNG cannot use the user folder.
        SimulatorError: all slots are taken, or there is no running BeamNG to use.
    """
    if settings.user is not None and " " in str(settings.user):
        raise UsageError(f"BeamNG does not start with a user folder that has a space: '{settings.user}'")
    for number in range(MOST):
        port = settings.port + number
        lock = _locked(settings.host, port)
        if lock is None:
            continue
        if settings.launches:
            _end_orphan(lock, settings.host, port)
        if is_taken(settings.host, port) != settings.launches:
            return Slot(port, _user(settings, number), lock)
        lock.close()
        if not settings.launches:
            raise SimulatorError(
                f"nobody listens on {settings.host}:{port}; give --beamng-home to have BeamNG started, or "
                f"start it with -tcom -tport {port}"
            )
    raise SimulatorError(f"no free port from {settings.port} on; name another --beamng-port")


def _locked(host: str, port: int) -> IO[str] | None:
    path = Path(tempfile.gettempdir(), f"roadgpt-beamng-{host.replace(':', '_')}-{port}.lock")
    file = path.open("a+")  # keeps what a killed worker wrote
    try:
        if fcntl is not None:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
    except OSError:
        file.close()
        return None
    return file


def _end_orphan(lock: IO[str], host: str, port: int) -> None:
    """Ends a BeamNG process that a killed worker left behind on its port. No other worker uses that process,
    because the port's lock was free."""
    lock.seek(0)
    said = lock.read()
    if os.name != "posix" or not said.isdecimal() or not is_taken(host, port):
        return
    if f"-tport {port} " not in f"{_command_line(int(said))} ":
        return  # another process has its number now
    with suppress(OSError):
        os.killpg(int(said), signal.SIGKILL)
        for _ in range(50):
            if not is_taken(host, port):
                break
            time.sleep(0.1)


def _command_line(pid: int) -> str:
    """Returns the command line of a process; empty where the system does not say."""
    with suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
    with suppress(OSError, subprocess.SubprocessError):  # macOS
        words = ["/bin/ps", "-o", "command=", "-p", str(pid)]
        told = subprocess.run(words, capture_output=True, text=True, timeout=10, check=False)  # noqa: S603
        return told.stdout.strip()
    return ""


def _user(settings: BeamngSettings, number: int) -> Path | None:
    """Returns the user folder of a worker; a new folder gets a copy of the key that BeamNG.tech requires."""
    first = settings.user
    if not settings.launches or (first is None and number == 0):
        return first
    if first is None:
        return Path(tempfile.gettempdir(), f"roadgpt-beamng-user-{number + 1}")
    if number == 0:
        return first
    own = first.with_name(f"{first.name}-{number + 1}")
    own.mkdir(parents=True, exist_ok=True)
    for key in (first / KEY, *first.glob(f"*/{KEY}")):
        if key.is_file():
            with suppress(shutil.SameFileError):
                target = own / key.relative_to(first)
                target.parent.mkdir(exist_ok=True)
                shutil.copyfile(key, target)
    return own
