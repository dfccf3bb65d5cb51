"""How our code calls MuJoCo: compiled code by the addresses of its functions, so no linker has to find a
name; plain Python through MuJoCo's own bindings.
"""

import functools
from typing import Any

import mujoco

from roadgpt.drive.compiled import COMPILES, call_at
from roadgpt.drive.native import FUNCTIONS, addresses


def _by_bindings(function: Any, model: Any, data: Any) -> None:
    """Calls ``function(model, data)``."""
    function(model, data)


call: Any = call_at if COMPILES else _by_bindings


@functools.cache
def functions() -> tuple[Any, ...]:
    """MuJoCo's two half steps, and its kinematics alone, as `call` takes them."""
    # MuJoCo would log warnings in a file where the user stands; our simulator says what broke down.
    mujoco.set_mju_user_warning(lambda _: None)
    return addresses() if COMPILES else tuple(getattr(mujoco, name) for name in FUNCTIONS)


def handles(model: Any, data: Any) -> tuple[Any, Any]:
    """A model and its data, as `call` takes them."""
    return (model._address, data._address) if COMPILES else (model, data)
