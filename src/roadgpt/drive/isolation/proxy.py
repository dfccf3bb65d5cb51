"""Represents a driver that runs in another process; simulators use it like any other driver."""

import json
import os
import sys
import threading
import weakref
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

import numpy as np

from roadgpt.drive.driver_guard import BEFORE_START, ONE_ANSWER, RemoteDriverError
from roadgpt.drive.isolation.process import Child, GoneError
from roadgpt.drive.loading import WRITTEN, absolute_spec, folder_of
from roadgpt.drive.view import CameraSpec, Command, View
from roadgpt.errors import DriverError, RoadGPTError, UsageError
from roadgpt.reading import digest
from roadgpt.road import Road, World

MAKING = 30.0  # s for a new process to import what it needs, on top of the driver's own limit
MOST_ANSWER = 1 << 24  # bytes
MOST_IDLE = 4  # processes that are kept for later drivers


class DriverProcess(Child):
    """A process that holds one driver at a time, and no other than ``spec``."""

    ended = "ended its own process (it {})"

    def __init__(self, spec: str) -> None:
        """Starts the process; raises OSError if the system cannot."""
        super().__init__("roadgpt.drive.isolation.child", stderr=None)
        self.spec = spec
        self.has_served = False  # whether the process has already held a driver

    def read(self, stream: IO[bytes]) -> dict[str, Any]:
        """Reads one answer: a line of JSON, so that no code of the driver runs here."""
        return dict(json.loads(stream.readline(MOST_ANSWER)))


_idle: list[DriverProcess] = []
_lock = threading.Lock()
if hasattr(os, "register_at_fork"):  # a fork of this process must not use its pipes
    os.register_at_fork(after_in_child=_idle.clear)


def take(spec: str) -> DriverProcess:
    """Returns an idle process of a driver, or starts a new one; raises OSError if the system cannot."""
    with _lock:
        for process in [each for each in _idle if each.spec == spec]:
            _idle.remove(process)
            if process.is_alive:
                return process
            process.end()
    return DriverProcess(spec)


def give_back(process: DriverProcess) -> None:
    """Keeps a process for the next drive. If more than MOST_IDLE processes are idle then, the one that has
    been idle longest is ended."""
    if not process.is_alive:
        process.end()
        return
    with _lock:
        _idle.append(process)
        if len(_idle) > MOST_IDLE:
            _idle.pop(0).end()


class _TraceError(Exception):
    """The traceback of an error in the other process, shown as the cause of the error here."""

    def __str__(self) -> str:
        return "\n" + str(self.args[0])


class IsolatedDriver:
    """A driver that runs in another process."""

    def __init__(self, spec: str, limit: float = BEFORE_START) -> None:
        """Creates the driver in another process; ``files`` has the digests of the files that the driver uses
        until its ``start`` ends, by their names (see ``drive.driver_files``)."""
        self._road: Road | None = None
        self._world: World | None = None
        self._picture: Any = None
        self.handed_to: str | None = None
        self._process = self._made(spec, limit)
        # not at exit, when all processes end by themselves
        weakref.finalize(self, give_back, self._process).atexit = False

    def _made(self, spec: str, limit: float) -> DriverProcess:
        task = (spec, str(Path.cwd()), {**os.environ}, [*sys.path])
        while True:
            try:
                process = take(absolute_spec(spec, Path.cwd()))
            except OSError as error:
                raise RoadGPTError(f"no process for a driver can be started: {error.strerror}") from error
            is_used = process.has_served
            try:
                answer = process.ask(limit + (0.0 if is_used else MAKING), ("make", *task))
            except GoneError as error:
                if is_used and not error.is_late:
                    continue  # something that the previous driver left behind has ended it
                raise _not_made(spec, limit, error) from None
            process.has_served = True
            if "said" in answer:
                process.end()  # it may have loaded modules that the user will correct
                raise _error(answer) from _TraceError(answer["trace"])
            self.name: str = answer["name"]
            self.camera = None if answer["camera"] is None else CameraSpec(*answer["camera"])
            self.files, self.follows = _digests(spec, answer["files"]), tuple(answer["follows"])
            return process

    def all_files(self) -> dict[str, str]:
        """Returns the digests of all files that the driver has used until now, also while it steered."""
        with suppress(GoneError):
            return _digests(self._process.spec, self._process.ask(BEFORE_START, ("files",)))
        return self.files

    def start(self, road: Road, world: World, seed: int) -> None:
        """Sends the road to the driver and calls its ``start``."""
        self._show(road, world)
        self.files = _digests(self._process.spec, self._asked(BEFORE_START, 0.0, "start", seed)["files"])

    def steer(self, view: View) -> Command:
        """Returns the driver's command."""
        if view.road is not self._road or view.world is not self._world:
            self._show(view.road, view.world)
        image = view.image
        if image is not None and image is self._picture:
            image = "same"
        elif image is not None:
            self._picture, image = image, np.array(image, np.uint8)
        around = view.others, view.lights, view.task
        answer = self._asked(ONE_ANSWER, view.time, "steer", view[:9], view[11:15], image, *around)
        self.handed_to = answer["handed_to"]
        return Command(*answer["command"])

    def _show(self, road: Road, world: World) -> None:
        self._asked(BEFORE_START, 0.0, "show", road, world)
        self._road, self._world = road, world

    def _asked(self, seconds: float, at: float, what: str, *given: Any) -> dict[str, Any]:
        try:
            answer: dict[str, Any] = self._process.ask(seconds, (what, *given))
        except GoneError as error:
            why = str(error)
            if error.is_late:
                why = (
                    f"gave no answer within {seconds:g} s at {at:.2f} s of its drive: "
                    "make steer() return at once"
                    if what == "steer"
                    else f"was not ready within {seconds:g} s: make start() return sooner"
                )
            elif what == "steer":
                why += f", at {at:.2f} s of its drive"
            raise RemoteDriverError(f"driver '{self.name}' {why}") from None
        if "said" in answer:
            raise _error(answer) from _TraceError(answer["trace"])
        return answer


def _digests(spec: str, names: dict[str, bool]) -> dict[str, str]:
    return {
        name: WRITTEN if is_written else digest(folder_of(spec) / name) for name, is_written in names.items()
    }


def _not_made(spec: str, limit: float, error: GoneError) -> RoadGPTError:
    if error.is_late:
        return DriverError(
            f"the driver {spec} was not made within {limit:g} s: let its __init__ return at once and prepare "
            "in start(road, world, seed)"
        )
    return UsageError(f"the driver {spec} cannot be made: it {error}; correct the file")


def _error(told: dict[str, Any]) -> RoadGPTError:
    kind = UsageError if told["is_users"] else RemoteDriverError
    return kind(str(told["said"]))
