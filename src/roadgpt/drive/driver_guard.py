"""Calls drivers for all simulators, and checks their answers; every error of a driver is a DriverError.

No code in the same process can stop a driver that hangs. Users' drivers that are given by a plug-in's name or
as PATH.py:CLASS therefore run in a separate process (``roadgpt.drive.isolation``), which can be ended; an
object that a program passes runs in place."""

import math
import sys
import time
import traceback
from typing import TYPE_CHECKING, Any

import numpy as np

from roadgpt.drive.drive import FloatArray, Handover
from roadgpt.drive.view import View
from roadgpt.errors import DriverError
from roadgpt.road import Road, World

if TYPE_CHECKING:
    from roadgpt.drive.script_hand import ScriptHand

NOTHING = (math.nan, math.nan, math.nan)
ONE_ANSWER = 2.0  # s of wall time for one `steer`
BEFORE_START = 30.0  # s for `start`: a driver may plan, or load a network
WHOLE_DRIVE = 600.0  # s for all answers of a drive together


class RemoteDriverError(DriverError):
    """A DriverError about a driver in a separate process; the message already names the driver."""


class DriverGuard:
    """Calls one driver during one drive."""

    def __init__(
        self, driver: Any, whole_drive: float = WHOLE_DRIVE, script: "ScriptHand | None" = None
    ) -> None:
        """Wraps a driver, whose answers may take ``whole_drive`` seconds of wall time together, and who
        shares wheel and pedals with a ``script``; raises DriverError if it has no method ``steer``."""
        self.name = str(getattr(driver, "name", type(driver).__name__))
        self._driver = driver
        self._steer = getattr(driver, "steer", None)
        if not callable(self._steer):
            raise DriverError(
                f"driver '{self.name}' cannot steer: give its class a method steer(self, view) that returns "
                "roadgpt.drive.Command(steer, throttle, brake)"
            )
        self._whole_drive = whole_drive
        self._used = 0.0
        self.handed_to: str | None = None
        self.handovers: list[Handover] = []
        self.script, self._unheeded = script, list[tuple[float, float, float]]()

    def start(self, road: Road, world: World, seed: int) -> None:
        """Calls the driver's ``start``, if it has one: also when the car was made to change lanes."""
        start = getattr(self._driver, "start", None)
        if start is not None:
            self._called(start, (road, world, seed), 0.0)

    def ask(self, view: View) -> tuple[float, float, float]:
        """Asks the driver for a command and returns it as (steer, throttle, brake): finite numbers, steer in
        radians, throttle and brake limited to 0..1."""
        begun = time.perf_counter()
        answer, by = self._called(self._answer, (view,), view.time)
        self._used += time.perf_counter() - begun
        if self._used > self._whole_drive:
            raise DriverError(
                f"driver '{self.name}' took more than {self._whole_drive:g} s for one drive: "
                "make steer() faster"
            )
        command, hands = self._checked(answer, view.time), None
        if self.script is not None:
            own, (command, hands) = command, self.script.shared(view, command)
            self._unheeded.append(own if hands else NOTHING)
            by = hands or by
        before, self.handed_to = self.handed_to, by
        if by:
            start = self.handovers.pop().start if before == by else view.time
            self.handovers.append(Handover(start, view.time + view.dt, by))
        return command

    @property
    def unheeded(self) -> FloatArray | None:
        """What the driver commanded while the script had a hand, as the Drive has it."""
        said = np.array(self._unheeded).reshape(-1, 3)
        return None if np.isnan(said).all() else said

    def _answer(self, view: View) -> tuple[Any, str | None]:
        answer = self._steer(view)  # type: ignore[misc]
        by = getattr(self._driver, "handed_to", None)
        return answer, None if by is None or by == self.name else _short(by, quoted=not str(by).isprintable())

    def _called(self, method: Any, given: tuple[Any, ...], at: float) -> Any:
        try:
            return method(*given)
        except (KeyboardInterrupt, RemoteDriverError):
            raise
        except BaseException as error:  # a driver may raise anything; it costs this drive only
            raise DriverError(
                f"driver '{self.name}' raised {type(error).__name__} at {at:.2f} s of its drive"
                f"{self._line(error)}: {_short(str(error) or 'no message', quoted=False)}"
            ) from error

    def _checked(self, answer: Any, at: float) -> tuple[float, float, float]:
        try:
            steer, throttle, brake = answer
            command = float(steer), float(throttle), float(brake)
        except (TypeError, ValueError):
            raise DriverError(
                f"driver '{self.name}' answered {_short(answer)} at {at:.2f} s: return "
                "roadgpt.drive.Command(steer, throttle, brake)"
            ) from None
        if not all(map(math.isfinite, command)):
            raise DriverError(
                f"driver '{self.name}' answered {_short(answer)} at {at:.2f} s: steer, throttle and brake "
                "must be finite numbers"
            )
        return command[0], min(max(command[1], 0.0), 1.0), min(max(command[2], 0.0), 1.0)

    def _line(self, error: BaseException) -> str:
        passed = traceback.extract_tb(error.__traceback__)
        frames = [frame for frame in passed if frame.filename != __file__]
        module = sys.modules.get(type(self._driver).__module__)
        own = [frame for frame in frames if frame.filename == getattr(module, "__file__", None)]
        if not frames:
            return ""
        last = (own or frames)[-1]
        return f" ({last.filename}, line {last.lineno})"


def _short(value: Any, quoted: bool = True) -> str:
    try:
        text = repr(value) if quoted else str(value)
    except Exception:
        text = f"an object of {type(value).__name__}"
    return text if len(text) <= 120 else text[:117] + "..."
