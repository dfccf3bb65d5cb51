"""Stops the program at Ctrl-C or SIGTERM. A second signal ends the program at once.

A signal raises KeyboardInterrupt, so that waiting ends, files are closed and finished work is kept. However,
Python drops exceptions that are raised in a ``__del__`` method or in the callback of a weak reference. The
signal is therefore recorded as well: long computations call ``look`` between their steps, and a
KeyboardInterrupt that Python reports as dropped is raised again."""

import _thread
import atexit
import os
import signal
import sys
import threading
import time
from contextlib import suppress
from types import FrameType
from typing import Any

from roadgpt import children

SIGNALS = (signal.SIGINT, signal.SIGTERM)
USUAL = (signal.default_int_handler, signal.SIG_DFL)
ONE_PRESS = 0.3  # s: a terminal and a program that forwards signals send the same one twice
AGAIN = 0.05  # s until an exception that Python dropped is raised again
LONGER = 1.3  # factor by which this time grows, so that it does not always hit the same callback


class _State:
    number = 0  # of the signal that was received
    since = 0.0
    is_raised = False  # ``look`` has raised a KeyboardInterrupt for this signal
    is_again = False  # the next signal will be one that this process sent to itself
    drops = 0  # times that Python dropped the KeyboardInterrupt
    is_over = False  # all work is done, so that nothing can be lost


def install() -> None:
    """Installs handlers for Ctrl-C and SIGTERM, unless the parent process had them ignored."""
    for number in SIGNALS:
        if signal.getsignal(number) in USUAL:
            signal.signal(number, _heard)
    sys.unraisablehook = _dropped


def look() -> None:
    """Raises KeyboardInterrupt in the main thread, once, if a signal was received; long computations call it
    between their steps."""
    if _State.number and not _State.is_raised and threading.current_thread() is threading.main_thread():
        _State.is_raised = True
        raise KeyboardInterrupt


def status() -> int:
    """Returns the exit status for the received signal, such as 130 for Ctrl-C; 0 if there was none."""
    return 128 + _State.number if _State.number else 0


def forget() -> None:
    """Forgets a received signal, when the interrupted work has stopped and the program continues."""
    _State.number, _State.is_raised = 0, False


def finish() -> None:
    """Marks all work as done. A signal after this call ends the program at once, without a message."""
    _State.is_over = True


def leave() -> None:
    """If a signal was received, ends the process at once with its exit status. After a KeyboardInterrupt in a
    C library, Python would end by SIGINT and ignore the exit status."""
    if not status():
        return
    finish()
    with suppress(Exception):
        atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):
            stream.flush()
    os._exit(status())


def _heard(number: int, frame: FrameType | None) -> None:
    if _State.is_again:
        _State.is_again = False
        if not _State.is_raised:
            raise KeyboardInterrupt
        return
    now = time.monotonic()
    if _State.is_over or (_State.number and now - _State.since > ONE_PRESS):
        children.kill_all()
        os._exit(128 + number)
    if _State.number:
        return
    _State.number, _State.since = number, now
    raise KeyboardInterrupt


def _dropped(what: Any) -> None:
    if not _State.number:
        sys.__unraisablehook__(what)
        return
    if not issubclass(what.exc_type, KeyboardInterrupt):
        return  # from an object that was incomplete when the signal came
    timer = threading.Timer(min(AGAIN * LONGER**_State.drops, 1.0), _once_more)
    _State.drops += 1
    timer.daemon = True
    with suppress(RuntimeError):  # Python is shutting down
        timer.start()


def _once_more() -> None:
    if _State.is_raised or _State.is_over or not _State.number:
        return
    _State.is_again = True
    main = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main is not None:
        signal.pthread_kill(main, _State.number)  # also interrupts a blocking call
    else:
        _thread.interrupt_main(signal.Signals(_State.number))
