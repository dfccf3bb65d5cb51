"""What the default installation does without: whole campaigns run where these packages cannot be imported."""

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WITHOUT = {"ribs", "pandas", "sklearn", "joblib", "pyarrow"}
SCRIPT = f"""
import sys

class Refused:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {WITHOUT!r}:
            raise ImportError(name + " is not there")

sys.meta_path.insert(0, Refused())
from pathlib import Path
import roadgpt.campaign.executors.processes as processes
from roadgpt.campaign import CellBudget, Plan, Record, begin, read_trace, work
from roadgpt.campaign.workers.in_process import InProcess

processes.Processes = InProcess  # so that nothing of it runs where they can be imported
for archive, tests in (("grid", 12), ("cvt", 4)):
    folder = Path(sys.argv[1], archive)
    settings = {{"batch": 1, "candidates": 1, "archive": archive, "cells": 20}}
    plan = Plan(prompts=("| flat turns=1..2 len=50..90",), generators=("quality_diversity",), goal="coverage",
                settings=settings, budget=CellBudget(tests=tests), reader="plan")
    begin(plan, folder)
    for progress in work(folder):
        pass
    assert len(read_trace(folder, "c01", 2)) > 10
    with Record.opened(folder) as record:
        assert len(list(record.results())) == tests
    print("done", archive, progress.done)
assert not [name for name in sys.modules if name.partition(".")[0] in {WITHOUT!r}]
"""


def test_a_search_needs_none_of_them(tmp_path: Path) -> None:
    """Twelve tests on the grid, so that the surrogate, which learns from ten, chooses the last of them."""
    words = [sys.executable, "-c", SCRIPT, str(tmp_path)]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=280, check=False)
    assert ended.stdout == "done grid 12\ndone cvt 4\n", ended.stderr
    assert ended.returncode == 0, ended.stderr


def test_nothing_imports_them_but_the_reader_of_old_traces() -> None:
    found = set()
    for path in (ROOT / "src" / "roadgpt").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if path.name != "surrogate.py" and not any(name in text for name in WITHOUT):
            continue  # to parse every file takes seconds
        for node in ast.walk(ast.parse(text)):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) and not node.level else []
            found |= {(path.name, name.partition(".")[0]) for name in names}
    assert {(file, name) for file, name in found if name in WITHOUT} == {("traces.py", "pyarrow")}
    assert ("surrogate.py", "numpy") in found


def test_the_project_does_not_ask_for_them() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = " ".join(project["dependencies"]).lower().replace("scikit-learn", "sklearn")
    assert not {name for name in WITHOUT if name in wanted}
    assert "ribs" in " ".join(project["optional-dependencies"]["test"])
