"""A driver's own process: makes it, lets it see and answer, and puts back what it has changed.

Nobody watches the clock here: a driver that takes too long is ended together with the process, by ours. So
it may use alarms, signals and threads as it likes.
"""

import faulthandler
import json
import os
import pickle
import signal
import sys
import threading
import time
import traceback
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.children import private_streams
from roadgpt.drive.apart import wire
from roadgpt.drive.custom import load_driver
from roadgpt.drive.eyes import camera_of
from roadgpt.drive.seat import Seat
from roadgpt.drive.view import View
from roadgpt.errors import DriverError, UsageError
from roadgpt.road import Road, World  # noqa: F401 - now, and not while the driver's time counts

LOOK = 1.0  # s between two looks at whether anybody is there still
ALONE = 90.0  # s in which no Python runs here, so that nobody can look; longer than a driver may take
MOST_SAID, MOST_TRACE = 4_000, 40_000  # letters of what is told of an error


class _Start:
    """What a driver may change of its process, as it was before there was one."""

    def __init__(self) -> None:
        self._handlers = {
            number: signal.getsignal(number)
            for number in signal.valid_signals()
            if signal.getsignal(number) is not None
        }
        self._streams = sys.stdin, sys.stdout, sys.stderr
        os.umask(mask := os.umask(0o022))
        self._mask = mask
        self._threads = threading.active_count()

    def again(self, folder: str, environment: dict[str, str], path: list[str]) -> None:
        """As it was; folder, environment and path of modules are those of the process that asks."""
        if hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in self._handlers.items():
            if signal.getsignal(number) != handler:
                with suppress(OSError, ValueError):
                    signal.signal(number, handler)
        sys.stdin, sys.stdout, sys.stderr = self._streams
        os.umask(self._mask)
        os.chdir(folder)
        os.environ.clear()
        os.environ.update(environment)
        sys.path[:] = path

    def is_alone(self) -> bool:
        """Has the driver left no thread behind?"""
        return threading.active_count() <= self._threads


class _Cabin:
    """Holds one driver at a time."""

    def __init__(self) -> None:
        self._start = _Start()
        self._seat: Any = None
        self._road: Any = None
        self._world: Any = None
        self._picture: Any = None

    def answer(self, kind: int, body: bytes) -> wire.Message:
        """To what was said."""
        if kind == wire.VIEW:
            return wire.Message(wire.COMMAND, wire.ANSWER.pack(*self._seat.ask(self._seen(body))))
        if kind == wire.MAKE:
            return wire.Message(wire.MADE, json.dumps(self._make(*pickle.loads(body))).encode())  # noqa: S301 - ours
        if kind == wire.SCENE:
            self._road, self._world = pickle.loads(body)  # noqa: S301 - ours
        else:
            self._seat.start(self._road, self._world, pickle.loads(body))  # noqa: S301 - ours
        return wire.Message(wire.MADE, b"{}")

    def _make(self, spec: str, *surroundings: Any) -> dict[str, Any]:
        self._start.again(*surroundings)
        driver = load_driver(spec)
        camera = camera_of(driver)
        self._seat = Seat(driver)
        return {"name": self._seat.name, "camera": camera}

    def _seen(self, body: bytes) -> View:
        *numbers, state, height, width = wire.SEEN.unpack_from(body)
        if state == wire.NEW_PICTURE:
            pixels = np.frombuffer(bytearray(memoryview(body)[wire.SEEN.size :]), np.uint8)
            self._picture = pixels.reshape(height, width, 3)
        image = None if state == wire.NO_PICTURE else self._picture
        place, motion = numbers[:9], numbers[9:]
        return View._make((*place, self._road, self._world, *motion, image))

    def forget(self) -> None:
        """Let go of the driver; one that goes on working ends with the process."""
        self._seat = self._road = self._world = self._picture = None
        if not self._start.is_alone():
            os._exit(0)


def main() -> None:
    """Serve until nobody asks any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that asks hears of Ctrl-C, and ends this one
    heard, said = private_streams()
    up, down = said.fileno(), heard.fileno()
    threading.Thread(target=_stay_while, args=(os.getppid(),), daemon=True).start()
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text(
            "1000", "ascii"
        )  # where memory runs out, the system is to end this process first
    cabin = _Cabin()
    while True:
        try:
            kind, body = wire.receive(down)
        except (EOFError, OSError):
            _leave()
        if kind == wire.FORGET:
            cabin.forget()
            continue
        try:
            answer = cabin.answer(kind, body)
        except (DriverError, UsageError) as error:
            answer = _failed(error, str(error), isinstance(error, UsageError))
        except BaseException as error:  # also KeyboardInterrupt, which is the driver's own here
            what = f"the driver raised {type(error).__name__}: {error}".rstrip(": ")
            answer = _failed(error, what, is_users=kind == wire.MAKE)
        try:
            wire.send(up, *answer)
        except OSError:
            _leave()


def _failed(error: BaseException, said: str, is_users: bool) -> wire.Message:
    trace = "".join(traceback.format_exception(error))
    told = {"said": said[:MOST_SAID], "is_users": is_users, "trace": trace[-MOST_TRACE:]}
    return wire.Message(wire.FAILED, json.dumps(told).encode())


def _leave() -> None:
    """At once: threads of a driver are not waited for."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):
            stream.flush()
    os._exit(0)


def _stay_while(parent: int) -> None:
    """Ends this process when the one that asks is gone, even where compiled code lets no Python run."""
    nothing = Path(os.devnull).open("w", encoding="ascii")  # noqa: SIM115 - as long as the process lives
    while os.getppid() == parent:
        faulthandler.dump_traceback_later(ALONE, exit=True, file=nothing)
        time.sleep(LOOK)
    os._exit(0)
