"""Does the work of the tools in processes, within the folder and the limits of whoever started the server."""

import json
import re
import subprocess
import sys
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import anyio

from roadgpt import children, plugins
from roadgpt.errors import UsageError

AT_ONCE, MOST_WAITING = 2, 64  # calls that work, and that wait
EVERY, WEIGHING = 0.05, 2.0  # s between two looks at a process, and at the size of the folder
PATIENCE = 5.0  # s in which a process that is told to stop keeps what is finished
TEST = re.compile(r"([A-Za-z0-9][\w-]{0,63})((?:/c\d{1,4})?(?:/\d{1,9})?)", re.ASCII)
SETTING = r"\w+=(?:[-+.\deE]+|true|false|none)"  # no text, which may name a file
DRIVER = re.compile(rf"([\w-]+)(\.py:\w+)?(?::{SETTING}(?:,{SETTING})*)?", re.ASCII)
NOISE = re.compile(r"roadgpt: (compil|continue)|seed \d+, into|tests and tables|pictures:|changed road:")
Tell = Callable[[list[str]], Awaitable[None]]


@dataclass
class Workshop:
    """The folder of runs and its limits: seconds and tests of a call, MB of the folder, tests at a time."""

    home: Path
    drivers: Path | None
    seconds: int
    tests: int
    disk: int
    workers: int
    free: anyio.CapacityLimiter = field(default_factory=lambda: anyio.CapacityLimiter(AT_ONCE))

    def inside(self, path: Path) -> Path:
        """Returns a path; raises UsageError if links lead out of the folder of runs."""
        if not path.resolve().is_relative_to(self.home):
            raise UsageError(f"{path.relative_to(self.home)} leads out of the folder of runs")
        return path

    def place(self, name: str) -> Path:
        """Returns the path of a folder of runs or campaign, or of one of its tests, as commands take it."""
        found = TEST.fullmatch(name)
        if found is None or not self.inside(self.home / found[1]).is_dir():
            raise UsageError(f"there is no run {name[:80]!r}; the tool runs lists them; a test is run-1/1")
        return Path(f"{self.home / found[1]}{found[2]}")

    def new(self, kind: str) -> Path:
        """Makes and returns a folder, named by its kind and a number."""
        for number in count(1):
            with suppress(FileExistsError):
                (folder := self.home / f"{kind}-{number}").mkdir()
                break
        return folder

    def driver(self, said: str) -> str:
        """Returns a driver as commands take it: an installed one, or a file of the folder of drivers."""
        found, known = DRIVER.fullmatch(said), plugins.names("drivers")
        if found and not found[2] and found[1] in known:
            return said
        if found and found[2] and self.drivers is not None:
            path = self.drivers / f"{found[1]}.py"
            if path.is_file() and not path.is_symlink():
                return f"{self.drivers.resolve()}/{said}"
        file = ", or a file of the folder --drivers: FILE.py:CLASS" * (self.drivers is not None)
        raise UsageError(f"there is no driver {said[:80]!r}; there are {', '.join(known)}{file}")

    def found(self, place: Path, *patterns: str) -> list[Path]:
        """Returns the files in a folder, in the order of these patterns."""
        return [self.inside(path) for pattern in patterns for path in sorted(place.glob(pattern))]

    async def done(self, words: list[str], tell: Tell | None = None) -> tuple[list[str], list[str]]:
        """Does a command in a process; returns the lines that it printed, and its remarks. ``tell`` is called
        with the lines so far. Raises UsageError if the command fails or comes to a limit."""
        if self.free.statistics().tasks_waiting >= MOST_WAITING:
            raise UsageError(f"{MOST_WAITING} calls wait already; call again when some have ended")
        async with self.free:
            with TemporaryDirectory() as spare:
                out, err = Path(spare, "out"), Path(spare, "err")
                with out.open("wb") as said, err.open("wb") as remarks:
                    command = [sys.executable, "-m", "roadgpt_mcp.child", *words]
                    process = children.start(command, stdin=subprocess.PIPE, stdout=said, stderr=remarks)
                try:
                    await self._watch(process, out, tell)
                finally:
                    with anyio.CancelScope(shield=True):
                        await _end(process)
                told, noted = (each.read_text("utf-8", "replace") for each in (out, err))
        own = f"{self.home}/"
        notes = [line for line in noted.replace(own, "").splitlines() if not NOISE.match(line)]
        notes = [line.removeprefix("roadgpt: ").removeprefix("Error: ") for line in notes]
        if process.returncode:
            raise UsageError(notes[-1] if notes else f"the process ended with {process.returncode}")
        return told.replace(json.dumps(own)[1:-1], "").splitlines(), notes

    async def _watch(self, process: "subprocess.Popen[bytes]", out: Path, tell: Tell | None) -> None:
        ends, weighs, weight, seen = anyio.current_time() + self.seconds, 0.0, 0, 0
        while process.poll() is None:
            if (now := anyio.current_time()) > ends:
                limit = f"{self.seconds:,} s (--seconds of the server)"
                raise UsageError(f"stopped: a call works {limit} at most; resume goes on with what is left")
            if now > weighs:
                weighs = now + WEIGHING
                with suppress(OSError):  # a file that has gone meanwhile
                    weight = sum(path.lstat().st_size for path in self.home.rglob("*"))
                if weight > self.disk * 1_000_000:
                    raise UsageError(f"the folder of runs is full: {self.disk:,} MB (--disk of the server)")
            if (size := out.stat().st_size) != seen and tell is not None:
                seen = size
                if lines := out.read_text("utf-8", "replace").split("\n")[:-1]:
                    await tell(lines)
            await anyio.sleep(EVERY)


def rows_in(lines: list[str]) -> list[dict[str, Any]]:
    """Returns the objects in lines of JSON."""
    return [json.loads(line) for line in lines if line.startswith("{")]


async def _end(process: "subprocess.Popen[bytes]") -> None:
    """Stops a process, if it still works, and all that it started."""
    with anyio.move_on_after(PATIENCE):
        if process.poll() is None:
            process.terminate()
        while process.poll() is None:
            await anyio.sleep(EVERY)
    children.end(process)
    process.communicate()
