"""Why the first drive of an installation takes long is said once, and never again; kept machine code is not
used for other source code."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import roadgpt
from roadgpt.drive.compiled import COMPILING

LOOP = """
from roadgpt.drive.compiled import compiled

@compiled
def twice(x):
    return 2 * x

@compiled
def thrice(x):
    return 3 * x

print(twice(2), thrice(3.0), twice(1.5))
"""


def said(script: Path, cache: Path, quiet: bool = False) -> str:
    """What a new process says on standard error, with machine code kept in this folder."""
    start = f"import logging; logging.getLogger('roadgpt').setLevel({'40' if quiet else '0'}); "
    code = start + f"import runpy; runpy.run_path({str(script)!r})"
    env = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    done = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["4", "9.0", "3.0"]
    return done.stderr


def test_it_is_said_once_while_code_is_compiled_and_not_when_it_is_kept(tmp_path: Path) -> None:
    script = tmp_path / "loop.py"
    script.write_text(LOOP)
    assert said(script, tmp_path / "kept").splitlines() == [f"roadgpt: {COMPILING}"]
    assert said(script, tmp_path / "kept") == ""
    assert said(script, tmp_path / "other", quiet=True) == ""


CALLER = """
import roadgpt.drive.compiled, roadgpt.scene.compiled
from roadgpt.drive.simulators.mujoco.chassis_control import slip_valve
from roadgpt.scene.patterns import dashed
from roadgpt.scene.surfaces import PERIOD

@roadgpt.drive.compiled.compiled
def valve():
    return slip_valve(0.5, 0.3, 0.1, 0.002)

@roadgpt.scene.compiled.compiled
def dashes():
    return dashed(7.0, 4.0, 12.0)

@roadgpt.scene.compiled.compiled
def period():
    return PERIOD

print(valve(), dashes(), period())
"""
CALLED = "valve", "dashes", "period"
CHANGES = [
    ("drive/simulators/mujoco/chassis_control.py", "rate = 20.0", "rate = 2.0"),
    ("scene/patterns.py", "return whole * dash +", "return 1.0 +"),
    ("road/profile.py", "DASH, GAP = 4.0", "DASH, GAP = 5.0"),
]


def test_kept_code_is_not_used_where_a_file_that_it_uses_has_changed(tmp_path: Path) -> None:
    package = tmp_path / "src" / "roadgpt"
    shutil.copytree(Path(roadgpt.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    script = tmp_path / "caller.py"
    script.write_text(CALLER)
    env = {**os.environ, "PYTHONPATH": str(package.parent), "NUMBA_CACHE_DIR": str(tmp_path / "kept")}

    def answers() -> list[str]:
        command = [sys.executable, "-B", str(script)]
        return subprocess.run(command, env=env, capture_output=True, text=True, check=True).stdout.split()

    before = answers()
    kept = sorted((tmp_path / "kept").rglob("*.nbc"))
    assert {path.name.partition("-")[0] for path in kept} >= {
        "caller.valve",
        "caller.dashes",
        "caller.period",
    }
    assert answers() == before
    assert sorted((tmp_path / "kept").rglob("*.nbc")) == kept
    for numbers in ((0, 1), (2,)):  # the numbers of a profile are kept apart from the files of a scene
        for file, old, new in (CHANGES[number] for number in numbers):
            text = (package / file).read_text(encoding="utf-8")
            assert text.count(old) == 1
            (package / file).write_text(text.replace(old, new), encoding="utf-8")
        after = answers()
        assert all(after[number] != before[number] for number in numbers)
        before = after
