"""Represents a driver that runs in another process; simulators use it like any other driver."""

import os
import sys
import weakref
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roadgpt.drive.driver_files import WRITTEN, folder_of
from roadgpt.drive.driver_guard import BEFORE_START, ONE_ANSWER, RemoteDriverError
from roadgpt.drive.isolation.process import DriverProcess, GoneError, give_back, take
from roadgpt.drive.loading import absolute_spec
from roadgpt.drive.view import CameraSpec, Command, View
from roadgpt.errors import DriverError, RoadGPTError, UsageError
from roadgpt.reading import digest

if TYPE_CHECKING:
    from roadgpt.road import Road, World

MAKING = 30.0  # s for a new process to import what it needs, on top of the driver's own limit


class _TraceError(Exception):
    """The traceback of an error in the other process, shown as the cause of the error here."""

    def __str__(self) -> str:
        return "\n" + str(self.args[0])


class IsolatedDriver:
    """A driver that runs in another process."""

    def __init__(self, spec: str, limit: float = BEFORE_START) -> None:
        """Creates the driver in another process; ``files`` has the digests of the files that the driver uses
        until its ``start`` ends, by their names (see ``drive.driver_files``).
        """
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
                answer = process.ask(limit + (0.0 if is_used else MAKING), "make", *task)
            except GoneError as error:
                if is_used and not error.is_late:
                    continue  # something that the previous driver left behind has ended it
                raise _not_made(spec, limit, error) from None
            except BaseException:
                process.end()
                raise
            process.has_served = True
            if "said" in answer:
                process.end()  # it may have loaded modules that the user will correct
                raise _error(answer) from _TraceError(answer["trace"])
            self.name: str = answer["name"]
            self.camera = None if answer["camera"] is None else CameraSpec(*answer["camera"])
            self._note(process, answer["files"])
            return process

    def _note(self, process: DriverProcess, names: dict[str, list[str]]) -> None:
        found = {name: digest(folder_of(process.spec) / name) for name in names["used"]}
        process.files = found | dict.fromkeys(names["written"], WRITTEN)
        self.files = {name: process.files[name] for name in names["early"]}

    def all_files(self) -> dict[str, str]:
        """Returns the digests of all files that the driver's process has used, also in earlier drives."""
        with suppress(GoneError):
            self._note(self._process, self._process.ask(BEFORE_START, "files"))
        return self._process.files

    def start(self, road: "Road", world: "World", seed: int) -> None:
        """Sends the road to the driver and calls its ``start``."""
        self._show(road, world)
        self._note(self._process, self._asked(BEFORE_START, 0.0, "start", seed)["files"])

    def steer(self, view: View) -> Command:
        """Returns the driver's command."""
        if view.road is not self._road or view.world is not self._world:
            self._show(view.road, view.world)
        image = view.image
        if image is not None and image is self._picture:
            image = "same"
        elif image is not None:
            self._picture, image = image, np.array(image, np.uint8)
        answer = self._asked(ONE_ANSWER, view.time, "steer", view[:9], view[11:15], image)
        self.handed_to = answer["handed_to"]
        return Command(*answer["command"])

    def _show(self, road: "Road", world: "World") -> None:
        self._asked(BEFORE_START, 0.0, "show", road, world)
        self._road, self._world = road, world

    def _asked(self, seconds: float, at: float, what: str, *given: Any) -> dict[str, Any]:
        try:
            answer = self._process.ask(seconds, what, *given)
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
