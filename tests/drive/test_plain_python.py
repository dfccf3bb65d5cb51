"""Where the inner loop cannot be compiled, the car drives in plain Python, and tells only those who ask."""

import os
import subprocess
import sys
from functools import cache

import pytest

SCRIPT = """
import ctypes, sys, warnings
warnings.simplefilter("error")
{prelude}
from roadgpt.drive import compiled
from roadgpt.drive.simulators.mujoco import plane
car = plane()
for _ in range(3):
    car.move(0.1, 1.0, 0.0)
print(compiled.COMPILES, compiled.WHY_NOT)
print(car.see()["vx"])
"""
NO_LIBRARY = "import numba, mujoco; from pathlib import Path; Path.glob = lambda self, name: iter(())"
NO_SYMBOL = "import numba, mujoco; ctypes.CDLL = lambda path: object()"
NOT_LOADED = """
import numba, mujoco
def refuse(path): raise OSError("cannot open shared object file")
ctypes.CDLL = refuse
"""


@cache
def compiled_speed():
    return first_steps("", "nothing here")[1]


def first_steps(prelude, path):
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT.format(prelude=prelude)],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(path), os.environ.get("PYTHONPATH", "")])},
        timeout=120,
    )
    said, speed = done.stdout.splitlines()
    return said, float(speed), done.stderr


@pytest.mark.parametrize(
    ("module", "raised"),
    [
        ("numba", "ImportError('Numba needs NumPy 1.26 or less')"),
        ("numba", "AttributeError('module numpy has no attribute long')"),
        ("llvmlite", "OSError('could not load libllvmlite.so')"),
        ("llvmlite", "ModuleNotFoundError('no llvmlite')"),
    ],
)
def test_where_numba_does_not_load_it_drives_in_plain_python(tmp_path, module, raised):
    (tmp_path / f"{module}.py").write_text(f"import warnings; warnings.warn('soon'); raise {raised}")
    said, speed, warned = first_steps("", tmp_path)
    kind, _, rest = raised.partition("(")
    assert said == f"False {kind}: {rest[1:-2]}"
    assert speed == pytest.approx(compiled_speed(), rel=1e-9)
    assert warned == ""


@pytest.mark.parametrize(
    ("prelude", "why"),
    [
        (NO_LIBRARY, "FileNotFoundError: MuJoCo's library is not in"),
        (NOT_LOADED, "OSError: cannot open shared object file"),
        (NO_SYMBOL, "AttributeError: 'object' object has no attribute 'mj_step1'"),
    ],
)
def test_where_mujoco_cannot_be_called_at_its_addresses_it_drives_in_plain_python(tmp_path, prelude, why):
    said, speed, warned = first_steps(prelude, tmp_path)
    assert said.startswith(f"False {why}")
    assert speed == pytest.approx(compiled_speed(), rel=1e-9)
    assert warned == ""


def test_the_doctor_tells_which_is_used_and_why():
    script = "from roadgpt.cli.commands import doctor; print(doctor._numba())"
    said = {}
    for forced in ("0", "1"):
        done = subprocess.run(
            [sys.executable, "-c", script],
            capture_output=True,
            text=True,
            check=True,
            env=os.environ | {"ROADGPT_NO_NUMBA": forced},
            timeout=120,
        )
        said[forced] = done.stdout.strip()
    assert said["0"] == "compiles the inner loop"
    assert said["1"] == "is not used (ROADGPT_NO_NUMBA is set): drives work, but far slower"
