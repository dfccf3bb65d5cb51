"""Where the inner loop cannot be compiled, the car drives in plain Python, and tells only those who ask."""

import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

SCRIPT = """
import ctypes, sys, warnings
warnings.simplefilter("error")
{prelude}
from roadgpt import compiled
from roadgpt.drive.simulators.mujoco import plane
car = plane()
for _ in range(3):
    car.move(0.1, 1.0, 0.0)
from roadgpt.cli.commands import set_up
print(compiled.COMPILES, compiled.WHY_NOT)
print(car.see()["vx"])
print(set_up._numba())
"""
NOT_LOADED = """
import numba, mujoco
def refuse(path): raise OSError("cannot open shared object file")
ctypes.CDLL = refuse
"""


def first_steps(
    prelude: str = "", path: object = "nothing here", forced: str = "0"
) -> tuple[str, float, str]:
    """What a new process says of its choice, how fast its car is in the end, and what doctor says."""
    more = {
        "PYTHONPATH": os.pathsep.join([str(path), os.environ.get("PYTHONPATH", "")]),
        "ROADGPT_NO_NUMBA": forced,
    }
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT.format(prelude=prelude)],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | more,
        timeout=120,
    )
    said, speed, doctor = done.stdout.splitlines()
    assert said.startswith("True") or done.stderr == ""  # who compiles for the first time says so
    return said, float(speed), doctor


@cache
def with_numba() -> tuple[str, float, str]:
    return first_steps()


def test_where_numba_does_not_load_it_drives_in_plain_python(tmp_path: Path) -> None:
    reason = "module numpy has no attribute long"
    (tmp_path / "numba.py").write_text(
        f"import warnings; warnings.warn('soon'); raise AttributeError('{reason}')"
    )
    said, speed, _ = first_steps("", tmp_path)
    assert said == f"False AttributeError: {reason}"
    assert speed == pytest.approx(with_numba()[1], rel=1e-9)


def test_where_mujoco_cannot_be_called_at_its_addresses_it_drives_in_plain_python() -> None:
    said, speed, _ = first_steps(NOT_LOADED)
    assert said == "False OSError: cannot open shared object file"
    assert speed == pytest.approx(with_numba()[1], rel=1e-9)


def test_the_doctor_tells_which_is_used_and_why() -> None:
    assert with_numba()[2] == "compiles the inner loop"
    said, speed, doctor = first_steps(forced="1")
    assert said == "False ROADGPT_NO_NUMBA is set"
    assert doctor == "is not used (ROADGPT_NO_NUMBA is set): drives work, but far slower"
    assert speed == pytest.approx(with_numba()[1], rel=1e-9)
