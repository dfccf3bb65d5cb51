"""Registers functions that are called when the generator's process ends."""

from __future__ import annotations

import atexit
import signal
import sys
from typing import Any, Callable, List

_REGISTERED: List[Callable[[], None]] = []


def register_exit_fun(
    fun: Any = None,
    signals: Any = (signal.SIGTERM,),
    logfun: Any = lambda said: print(said, file=sys.stderr),
) -> Any:
    """Registers a function that is called once, when the generator ends or receives one of ``signals`` (by
    default, SIGTERM). It can also be used as a decorator."""
    if fun is None:
        return lambda wrapped: register_exit_fun(wrapped, signals, logfun)
    if not callable(fun):
        raise TypeError(f"{fun!r} cannot be called")
    was_called: List[bool] = []

    def once() -> None:
        if not was_called:
            was_called.append(True)
            fun()

    def on_signal(number: int, frame: Any) -> None:
        del frame
        if logfun is not None:
            logfun(f"signal {number}")
        once()
        if number == signal.SIGINT:
            raise KeyboardInterrupt
        sys.exit(number)

    for number in signals or ():
        signal.signal(number, on_signal)
    _REGISTERED.append(once)
    atexit.register(once)
    return fun


def ended() -> None:
    """Calls the registered functions, the most recently registered one first."""
    while _REGISTERED:
        _REGISTERED.pop()()
