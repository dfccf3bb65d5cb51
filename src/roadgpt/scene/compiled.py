"""Compiles the inner loops to machine code; plain Python would take minutes per image."""

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
    """Returns the function as machine code, cached on disk for later processes if the folder is writable.
    The compiler's fast-math option is off, so that the same inputs always give the same bytes."""
    try:
        made: Function = NUMBA.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # there is no writable folder for the cache
        made = NUMBA.njit(nogil=True, error_model="numpy")(function)
    return made


def inlined(function: Function) -> Function:
    """Compiles a small function for inlining into the compiled functions that call it."""
    made: Function = NUMBA.njit(nogil=True, error_model="numpy", forceinline=True)(function)
    return made
