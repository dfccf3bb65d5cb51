"""Machine code where it can be had, plain Python where not: the same functions either way.

All or nothing, and decided once: where numba or llvmlite is missing or does not load, or MuJoCo's library
cannot be called at its addresses, everything is plain Python, far slower. ``ROADGPT_NO_NUMBA=1`` forces it.
``roadgpt doctor`` tells which is used.
"""

import logging
import os
import warnings
from collections.abc import Callable
from typing import Any, TypeVar

from roadgpt.drive.native import addresses, intrinsic_call

Function = TypeVar("Function", bound=Callable[..., Any])


def _numba() -> tuple[Any, Any, str]:
    """Numba, the call of a function at its address, and in words why there are none."""
    if os.environ.get("ROADGPT_NO_NUMBA", "") not in ("", "0"):
        return None, None, "ROADGPT_NO_NUMBA is set"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import numba

            call = intrinsic_call()
            addresses()
    except Exception as error:  # what a broken installation raises cannot be foreseen
        return None, None, f"{type(error).__name__}: {error}"
    return numba, call, ""


numba, call_at, WHY_NOT = _numba()
COMPILES = numba is not None
"""Does this process compile its inner loops? If not, WHY_NOT tells why."""

COMPILING = "compiling the simulator for this machine, once after an installation: 10 to 30 s"


def _announce() -> None:
    """Have the log say why the first drive of an installation takes long, before numba begins to compile."""
    from numba.core.event import Event, Listener, register

    class Announcement(Listener):
        is_made = False

        def on_start(self, event: Event) -> None:
            if not self.is_made:
                self.is_made = True
                logging.getLogger("roadgpt").warning("roadgpt: %s", COMPILING)

        def on_end(self, event: Event) -> None:
            pass

    register("numba:compile", Announcement())  # type: ignore[no-untyped-call]


if COMPILES:
    _announce()


def compiled(function: Function) -> Function:
    """The function as machine code, kept on disk for the next process where the disk allows it."""
    if not COMPILES:
        return function
    try:
        made: Function = numba.njit(cache=True, nogil=True)(function)
    except RuntimeError:  # no folder to keep it in can be written to
        made = numba.njit(nogil=True)(function)
    return made


def inlined(function: Function) -> Function:
    """A small function that only compiled functions call; kept with them, never on its own."""
    if not COMPILES:
        return function
    made: Function = numba.njit(nogil=True)(function)
    return made
