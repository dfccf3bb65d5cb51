"""Calls drivers for all simulators: limits their time and checks their answers.

All errors of a driver are raised as DriverError. A driver that hangs is stopped in one of two ways:

- In the main thread of a system with interval timers (Linux, macOS) a signal stops the driver. The signal
  ends endless loops, sleeps and most waits.
- Elsewhere (other threads, Windows) an exception stops the driver. Python raises the exception in the
  driver's thread between two instructions. The exception ends endless loops at once, but a call of
  ``time.sleep(60)`` only after 60 seconds.

No code in the same process can stop a driver that hangs inside compiled code and never returns to Python.
Users' drivers that are given by a plug-in's name or as PATH.py:CLASS therefore run in a separate process
(``roadgpt.drive.isolation``), which can be ended.
"""

import contextlib
import ctypes
import math
import signal
import sys
import threading
import time
import traceback
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from roadgpt.drive.drive import Handover
from roadgpt.drive.view import View
from roadgpt.errors import DriverError

if TYPE_CHECKING:
    from roadgpt.road import Road, World

ONE_ANSWER = 2.0  # s of wall time for one `steer`
BEFORE_START = 30.0  # s for `start`: a driver may plan, or load a network
WHOLE_DRIVE = 600.0  # s for all answers of a drive together
OWN = "roadgpt.drive.drivers."  # modules of drivers that cannot hang: they may wait for the compiler
TICK = 0.2  # s between two checks of the clock


class RemoteDriverError(DriverError):
    """A DriverError about a driver in a separate process; the message already names the driver."""


class _HungError(BaseException):
    """Raised in a driver that hangs. It is not an Exception, so that ``except Exception`` in the driver does
    not catch it."""


class DriverGuard:
    """Calls one driver during one drive.

    Use it as ``with guard.watched(): guard.start(...); guard.ask(view) ...``.
    """

    def __init__(
        self,
        driver: Any,
        one_answer: float = ONE_ANSWER,
        whole_drive: float = WHOLE_DRIVE,
        before_start: float = BEFORE_START,
    ) -> None:
        """Wraps a driver; the limits are seconds of wall time. Answers of RoadGPT's own drivers have none,
        since on a busy machine the first one may have to wait until a function is compiled.

        Raises:
            DriverError: the driver has no method ``steer``.
        """
        self.name = str(getattr(driver, "name", type(driver).__name__))
        self._driver = driver
        self._steer = getattr(driver, "steer", None)
        if not callable(self._steer):
            raise DriverError(
                f"driver '{self.name}' cannot steer: give its class a method steer(self, view) that returns "
                "roadgpt.drive.Command(steer, throttle, brake)"
            )
        self._one_answer = math.inf if type(driver).__module__.startswith(OWN) else one_answer
        self._whole_drive = whole_drive
        self._before_start = before_start
        self._used = 0.0
        self._due = math.inf
        self.handed_to: str | None = None
        self.handovers: list[Handover] = []

    def start(self, road: "Road", world: "World", seed: int) -> None:
        """Calls the driver's ``start``, if it has one.

        Raises:
            DriverError: ``start`` raised an exception or hung.
        """
        start = getattr(self._driver, "start", None)
        if start is not None:
            limit = self._before_start
            late = f"was not ready within {limit:g} s: make start() return sooner"
            self._timed(start, (road, world, seed), limit, 0.0, late)

    def ask(self, view: View) -> tuple[float, float, float]:
        """Asks the driver for a command and returns it as (steer, throttle, brake): finite numbers, steer in
        radians, throttle and brake limited to 0..1.

        Raises:
            DriverError: the driver raised an exception or hung, its answer is not a command, or all its
                answers together have taken longer than the limit for one drive.
        """
        begun = time.perf_counter()
        answer, by = self._timed(self._answer, (view,), self._one_answer, view.time)
        self._used += time.perf_counter() - begun
        if self._used > self._whole_drive:
            raise DriverError(
                f"driver '{self.name}' took more than {self._whole_drive:g} s for one drive: "
                "make steer() faster"
            )
        before, self.handed_to = self.handed_to, by
        if by:
            start = self.handovers.pop().start if before == by else view.time
            self.handovers.append(Handover(start, view.time + view.dt, by))
        return self._checked(answer, view.time)

    def _answer(self, view: View) -> tuple[Any, str | None]:
        answer = self._steer(view)  # type: ignore[misc]
        by = getattr(self._driver, "handed_to", None)
        return answer, None if by is None or by == self.name else _short(by, quoted=not str(by).isprintable())

    def _timed(self, method: Any, given: tuple[Any, ...], limit: float, at: float, late: str = "") -> Any:
        """Calls a method of the driver, and stops it after ``limit`` seconds; ``at`` is the time in seconds
        since the start of the drive."""
        self._due = time.perf_counter() + limit
        try:
            answer = method(*given)
            self._due = math.inf
        except (KeyboardInterrupt, RemoteDriverError):
            raise
        except BaseException as error:  # a driver may raise anything; it costs this drive only
            raise self._failure(error, at, late) from error
        finally:
            self._due = math.inf
        return answer

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

    def _failure(self, error: BaseException, at: float, late: str = "") -> DriverError:
        if isinstance(error, _HungError):
            late = late or (
                f"gave no answer within {self._one_answer:g} s at {at:.2f} s of its drive: "
                "make steer() return at once"
            )
            return DriverError(f"driver '{self.name}' {late}")
        return DriverError(
            f"driver '{self.name}' raised {type(error).__name__} at {at:.2f} s of its drive"
            f"{self._line(error)}: {_short(str(error) or 'no message', quoted=False)}"
        )

    def _line(self, error: BaseException) -> str:
        """Returns as text the innermost line of the traceback that is in the driver's own file, or in any
        file if the traceback does not contain the driver's own."""
        passed = traceback.extract_tb(error.__traceback__)
        frames = [frame for frame in passed if frame.filename != __file__]
        module = sys.modules.get(type(self._driver).__module__)
        own = [frame for frame in frames if frame.filename == getattr(module, "__file__", None)]
        if not frames:
            return ""
        last = (own or frames)[-1]
        return f" ({last.filename}, line {last.lineno})"

    @contextlib.contextmanager
    def watched(self) -> Iterator[None]:
        """Context manager: while it is open, a driver that exceeds its time limit is stopped."""
        try:
            with _by_signal(self) if _has_signals() else _by_thread(self):
                yield
        except _HungError as error:  # raised at the moment when the answer arrived
            raise self._failure(error, 0.0) from error

    def is_late(self) -> bool:
        """Returns whether a call of the driver is in progress and has exceeded its time limit."""
        return time.perf_counter() > self._due


def _has_signals() -> bool:
    """Returns whether an alarm can be set here, and the present handler restored afterwards."""
    return (
        hasattr(signal, "setitimer")
        and threading.current_thread() is threading.main_thread()
        and signal.getsignal(signal.SIGALRM) is not None  # None: a C library has set its own handler
    )


@contextlib.contextmanager
def _by_signal(guard: DriverGuard) -> Iterator[None]:
    begun = time.perf_counter()
    left, every = signal.getitimer(signal.ITIMER_REAL)
    before = signal.getsignal(signal.SIGALRM)

    def look(number: int, frame: Any) -> None:
        if left and time.perf_counter() - begun > left and callable(before):
            before(number, frame)  # another alarm, such as a test's time limit, fell due during ours
        if guard.is_late():
            raise _HungError

    signal.signal(signal.SIGALRM, look)
    signal.setitimer(signal.ITIMER_REAL, TICK, TICK)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        if left:
            signal.setitimer(signal.ITIMER_REAL, max(left - (time.perf_counter() - begun), 1e-3), every)


@contextlib.contextmanager
def _by_thread(guard: DriverGuard) -> Iterator[None]:
    asked = ctypes.c_ulong(threading.get_ident())
    done = threading.Event()

    def look() -> None:
        while not done.wait(TICK):
            if guard.is_late():
                ctypes.pythonapi.PyThreadState_SetAsyncExc(asked, ctypes.py_object(_HungError))

    watcher = threading.Thread(target=look, name="roadgpt-guard", daemon=True)
    watcher.start()
    try:
        yield
    finally:
        done.set()
        watcher.join()
        # An exception that was sent but not yet raised must not surface in the caller's code.
        ctypes.pythonapi.PyThreadState_SetAsyncExc(asked, None)


def _short(value: Any, quoted: bool = True) -> str:
    try:
        text = repr(value) if quoted else str(value)
    except Exception:
        text = f"an object of {type(value).__name__}"
    return text if len(text) <= 120 else text[:117] + "..."
