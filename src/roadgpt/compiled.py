"""Compiles the inner loops of drives and images to machine code.

If numba or llvmlite does not load, or MuJoCo's functions cannot be called by their addresses, all run as
plain Python: drives are far slower, and an image takes minutes. ``ROADGPT_NO_NUMBA=1`` forces that, and
``roadgpt doctor`` shows it."""

import ctypes
import functools
import logging
import os
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

from roadgpt.reading import digest

try:
    import fcntl
except ImportError:  # Windows: each process compiles for itself
    fcntl = None  # type: ignore[assignment]

FUNCTIONS = ("mj_step1", "mj_step2", "mj_kinematics")
LIBRARIES = ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll")  # by system; names contain the version

Function = TypeVar("Function", bound=Callable[..., Any])


@functools.cache
def addresses() -> tuple[int, ...]:
    """Returns the memory addresses of FUNCTIONS in the library that MuJoCo's bindings use, or raises an
    error."""
    import mujoco

    folder = Path(mujoco.__file__).parent
    found = [path for name in LIBRARIES for path in sorted(folder.glob(name))]
    if not found:
        raise FileNotFoundError(f"MuJoCo's library is not in {folder}")
    library = ctypes.CDLL(str(found[0]))
    made = tuple(ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0 for name in FUNCTIONS)
    if not all(hasattr(kind, "_address") for kind in (mujoco.MjModel, mujoco.MjData)):
        raise AttributeError("MuJoCo's bindings do not expose the address of a model")
    return made


def _intrinsic_call() -> Any:
    """Returns what lets compiled code call a C function ``void function(model, data)`` by its address."""
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    def by_address(_typing: Any, _function: Any, _model: Any, _data: Any) -> Any:
        def build(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
            address = ir.IntType(8).as_pointer()
            kind = ir.FunctionType(ir.VoidType(), [address, address])
            target, *pointers = arguments
            pointers = [builder.inttoptr(p, address) for p in pointers]
            builder.call(builder.inttoptr(target, kind.as_pointer()), pointers)
            return context.get_dummy_value()

        return types.void(types.intp, types.intp, types.intp), build

    return intrinsic(by_address)


def _numba() -> tuple[Any, Any, str]:
    if os.environ.get("ROADGPT_NO_NUMBA", "") not in ("", "0"):
        return None, None, "ROADGPT_NO_NUMBA is set"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import numba

            call = _intrinsic_call()
            addresses()
    except Exception as error:  # a broken installation may raise anything
        return None, None, f"{type(error).__name__}: {error}"
    return numba, call, ""


numba, call_at, WHY_NOT = _numba()
COMPILES = numba is not None
"""Whether this process compiles its inner loops; if not, WHY_NOT says why."""

BUSY, SAID = "roadgpt.compiling", "roadgpt.said"  # files beside the machine code, which processes lock
COMPILING = "compiling the simulator for this machine, once after an installation: 10 to 30 s"


@functools.cache
def _file(name: str) -> int | None:
    """Returns the number of a file that stays open, beside the machine code; None if none can be locked."""
    try:
        folder = Path(numba.core.caching.FunctionCache(_file.__wrapped__).cache_path)
        folder.mkdir(parents=True, exist_ok=True)
        return None if fcntl is None else os.open(folder / name, os.O_WRONLY | os.O_CREAT)
    except (OSError, RuntimeError):
        return None


class _Turn:
    """Lets one process at a time compile; the others wait, and load what it has kept."""

    depth = 0  # functions that this process compiles, each for the one before it

    def __enter__(self) -> None:
        self.depth += 1
        if self.depth == 1 and (file := _file(BUSY)) is not None:
            fcntl.flock(file, fcntl.LOCK_EX)

    def __exit__(self, *_: object) -> None:
        self.depth -= 1
        if self.depth == 0 and (file := _file(BUSY)) is not None:
            fcntl.flock(file, fcntl.LOCK_UN)


_turn = _Turn()


def _in_turn(compile_: Callable[..., Any], signature: Any) -> Any:
    with numba.core.compiler_lock.global_compiler_lock, _turn:
        return compile_(signature)


def _is_first() -> bool:
    """Returns whether no other process that still runs has said that it compiles."""
    try:
        if (file := _file(SAID)) is not None:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def announce() -> None:
    """Makes the first drive after an installation say why it takes long, before numba begins to compile; of
    several processes at once, one says it."""
    if not COMPILES:
        return
    from numba.core.event import Event, Listener, register

    class Announcement(Listener):
        is_made = False

        def on_start(self, event: Event) -> None:
            if not self.is_made:
                self.is_made = True
                if _is_first():
                    logging.getLogger("roadgpt").warning("roadgpt: %s", COMPILING)

        def on_end(self, event: Event) -> None:
            pass

    register("numba:compile", Announcement())  # type: ignore[no-untyped-call]


SOURCES = "-".join(
    digest(Path(__file__).parent / each, "*.py")
    for each in ("drive", "geometry/boxes.py", "ground", "scene", "traffic", "road/profile.py")
    if COMPILES
)
"""Stands for all that becomes part of machine code."""


def compiled(function: Function) -> Function:
    """Returns the function as machine code, which is kept for later processes if the cache folder is
    writable. Fast-math is off, so that the same inputs always give the same bytes."""
    if not COMPILES:
        return function
    # Numba notices changes in the function's own file only, not in the files of functions that it calls; but
    # the names of the files in its cache begin with this name.
    function.__qualname__ += f"-{SOURCES}"
    try:
        made: Function = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
        cast(Any, made).compile = functools.partial(_in_turn, cast(Any, made).compile)
    except RuntimeError:  # there is no writable folder for the cache
        made = numba.njit(nogil=True, error_model="numpy")(function)
    return made


def bound(function: Function, arguments: tuple[Any, ...]) -> Function:
    """Returns the machine code of a function from ``compiled``, for the types that ``arguments`` have. It
    does not check them, which would often take longer than the function itself: other types are misread."""
    if not COMPILES:
        return function
    dispatcher = cast(Any, function)
    types = tuple(map(dispatcher.typeof_pyval, arguments))
    dispatcher.compile(types)
    return cast(Function, dispatcher.get_overload(types))


def inlined(function: Function) -> Function:
    """Returns a small function that is inlined into the compiled functions that call it."""
    if not COMPILES:
        return function
    made: Function = numba.njit(nogil=True, error_model="numpy", forceinline=True)(function)
    return made
