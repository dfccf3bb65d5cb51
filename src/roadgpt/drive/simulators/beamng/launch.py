"""Starts, watches and ends BeamNG as a child process.

beamngpy could start BeamNG as well, but it would wait for minutes for a process that has already ended, and
it supports only the options of the newest versions. The command line is that of beamngpy 1.36.
"""

import platform
import socket
import subprocess
import time
from contextlib import suppress
from pathlib import Path

from roadgpt import children
from roadgpt.drive.simulators.beamng.settings import BeamngSettings
from roadgpt.errors import PartError, SimulatorError

BINARIES = {
    "Linux": ("BinLinux/BeamNG.tech.x64", "BinLinux/BeamNG.x64", "BinLinux/BeamNG.drive.x64"),
    "Windows": ("BeamNG.tech.exe", "BeamNG.drive.exe", "Bin64/BeamNG.tech.x64.exe", "Bin64/BeamNG.x64.exe"),
}
LOOK = 0.1  # s between two checks
GRACE = 10.0  # s in which BeamNG may end by itself before it is killed


def binary_of(home: Path) -> Path:
    """Returns the path of BeamNG's program in its folder.

    Raises:
        PartError: the folder does not contain the program.
    """
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
        """Starts BeamNG.

        Raises:
            SimulatorError: the system cannot start BeamNG.
        """
        self.words, self.host, self.port = words, host, port
        try:
            nothing = subprocess.DEVNULL
            self.process = children.start(words, stdin=nothing, stdout=nothing, stderr=nothing)
        except OSError as error:
            raise SimulatorError(f"BeamNG cannot be started ({error}); check --beamng-home") from error

    def wait(self, patience: float) -> None:
        """Waits until BeamNG listens on its port.

        Raises:
            SimulatorError: BeamNG ended, or was killed because it did not listen within ``patience`` seconds.
        """
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
