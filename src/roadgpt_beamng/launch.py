"""Starts, watches and ends BeamNG as a child process, with a port and a user folder for each worker process.

beamngpy could start BeamNG as well, but it would wait for minutes for a process that has already ended, and
it supports only the options of the newest versions. The command line is that of beamngpy 1.36.

Each worker locks a file; the system releases the lock when the worker ends, even if it is killed.
"""

import os
import platform
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from typing import IO

from roadgpt import children
from roadgpt.errors import PartError, SimulatorError, UsageError
from roadgpt_beamng.settings import BeamngSettings

BINARIES = {
    "Linux": ("BinLinux/BeamNG.tech.x64", "BinLinux/BeamNG.x64", "BinLinux/BeamNG.drive.x64"),
    "Windows": ("BeamNG.tech.exe", "BeamNG.drive.exe", "Bin64/BeamNG.tech.x64.exe", "Bin64/BeamNG.x64.exe"),
}
LOOK = 0.1  # s between two checks
GRACE = 10.0  # s in which BeamNG may end by itself before it is killed
MOST_WORKERS = 64  # workers on one machine
KEY = "tech.key"  # licence of BeamNG.tech, in the user folder or in that of a version


def binary_of(home: Path) -> Path:
    """Returns the path of BeamNG's program in its folder."""
    names = BINARIES.get(platform.system(), BINARIES["Linux"])
    for name in names:
        if (home / name).is_file():
            return home / name
    raise PartError(f"no BeamNG in {home}: --beamng-home is the folder that holds {names[0]}")


def command_line(binary: Path, settings: BeamngSettings, port: int, user: Path | None) -> list[str]:
    """Returns the command that starts BeamNG, as a list of words."""
    words = [str(binary), "-nosteam", "-tcom", "-tport", str(port)]
    if platform.system() != "Linux":
        words.append("-console")
    words += ["-tcom-listen-ip", settings.host]
    if settings.headless or settings.nogpu:
        words.append("-headless")
    if settings.gfx:
        words += ["-gfx", settings.gfx]
    if settings.nogpu:
        words += ["-gfx", "null"]
    if user is not None:
        words += ["-userpath", str(user)]
    return words


def is_taken(host: str, port: int) -> bool:
    """Returns whether a program listens on this port."""
    try:
        with socket.create_connection((host, port), timeout=1.0):
            return True
    except OSError:
        return False


class BeamngProcess:
    """A BeamNG process that RoadGPT has started."""

    def __init__(self, words: list[str], host: str, port: int) -> None:
        self.words, self.host, self.port = words, host, port
        try:
            nothing = subprocess.DEVNULL
            self.process = children.start(words, stdin=nothing, stdout=nothing, stderr=nothing)
        except OSError as error:
            raise SimulatorError(f"BeamNG cannot be started ({error}); check --beamng-home") from error

    def wait(self, patience: float) -> None:
        """Waits until BeamNG listens on its port."""
        due = time.monotonic() + patience
        while not is_taken(self.host, self.port):
            status = self.process.poll()
            if status is not None:
                raise SimulatorError(
                    f"BeamNG ended at once (exit status {status}); start it by hand to see why: "
                    f"{' '.join(self.words)}"
                )
            if time.monotonic() > due:
                self.kill()
                raise SimulatorError(
                    f"BeamNG does not listen on port {self.port} after {patience:g} s; give it more time "
                    "(ROADGPT_BEAMNG_START_TIMEOUT), and see that it is BeamNG.tech and has its key"
                )
            time.sleep(LOOK)

    def kill(self) -> None:
        """Ends BeamNG and its child processes, by force if necessary."""
        children.end(self.process, GRACE)

    def end(self) -> None:
        """Waits until BeamNG has obeyed a request to quit; kills BeamNG if it does not end in time."""
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(GRACE)
        self.kill()


try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


class Slot:
    """A port and a user folder that no other RoadGPT process uses."""

    def __init__(self, port: int, user: Path | None, lock: IO[str]) -> None:
        self.port, self.user, self._lock = port, user, lock

    def note(self, pid: int) -> None:
        """Stores the id of the process that listens, so that a later worker can end it."""
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
    """Returns the first free slot. If RoadGPT starts BeamNG itself, ports on which any program listens are
    skipped."""
    if settings.user is not None and " " in str(settings.user):
        raise UsageError(f"BeamNG does not start with a user folder that has a space: '{settings.user}'")
    for number in range(MOST_WORKERS):
        port = settings.port + number
        lock = _locked(settings.host, port)
        if lock is None:
            continue
        if settings.launches:
            _end_orphan(lock, settings.host, port)
        if is_taken(settings.host, port) != settings.launches:
            return Slot(port, user_folder(settings, number), lock)
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
    """Ends a BeamNG process that a killed worker left on its port; nobody uses it, as the lock was free."""
    lock.seek(0)
    said = lock.read()
    if os.name != "posix" or not said.isdecimal() or not is_taken(host, port):
        return
    if f"-tport {port} " not in f"{_words_of(int(said))} ":
        return  # another process has its number now
    with suppress(OSError):
        os.killpg(int(said), signal.SIGKILL)
        for _ in range(50):
            if not is_taken(host, port):
                break
            time.sleep(0.1)


def _words_of(pid: int) -> str:
    """Returns the command line of a process; empty where the system does not say."""
    with suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
    with suppress(OSError, subprocess.SubprocessError):  # macOS
        words = ["/bin/ps", "-o", "command=", "-p", str(pid)]
        told = subprocess.run(words, capture_output=True, text=True, timeout=10, check=False)  # noqa: S603
        return told.stdout.strip()
    return ""


def user_folder(settings: BeamngSettings, number: int) -> Path | None:
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
