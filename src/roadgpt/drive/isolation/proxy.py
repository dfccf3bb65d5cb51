"""Represents a driver that runs in another process; simulators use it like any other driver."""

import json
import os
import pickle
import sys
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roadgpt import plugins
from roadgpt.drive.driver_guard import BEFORE_START, ONE_ANSWER, RemoteDriverError
from roadgpt.drive.isolation import protocol
from roadgpt.drive.isolation.process import DriverProcess, GoneError, give_back, take
from roadgpt.drive.loading import load_driver
from roadgpt.drive.permission import require_permission, split_spec
from roadgpt.drive.view import CameraSpec, Command, View
from roadgpt.errors import DriverError, RoadGPTError, UsageError

if TYPE_CHECKING:
    from roadgpt.road import Road, World

OURS = "roadgpt."  # prefix of the modules whose drivers run in this process, beside the simulator
MAKING = 30.0  # s for a new process to import what it needs, on top of the driver's own limit


def driver_of(spec: str, limit: float = BEFORE_START) -> Any:
    """Returns the driver that a user named: RoadGPT's own drivers run in this process, any other in a
    separate process.

    The user's file is run only with permission: a file that only a run, a campaign or a plan names is not run
    (see ``drive.permission``).

    Args:
        spec: the name of a driver plug-in, or PATH.py:CLASS.
        limit: seconds within which the driver must be created.

    Raises:
        PartError: there is no driver plug-in of that name.
        UsageError: the file or the class is missing, the file cannot be run, the class is not a driver, or
            the user did not permit it.
        DriverError: the driver hung while it was created.
    """
    require_permission(spec)
    path, _ = split_spec(spec)
    module = "" if path else plugins.module_of("drivers", spec)
    if not path and (not module or module.startswith(OURS)):  # load_driver reports an unknown plug-in
        return load_driver(spec)
    return IsolatedDriver(spec, limit)


class _TraceError(Exception):
    """The traceback of an error in the other process, shown as the cause of the error here."""

    def __str__(self) -> str:
        return "\n" + str(self.args[0])


class IsolatedDriver:
    """A driver that runs in another process."""

    def __init__(self, spec: str, limit: float = BEFORE_START) -> None:
        """Creates the driver there; raises the errors of ``driver_of``."""
        self._road: Road | None = None
        self._world: World | None = None
        self._picture: Any = None
        self._process = self._made(spec, limit)
        # not at exit, when all processes end by themselves
        weakref.finalize(self, give_back, self._process).atexit = False

    def _made(self, spec: str, limit: float) -> DriverProcess:
        task = pickle.dumps((spec, str(Path.cwd()), {**os.environ}, [*sys.path]))
        while True:
            try:
                process = take()
            except OSError as error:
                raise RoadGPTError(f"no process for a driver can be started: {error.strerror}") from error
            is_used = process.has_served
            try:
                answer = process.ask(protocol.MAKE, task, limit + (0.0 if is_used else MAKING))
            except GoneError as error:
                if is_used and not error.is_late:
                    continue  # something that the previous driver left behind has ended it
                raise _not_made(spec, limit, error) from None
            except BaseException:
                process.end()
                raise
            process.has_served = True
            told = json.loads(answer.body)
            if answer.kind == protocol.FAILED:
                give_back(process)
                raise _error(told) from _TraceError(told["trace"])
            self.name: str = told["name"]
            self.camera = None if told["camera"] is None else CameraSpec(*told["camera"])
            return process

    def start(self, road: "Road", world: "World", seed: int) -> None:
        """Sends the road to the driver and calls its ``start``.

        Raises:
            DriverError: the driver raised an exception, hung or ended its process.
        """
        self._show(road, world)
        self._asked(protocol.START, pickle.dumps(seed), BEFORE_START, 0.0)

    def steer(self, view: View) -> Command:
        """Returns the driver's command.

        Raises:
            DriverError: the driver raised an exception, hung or ended its process, or its answer is not a
                command.
        """
        if view.road is not self._road or view.world is not self._world:
            self._show(view.road, view.world)
        answer = self._asked(protocol.VIEW, self._packed(view), ONE_ANSWER, view.time)
        return Command(*protocol.ANSWER.unpack(answer))

    def _show(self, road: "Road", world: "World") -> None:
        self._asked(protocol.SCENE, pickle.dumps((road, world)), BEFORE_START, 0.0)
        self._road, self._world = road, world

    def _packed(self, view: View) -> bytes:
        image = view.image
        state, height, width, pixels = protocol.NO_PICTURE, 0, 0, b""
        if image is not None and image is self._picture:
            state = protocol.SAME_PICTURE
        elif image is not None:
            height, width, _ = image.shape
            state, pixels = protocol.NEW_PICTURE, np.asarray(image, np.uint8).tobytes()
            self._picture = image
        (time, x, y, z, heading, speed, yaw_rate, s, t, _, _, steer, dt, vx, vy, _) = view
        return (
            protocol.SEEN.pack(
                time, x, y, z, heading, speed, yaw_rate, s, t, steer, dt, vx, vy, state, height, width
            )
            + pixels
        )

    def _asked(self, kind: int, body: bytes, seconds: float, at: float) -> bytes:
        try:
            answer = self._process.ask(kind, body, seconds)
        except GoneError as error:
            why = str(error)
            if error.is_late:
                why = (
                    f"gave no answer within {seconds:g} s at {at:.2f} s of its drive: "
                    "make steer() return at once"
                    if kind == protocol.VIEW
                    else f"was not ready within {seconds:g} s: make start() return sooner"
                )
            elif kind == protocol.VIEW:
                why += f", at {at:.2f} s of its drive"
            raise RemoteDriverError(f"driver '{self.name}' {why}") from None
        if answer.kind == protocol.FAILED:
            told = json.loads(answer.body)
            raise _error(told) from _TraceError(told["trace"])
        return answer.body


def _not_made(spec: str, limit: float, error: GoneError) -> RoadGPTError:
    if error.is_late:
        return DriverError(
            f"the driver {spec} was not made within {limit:g} s: let its __init__ return at once and prepare "
            "in start(road, world, seed)"
        )
    return UsageError(f"the driver {spec} cannot be made: it {error}; correct the file")


def _error(told: dict[str, Any]) -> RoadGPTError:
    """Returns the exception for an error that the driver's process reports."""
    kind = UsageError if told["is_users"] else RemoteDriverError
    return kind(str(told["said"]))
