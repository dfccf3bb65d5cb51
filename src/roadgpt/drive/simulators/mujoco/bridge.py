"""Calls MuJoCo's functions: compiled code calls them by address, and plain Python calls them through MuJoCo's
bindings."""

import functools
from typing import Any

import mujoco

from roadgpt.drive.compiled import COMPILES, call_at
from roadgpt.drive.native import FUNCTIONS, addresses

call: Any = call_at if COMPILES else lambda function, model, data: function(model, data)


@functools.cache
def functions() -> tuple[Any, ...]:
    """Returns mj_step1, mj_step2 and mj_kinematics in the form that ``call`` expects."""
    # MuJoCo would log warnings to a file in the current folder; our simulator reports what failed.
    mujoco.set_mju_user_warning(lambda _: None)
    return addresses() if COMPILES else tuple(getattr(mujoco, name) for name in FUNCTIONS)


def handles(model: Any, data: Any) -> tuple[Any, Any]:
    """Returns a MuJoCo model and its data in the form that ``call`` expects."""
    return (model._address, data._address) if COMPILES else (model, data)
