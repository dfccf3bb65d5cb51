"""Which of several workers this process is: each has its own port and its own user folder.

A worker holds a lock file; a process that is killed lets go of it.
"""

import shutil
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import IO

from roadgpt.drive.simulators.beamng.settings import Settings
from roadgpt.drive.simulators.beamng.wire import is_taken
from roadgpt.errors import SimulationError, UsageError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

MOST = 64  # workers on one machine
KEY = "tech.key"  # of BeamNG.tech, in the user folder or that of a version


class Slot:
    """A port and a user folder that no other process of ours uses."""

    def __init__(self, number: int, port: int, user: Path | None, lock: IO[str]) -> None:
        self.number, self.port, self.user, self._lock = number, port, user, lock

    def release(self) -> None:
        """Let others have it."""
        self._lock.close()


def take(settings: Settings) -> Slot:
    """The first slot that is free.

    Where BeamNG is to be started, a port that somebody listens on is passed over: it may be anybody's.

    Raises:
        SimulationError: all are taken, or no BeamNG listens that could be asked.
    """
    if settings.user is not None and " " in str(settings.user):
        raise UsageError(f"BeamNG does not start with a user folder that has a space: '{settings.user}'")
    for number in range(MOST):
        port = settings.port + number
        lock = _locked(settings.host, port)
        if lock is None:
            continue
        if is_taken(settings.host, port) != settings.launches:
            return Slot(number, port, _user(settings, number), lock)
        lock.close()
        if not settings.launches:
            raise SimulationError(
                f"nobody listens on {settings.host}:{port}; give --beamng-home to have BeamNG started, or "
                f"start it with -tcom -tport {port}"
            )
    raise SimulationError(f"no free port from {settings.port} on; name another --beamng-port")


def _locked(host: str, port: int) -> IO[str] | None:
    path = Path(tempfile.gettempdir(), f"roadgpt-beamng-{host.replace(':', '_')}-{port}.lock")
    file = path.open("w")
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


def _user(settings: Settings, number: int) -> Path | None:
    """The user folder of a worker; a new one gets the key that BeamNG.tech asks for."""
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
