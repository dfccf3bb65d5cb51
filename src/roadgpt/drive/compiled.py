"""Numba where it can be had, plain Python where not: the same functions either way.

``ROADGPT_NO_NUMBA=1`` forces plain Python; so does a numba that is missing or does not load.
"""

import os
from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def _numba() -> Any:
    if os.environ.get("ROADGPT_NO_NUMBA", "") not in ("", "0"):
        return None
    try:
        import numba
    except (ImportError, OSError, SystemError):
        return None
    return numba


numba: Any = _numba()
COMPILES = numba is not None
"""Does this process compile its inner loops?"""


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
