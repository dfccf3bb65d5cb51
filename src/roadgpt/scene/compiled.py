"""Compiles the inner loops of the renderer to machine code; plain Python would take minutes per image."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from roadgpt.reading import digest
from roadgpt.road.profile import DASH, GAP

Function = TypeVar("Function", bound=Callable[..., Any])


def _numba() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import numba

        return numba


NUMBA = _numba()


SOURCES = f"{digest(Path(__file__).parent, '*.py')}-{DASH}-{GAP}"
"""Stands for all that becomes part of compiled code: the files of this package, and constants of others."""


def compiled(function: Function) -> Function:
    """Returns the function as machine code. If the cache folder is writable, the code is cached on disk for
    later processes.

    The compiler's fast-math option is off, so that the same inputs always give the same bytes.
    """
    # Numba only notices changes in the function's own file, not in the files of functions that it calls. The
    # names of the files in Numba's cache begin with this name, so the digest covers all those files.
    function.__qualname__ += f"-{SOURCES}"
    try:
        made: Function = NUMBA.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # there is no writable folder for the cache
        made = NUMBA.njit(nogil=True, error_model="numpy")(function)
    return made


def inlined(function: Function) -> Function:
    """Compiles a small function for inlining into the compiled functions that call it."""
    made: Function = NUMBA.njit(nogil=True, error_model="numpy", forceinline=True)(function)
    return made
