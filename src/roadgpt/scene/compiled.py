"""Machine code for the inner loops: plain Python would take minutes for one picture."""

import warnings
from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def _numba() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import numba

        return numba


NUMBA = _numba()


def compiled(function: Function) -> Function:
    """The function as machine code, kept on disk for the next process where the disk allows it.

    Without fast mathematics: the same picture has the same bytes.
    """
    try:
        made: Function = NUMBA.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # no folder to keep it in can be written to
        made = NUMBA.njit(nogil=True, error_model="numpy")(function)
    return made


def inlined(function: Function) -> Function:
    """A small function that only compiled functions call; becomes a part of them."""
    made: Function = NUMBA.njit(nogil=True, error_model="numpy", forceinline=True)(function)
    return made
