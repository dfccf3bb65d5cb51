"""How compiled code calls MuJoCo: by the addresses of its functions, so no linker has to find a name.

In plain Python the same call goes through MuJoCo's own bindings.
"""

import ctypes
import functools
from pathlib import Path
from typing import Any

import mujoco

from roadgpt.drive.compiled import COMPILES


def _by_bindings(function: Any, model: Any, data: Any) -> None:
    """Calls ``function(model, data)``."""
    function(model, data)


def _by_address() -> Any:
    """A function for compiled code that calls ``void function(model, data)``; all three are addresses."""
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


call: Any = _by_address() if COMPILES else _by_bindings


@functools.cache
def functions() -> tuple[Any, Any, Any]:
    """MuJoCo's two half steps, and its kinematics alone, as `call` takes them."""
    # MuJoCo would log warnings in a file where the user stands; our simulator says what broke down.
    mujoco.set_mju_user_warning(lambda _: None)
    if not COMPILES:
        return mujoco.mj_step1, mujoco.mj_step2, mujoco.mj_kinematics
    library = ctypes.CDLL(str(_library()))
    names = ("mj_step1", "mj_step2", "mj_kinematics")
    first, second, place = (ctypes.cast(getattr(library, name), ctypes.c_void_p).value for name in names)
    return first, second, place


def handles(model: Any, data: Any) -> tuple[Any, Any]:
    """A model and its data, as `call` takes them."""
    return (model._address, data._address) if COMPILES else (model, data)


def _library() -> Path:
    """The shared library that MuJoCo's bindings use; its name differs by system and version."""
    folder = Path(mujoco.__file__).parent
    names = ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll")
    found = [path for name in names for path in sorted(folder.glob(name))]
    if not found:
        raise ImportError(
            f"MuJoCo's library is not in {folder}: reinstall mujoco-core, or set ROADGPT_NO_NUMBA=1"
        )
    return found[0]
