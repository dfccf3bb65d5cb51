"""Why the first drive of an installation takes long is said once, and never again; kept machine code is not
used for other source code."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import roadgpt
from roadgpt.compiled import COMPILING

CALLER = """
import roadgpt.compiled
from roadgpt.drive.simulators.mujoco.dynamics import slip_valve
from roadgpt.scene.patterns import dashed
from roadgpt.scene.shade import PERIOD

@roadgpt.compiled.compiled
def valve():
    return slip_valve(0.5, 0.3, 0.1, 0.002)

@roadgpt.compiled.compiled
def dashes():
    return dashed(7.0, 4.0, 12.0)

@roadgpt.compiled.compiled
def period():
    return PERIOD

print(valve(), dashes(), period())
"""
START = "import logging, runpy; logging.getLogger('roadgpt').setLevel({level}); runpy.run_path({script!r})"
CALLED = "valve", "dashes", "period"
CHANGES = [
    ("drive/simulators/mujoco/dynamics.py", "rate = 20.0", "rate = 2.0"),
    ("scene/patterns.py", "return whole * dash +", "return 1.0 +"),
    ("road/profile.py", "DASH, GAP = 4.0", "DASH, GAP = 5.0"),
]
SAYS = f"roadgpt: {COMPILING}\n"


class Copy:
    """A copy of the package, whose machine code is kept in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.kept, self.package = folder / "kept", folder / "src" / "roadgpt"
        # What Python compiled comes along and is used as long as its source is the same: to do it again for
        # each process takes longer than all else. Machine code does not come along.
        other = shutil.ignore_patterns("*.nb?*", "*.pyc.*")
        shutil.copytree(Path(roadgpt.__file__).parent, self.package, ignore=other)
        self.script = folder / "caller.py"
        self.script.write_text(CALLER)

    def started(self, is_quiet: bool = False) -> "subprocess.Popen[str]":
        env = {**os.environ, "PYTHONPATH": str(self.package.parent), "NUMBA_CACHE_DIR": str(self.kept)}
        start = START.format(level=40 if is_quiet else 0, script=str(self.script))
        command = [sys.executable, "-B", "-c", start]
        return subprocess.Popen(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def answers(self, is_quiet: bool = False) -> tuple[list[str], str]:
        """What a new process answers, and what it says on standard error."""
        return answer_of(self.started(is_quiet))

    def codes(self) -> list[Path]:
        return sorted(self.kept.rglob("*.nbc"))

    def change(self, file: str, old: str, new: str) -> None:
        text = (self.package / file).read_text(encoding="utf-8")
        assert text.count(old) == 1
        (self.package / file).write_text(text.replace(old, new), encoding="utf-8")


def answer_of(process: "subprocess.Popen[str]") -> tuple[list[str], str]:
    out, said = process.communicate(timeout=120)
    assert process.returncode == 0, said
    return out.split(), said


def test_of_processes_that_start_at_once_one_compiles_and_says_so(tmp_path: Path) -> None:
    copy = Copy(tmp_path)
    answers = [answer_of(process) for process in [copy.started() for _ in range(3)]]
    assert len({tuple(out) for out, _ in answers}) == 1
    assert sorted(said for _, said in answers) == ["", "", SAYS]
    assert {path.name.partition("-")[0] for path in copy.codes()} >= {f"caller.{name}" for name in CALLED}


def test_it_is_said_once_while_code_is_compiled_and_kept_code_is_not_used_where_its_files_have_changed(
    tmp_path: Path,
) -> None:
    copy = Copy(tmp_path)
    before, said = copy.answers()
    assert said == SAYS  # once for three functions
    kept = copy.codes()
    assert {path.name.partition("-")[0] for path in kept} >= {f"caller.{name}" for name in CALLED}
    written = [path.stat().st_mtime_ns for path in kept]
    assert copy.answers() == (before, "")
    assert copy.codes() == kept
    assert [path.stat().st_mtime_ns for path in kept] == written
    for numbers, is_quiet in (((0, 1), True), ((2,), False)):  # a profile's numbers are no file of a scene's
        for number in numbers:
            copy.change(*CHANGES[number])
        after, said = copy.answers(is_quiet)
        assert said == ("" if is_quiet else SAYS)
        assert all(after[number] != before[number] for number in numbers)
        before = after
