"""Main loop of a driver's own process: creates one driver after another, and passes views to it.

Nothing in this process interrupts a slow driver: if it takes too long, RoadGPT ends this process. The driver
may therefore use alarms, signals and threads as it likes."""

import json
import os
import sys
import threading
import traceback
from contextlib import suppress
from typing import Any

from roadgpt import children
from roadgpt.drive.camera_sensor import camera_of
from roadgpt.drive.driver_files import DriverFiles
from roadgpt.drive.driver_guard import DriverGuard
from roadgpt.drive.isolation.process import serve
from roadgpt.drive.loading import load_driver
from roadgpt.drive.outlook import Outlook
from roadgpt.drive.view import DrivingTask, LightAhead, Other, View
from roadgpt.errors import DriverError, UsageError
from roadgpt.road import Road, World  # now, and not while the driver's time counts

STATION = View._fields.index("s")
MOST_SAID, MOST_TRACE = 4_000, 40_000  # characters of an error's message and traceback


class _DriverHost:
    """Holds one driver at a time; its other methods answer the requests of the same names."""

    def __init__(self) -> None:
        os.umask(mask := os.umask(0o022))
        self._mask, self._threads = mask, threading.active_count() + 1  # and the one of ``serve``
        self._files: Any = None
        self._guard: Any = None
        self._road: Any = None
        self._world: Any = None
        self._picture: Any = None
        self._outlook: Any = None

    def answer(self, request: tuple[Any, ...]) -> dict[str, Any]:
        """Answers one request; errors are answered as texts."""
        what, *given = request
        try:
            answer: dict[str, Any] = getattr(self, what)(*given)
        except (DriverError, UsageError) as error:
            return _failed(error, str(error), isinstance(error, UsageError))
        except BaseException as error:  # also KeyboardInterrupt, which is the driver's own here
            what_failed = f"the driver raised {type(error).__name__}: {error}".rstrip(": ")
            return _failed(error, what_failed, is_users=what == "make")
        return answer

    def make(self, spec: str, folder: str, environment: dict[str, str], path: list[str]) -> dict[str, Any]:
        """Creates a driver, in the folder and with the environment and module path of RoadGPT's process. If
        the driver before it has left threads or a compiled module, ends the process, so that a new one is
        started."""
        self._guard = self._road = self._world = self._picture = self._outlook = None
        os.umask(self._mask)
        os.chdir(folder)
        self._files = self._files or DriverFiles(spec)  # a process serves one spec alone
        if not self._files.begin() or threading.active_count() > self._threads:
            os._exit(0)
        os.environ.clear()
        os.environ.update(environment)
        sys.path[:] = path
        driver = load_driver(spec)
        camera = camera_of(driver)
        self._guard = DriverGuard(driver)
        self._files.add(getattr(driver, "uses", ()))
        follows = [*map(str, getattr(driver, "follows", ()))]
        return {"name": self._guard.name, "camera": camera, "files": self._files.told(), "follows": follows}

    def files(self) -> dict[str, Any]:
        """Returns the names of all files that the driver has used so far."""
        return dict(self._files.told())

    def show(self, road: Road, world: World) -> dict[str, Any]:
        """Keeps the road and the world for the views to come."""
        self._road, self._world, self._outlook = road, world, Outlook(road, world)
        return {}

    def start(self, seed: int) -> dict[str, Any]:
        """Calls the driver's ``start``."""
        self._guard.start(self._road, self._world, seed)
        return {"files": self._files.told()}

    def steer(
        self,
        place: tuple[float, ...],
        motion: tuple[float, ...],
        image: Any,
        others: tuple[Other, ...],
        lights: tuple[LightAhead, ...],
        task: DrivingTask | None,
    ) -> dict[str, Any]:
        """Asks the driver for a command; ``place`` has the fields of a View before ``road`` and ``world``,
        and ``motion`` those after them."""
        if image is not None and not isinstance(image, str):
            self._picture = image
        picture = None if image is None else self._picture
        ahead, signs = self._outlook.at(place[STATION]), self._outlook.signs(place[STATION])
        own = *place, self._road, self._world, *motion, picture
        view = View._make((*own, *ahead, others, lights, signs, task))
        return {"command": self._guard.ask(view), "handed_to": self._guard.handed_to}


def main() -> None:
    """Answers the requests of RoadGPT's process until that process closes the connection."""
    sys.dont_write_bytecode = True  # else a quick edit goes unnoticed
    serve(_DriverHost().answer, lambda answer: json.dumps(answer).encode() + b"\n")
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):
            stream.flush()
    children.end_with_all()  # without waiting for the driver's threads


def _failed(error: BaseException, said: str, is_users: bool) -> dict[str, Any]:
    trace = "".join(traceback.format_exception(error))
    return {"said": said[:MOST_SAID], "is_users": is_users, "trace": trace[-MOST_TRACE:]}
