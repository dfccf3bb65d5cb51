"""Finds the addresses of MuJoCo's functions in memory, so that compiled code can call them."""

import ctypes
import functools
from pathlib import Path
from typing import Any

FUNCTIONS = ("mj_step1", "mj_step2", "mj_kinematics")
LIBRARIES = ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll")  # by system; names contain the version


@functools.cache
def addresses() -> tuple[int, ...]:
    """Returns the memory addresses of the functions listed in FUNCTIONS, in the library that MuJoCo's
    bindings use.

    Raises:
        OSError: the library is missing or does not load.
        AttributeError: the library lacks one of the functions, or the bindings do not expose the address of a
            model.
    """
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


def intrinsic_call() -> Any:
    """Returns a function with which compiled code calls a C function ``void function(model, data)``. The
    returned function takes the addresses of the C function, of the model and of the data.

    Raises:
        ImportError: numba or llvmlite is missing.
    """
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
