"""Our end of a driver that sits in another process: to simulators it is a driver like any other."""

import json
import os
import pickle
import sys
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from roadgpt import plugins
from roadgpt.drive.apart import wire
from roadgpt.drive.apart.process import GoneError, Process, give_back, take
from roadgpt.drive.custom import load_driver
from roadgpt.drive.seat import BEFORE_START, ONE_ANSWER, ToldError
from roadgpt.drive.trust import admit, parted
from roadgpt.drive.view import Camera, Command, View
from roadgpt.errors import DriverError, RoadGPTError, UsageError

if TYPE_CHECKING:
    from roadgpt.road import Road, World

OURS = "roadgpt."  # modules of the drivers that sit in this process, beside the simulator
MAKING = 30.0  # s for a new process to import what it needs, before the driver's own time counts


def driver_of(spec: str, limit: float = BEFORE_START) -> Any:
    """The driver that a user named: one of ours here, anybody else's in a process of its own.

    Runs the user's file; one that only a run, a campaign or a plan names is not run: see ``drive.trust``.

    Args:
        spec: the name of a driver on the shelf, or PATH.py:CLASS.
        limit: seconds in which it must be made.

    Raises:
        PartError: no driver of that name on the shelf.
        UsageError: the file or the class is missing, the file cannot be run, the class makes no driver, or
            the user does not name it.
        DriverError: it hung while it was made.
    """
    admit(spec)
    path, _ = parted(spec)
    module = "" if path else plugins.module_of("drivers", spec)
    if not path and (not module or module.startswith(OURS)):  # no such part: says so
        return load_driver(spec)
    return Foreign(spec, limit)


class _TraceError(Exception):
    """What Python told of an error in the other process, to stand in the traceback of ours."""

    def __str__(self) -> str:
        return "\n" + str(self.args[0])


class Foreign:
    """A driver in another process."""

    def __init__(self, spec: str, limit: float = BEFORE_START) -> None:
        """Makes it there; raises as ``driver_of``."""
        self._road: Road | None = None
        self._world: World | None = None
        self._picture: Any = None
        self._process = self._made(spec, limit)
        # not at exit: then all processes end by themselves
        weakref.finalize(self, give_back, self._process).atexit = False

    def _made(self, spec: str, limit: float) -> Process:
        task = pickle.dumps((spec, str(Path.cwd()), {**os.environ}, [*sys.path]))
        while True:
            try:
                process = take()
            except OSError as error:
                raise RoadGPTError(f"no process for a driver can be started: {error.strerror}") from error
            is_used = process.has_served
            try:
                answer = process.ask(wire.MAKE, task, limit + (0.0 if is_used else MAKING))
            except GoneError as error:
                if is_used and not error.is_late:
                    continue  # the driver before had left something behind that ended it
                raise _not_made(spec, limit, error) from None
            except BaseException:
                process.end()
                raise
            process.has_served = True
            told = json.loads(answer.body)
            if answer.kind == wire.FAILED:
                give_back(process)
                raise _error(told) from _TraceError(told["trace"])
            self.name: str = told["name"]
            self.camera = None if told["camera"] is None else Camera(*told["camera"])
            return process

    def start(self, road: "Road", world: "World", seed: int) -> None:
        """Shows it the road, and lets it get ready.

        Raises:
            DriverError: it raised, hung or ended.
        """
        self._show(road, world)
        self._asked(wire.START, pickle.dumps(seed), BEFORE_START, 0.0)

    def steer(self, view: View) -> Command:
        """Its answer.

        Raises:
            DriverError: it raised, hung or ended, or the answer is no command.
        """
        if view.road is not self._road or view.world is not self._world:
            self._show(view.road, view.world)
        answer = self._asked(wire.VIEW, self._packed(view), ONE_ANSWER, view.time)
        return Command(*wire.ANSWER.unpack(answer))

    def _show(self, road: "Road", world: "World") -> None:
        self._asked(wire.SCENE, pickle.dumps((road, world)), BEFORE_START, 0.0)
        self._road, self._world = road, world

    def _packed(self, view: View) -> bytes:
        image = view.image
        state, height, width, pixels = wire.NO_PICTURE, 0, 0, b""
        if image is not None and image is self._picture:
            state = wire.SAME_PICTURE
        elif image is not None:
            height, width, _ = image.shape
            state, pixels = wire.NEW_PICTURE, np.asarray(image, np.uint8).tobytes()
            self._picture = image
        (time, x, y, z, heading, speed, yaw_rate, s, t, _, _, steer, dt, vx, vy, _) = view
        return (
            wire.SEEN.pack(
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
                    if kind == wire.VIEW
                    else f"was not ready within {seconds:g} s: make start() return sooner"
                )
            elif kind == wire.VIEW:
                why += f", at {at:.2f} s of its drive"
            raise ToldError(f"driver '{self.name}' {why}") from None
        if answer.kind == wire.FAILED:
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
    """What the process says of its driver."""
    kind = UsageError if told["is_users"] else ToldError
    return kind(str(told["said"]))
