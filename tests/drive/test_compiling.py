"""Why the first drive of an installation takes long is said once, and never again."""

import os
import subprocess
import sys
from pathlib import Path

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
