"""How the program stops: one Ctrl-C is enough, SIGTERM is taken alike, and a second one ends it at once.

A signal raises KeyboardInterrupt, so that whatever waits is left, files are closed and what is finished is
kept. But Python drops an exception that is raised while it runs the callback of a weak reference or a
``__del__``. So the signal is written down as well: long work looks between its steps (``look``), and where
Python says that it dropped the exception, it is raised once more.
"""

import _thread
import atexit
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

from roadgpt import children

SIGNALS = (signal.SIGINT, signal.SIGTERM)
USUAL = (signal.default_int_handler, signal.SIG_DFL)
ONE_PRESS = 0.3  # s: a terminal and a program that hands signals on send the same one twice
AGAIN = 0.05  # s until an exception that Python dropped is raised once more
LONGER = 1.3  # times as long each time, so that it does not always fall into the same callback


class _State:
    """Of this process."""

    number = 0
    """Of the signal that came; 0: none."""
    since = 0.0
    is_raised = False
    """Has somebody who looked been told?"""
    is_again = False
    drops = 0
    """Is the next signal one of our own?"""
    is_over = False
    """Is all work done, so that nothing is lost?"""


def install() -> None:
    """Heed signals from now on; those that whoever started us had ignored stay so."""
    for number in SIGNALS:
        if signal.getsignal(number) in USUAL:
            signal.signal(number, _heard)
    sys.unraisablehook = _dropped


def look() -> None:
    """Between two steps of long work: is it to stop?

    Raises:
        KeyboardInterrupt: it is, and has not been told yet.
    """
    if _State.number and not _State.is_raised and threading.current_thread() is threading.main_thread():
        _State.is_raised = True
        raise KeyboardInterrupt


def status() -> int:
    """The exit status that shells have for a program that a signal stopped; 0: none came."""
    return 128 + _State.number if _State.number else 0


@contextmanager
def shielded() -> Iterator[None]:
    """Processes that are started meanwhile never hear a terminal's Ctrl-C: we do, and end them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def forget() -> None:
    """What was to stop has stopped, and the program goes on."""
    _State.number, _State.is_raised = 0, False


def finish() -> None:
    """All work is done: a signal that comes now ends the program at once, and without a word."""
    _State.is_over = True


def leave() -> None:
    """Where a signal came: end the process with its status, and do not wait for threads.

    Python itself would end it by SIGINT, whatever the status is to be, where a library in C has seen the
    KeyboardInterrupt pass.
    """
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
    """Python's hook for exceptions that nobody can catch."""
    if not _State.number:
        sys.__unraisablehook__(what)
        return
    if not issubclass(what.exc_type, KeyboardInterrupt):
        return  # of an object that was half made when the signal came
    timer = threading.Timer(min(AGAIN * LONGER**_State.drops, 1.0), _once_more)
    _State.drops += 1
    timer.daemon = True
    with suppress(RuntimeError):  # Python is ending, and so is the program
        timer.start()


def _once_more() -> None:
    if _State.is_raised or _State.is_over or not _State.number:
        return
    _State.is_again = True
    main = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main is not None:
        signal.pthread_kill(main, _State.number)  # ends its waiting, too
    else:
        _thread.interrupt_main(signal.Signals(_State.number))
