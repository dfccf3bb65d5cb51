"""Main loop of a driver's own process: creates one driver after another, and passes views to it.

Nothing in this process interrupts a slow driver: if it takes too long, RoadGPT ends this process. The driver
may therefore use alarms, signals and threads as it likes.
"""

import json
import os
import pickle
import signal
import sys
import threading
import traceback
from contextlib import suppress
from pathlib import Path
from typing import Any

from roadgpt import children
from roadgpt.drive.camera_sensor import camera_of
from roadgpt.drive.driver_files import DriverFiles
from roadgpt.drive.driver_guard import DriverGuard
from roadgpt.drive.loading import load_driver
from roadgpt.drive.outlook import Outlook
from roadgpt.drive.view import View
from roadgpt.errors import DriverError, UsageError
from roadgpt.road import Road, World  # now, and not while the driver's time counts

STATION = View._fields.index("s")
MOST_SAID, MOST_TRACE = 4_000, 40_000  # characters of an error's message and traceback


class _DriverHost:
    """Holds one driver at a time; its methods answer the requests of the same names."""

    def __init__(self) -> None:
        os.umask(mask := os.umask(0o022))
        self._mask, self._threads = mask, threading.active_count()
        self._files: Any = None
        self._guard: Any = None
        self._road: Any = None
        self._world: Any = None
        self._picture: Any = None
        self._outlook: Any = None

    def make(self, spec: str, folder: str, environment: dict[str, str], path: list[str]) -> dict[str, Any]:
        """Creates a driver, in the folder and with the environment and module path of RoadGPT's process."""
        os.umask(self._mask)
        os.chdir(folder)
        os.environ.clear()
        os.environ.update(environment)
        sys.path[:] = path
        self._files = self._files or DriverFiles(spec)  # a process serves one spec alone
        self._files.begin()
        driver = load_driver(spec)
        camera = camera_of(driver)
        self._guard = DriverGuard(driver)
        self._files.add(getattr(driver, "uses", ()))
        return {"name": self._guard.name, "camera": camera, "files": self._files.told()}

    def files(self) -> dict[str, Any]:
        """Returns the names of all files that the process has used for drivers so far."""
        return dict(self._files.told(is_early=False))

    def show(self, road: Road, world: World) -> dict[str, Any]:
        """Keeps the road and the world for the views to come."""
        self._road, self._world, self._outlook = road, world, Outlook(road, world)
        return {}

    def start(self, seed: int) -> dict[str, Any]:
        """Calls the driver's ``start``."""
        self._guard.start(self._road, self._world, seed)
        return {"files": self._files.told()}

    def steer(self, place: tuple[float, ...], motion: tuple[float, ...], image: Any) -> dict[str, Any]:
        """Asks the driver for a command; ``place`` has the fields of a View before ``road`` and ``world``,
        and ``motion`` those after them."""
        if image is not None and not isinstance(image, str):
            self._picture = image
        picture = None if image is None else self._picture
        ahead = self._outlook.at(place[STATION])
        view = View._make((*place, self._road, self._world, *motion, picture, *ahead))
        return {"command": self._guard.ask(view), "handed_to": self._guard.handed_to}

    def forget(self) -> None:
        """Discards the driver; if it has left threads running, ends the process."""
        self._guard = self._road = self._world = self._picture = self._outlook = None
        if threading.active_count() > self._threads:
            os._exit(0)


def main() -> None:
    """Answers the requests of RoadGPT's process until that process closes the connection."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the asking process handles Ctrl-C and ends this one
    sys.dont_write_bytecode = True  # else a quick edit goes unnoticed
    heard, said = children.private_streams()
    children.ends_with_parent()
    with suppress(OSError):
        # If memory runs out, the system ends this process first.
        Path("/proc/self/oom_score_adj").write_text("1000", "ascii")
    host = _DriverHost()
    while True:
        try:
            what, *given = pickle.load(heard)  # noqa: S301 - ours
        except (EOFError, OSError, pickle.UnpicklingError):
            _leave()
        if what == "forget":
            host.forget()
            continue
        try:
            answer = getattr(host, what)(*given)
        except (DriverError, UsageError) as error:
            answer = _failed(error, str(error), isinstance(error, UsageError))
        except BaseException as error:  # also KeyboardInterrupt, which is the driver's own here
            what_failed = f"the driver raised {type(error).__name__}: {error}".rstrip(": ")
            answer = _failed(error, what_failed, is_users=what == "make")
        try:
            said.write(json.dumps(answer).encode() + b"\n")
            said.flush()
        except OSError:
            _leave()


def _failed(error: BaseException, said: str, is_users: bool) -> dict[str, Any]:
    trace = "".join(traceback.format_exception(error))
    return {"said": said[:MOST_SAID], "is_users": is_users, "trace": trace[-MOST_TRACE:]}


def _leave() -> None:
    """Ends the process at once, without waiting for the driver's threads."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):
            stream.flush()
    os._exit(0)
