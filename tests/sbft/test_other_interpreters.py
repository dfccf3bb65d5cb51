"""Generators in an interpreter of their own, and RoadGPT asked from another one."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from authorities.sbft_official_slow import verdict
from misbehaving import write
from roadgpt.cli import app
from roadgpt.errors import UsageError
from roadgpt_sbft import Experiment, compete
from sbft.interpreters import old_pythons
from sbft.test_our_generator import LEFT, roads_here, run_pipeline

OLD = old_pythons()
PYTHONS = [sys.executable, *OLD[:1]]  # what the oldest understands, those between do as well
COPIES = """
import copy, pickle
copied = copy.deepcopy(self.executor)
assert copied is not self.executor and copied.stats is not self.executor.stats
assert type(copied) is type(self.executor) and copied.stats.test_generated == 2
assert copied.oob_tolerance == self.executor.oob_tolerance == 0.85
assert self.executor.risk_value == 0.7 and abs(self.executor.max_speed_in_ms - 70 / 3.6) < 1e-9
assert copied.execute_test(RoadTestFactory.create_road_test(straight(95.0)))[0] == "PASS"
assert (copied.stats.test_generated, self.executor.stats.test_generated) == (3, 2)
assert copied.time_budget.tests == self.executor.time_budget.tests == 3
from code_pipeline.validation import min_radius
from code_pipeline.executors import AbstractTestExecutor
assert isinstance(self.executor, AbstractTestExecutor)
assert min_radius(RoadTestFactory.create_road_test(straight()).interpolated_points) == 0
try:
    pickle.dumps(self.executor)
except TypeError as error:
    assert "only in the process" in str(error)
if hasattr(os, "fork"):
    pid = os.fork()
    if pid == 0:
        try:
            test = RoadTestFactory.create_road_test(straight())
            assert self.executor.validate_test(test) == (True, "")
            self.executor.execute_test(test)
        except RuntimeError as error:
            os._exit(7 if "first process" in str(error) else 1)
        os._exit(2)
    assert os.WEXITSTATUS(os.waitpid(pid, 0)[1]) == 7
print("in", sys.version)
"""


@pytest.mark.parametrize("python", [None, PYTHONS[-1]])
def test_a_generator_works_in_an_interpreter_of_its_own(python: str | None, tmp_path: Path) -> None:
    write(tmp_path, COPIES)
    experiment = Experiment(
        module_name="misbehaves",
        class_name="Generator",
        module_path=str(tmp_path),
        test_budget=9,
        python=python,
    )
    from roadgpt_sbft.competition import USUAL

    world = USUAL.changed(oob_tolerance=0.85)
    work = compete(experiment, world, out=tmp_path / "out")
    assert [run.outcome for run in work] == ["PASS"] * 3
    assert work.ending is not None
    assert work.ending.how == "done", work.ending.sentence


@pytest.mark.parametrize(
    ("python", "said"),
    [("/nowhere/python", "cannot be started"), ("PROGRAM", "does not run generators"), ("OLD", "too old")],
)
def test_an_interpreter_that_is_none_is_told_of(python: str, said: str, tmp_path: Path) -> None:
    if os.name != "posix":
        pytest.skip("programs are scripts here")
    script = tmp_path / "script"
    answers = {"PROGRAM": "exit 0", "OLD": 'echo \'{"op": "end", "how": "unasked", "said": "too old"}\''}
    script.write_text(f"#!/bin/sh\n{answers.get(python, '')}\n")
    script.chmod(0o755)
    experiment = Experiment(
        module_name="nothing",
        class_name="Nothing",
        test_budget=1,
        python=python if python.startswith("/") else str(script),
    )
    with pytest.raises(UsageError, match=said):
        list(compete(experiment, out=tmp_path / "out"))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("python", PYTHONS[-1:])
def test_the_client_brings_the_same_roads_from_any_interpreter(
    python: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "roadgpt_client.py"
    written = CliRunner().invoke(app, ["compete", "sbft", "--client", str(file)])
    assert written.exit_code == 0, written.output
    assert sys.executable in written.output
    assert CliRunner().invoke(app, ["compete", "sbft", "--client", str(file)]).exit_code == 2, (
        "nothing is written over"
    )
    monkeypatch.setattr(sys, "executable", python)
    theirs = run_pipeline(
        tmp_path,
        "roadgpt_client",
        "RoadGPTTestGenerator",
        **LEFT,
        ROADGPT_PYTHON=PYTHONS[0],
        PYTHONNOUSERSITE="1",
    )
    assert theirs == roads_here()
    assert all(verdict(points, 200) == (True, "") for points in theirs)


def test_the_client_says_in_a_sentence_what_is_missing(tmp_path: Path) -> None:
    file = tmp_path / "roadgpt_client.py"
    assert CliRunner().invoke(app, ["compete", "sbft", "--client", str(file)]).exit_code == 0
    code = (
        "import roadgpt_client as client\n"
        "try:\n    next(client.RoadGPTTestGenerator(map_size=200).roads())\n"
        "except client.RoadGPTError as error:\n    print(error)"
    )

    def told(**environment: str) -> str:
        env = {name: value for name, value in os.environ.items() if name != "ROADGPT_PYTHON"} | environment
        done = subprocess.run(
            [sys.executable, "-S", "-c", code],
            cwd=tmp_path,
            env=env,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "RoadGPT is not installed in this Python" in told()
    assert "cannot be started" in told(ROADGPT_PYTHON="/nowhere/python")
    both = {"ROADGPT_PYTHON": sys.executable}
    assert "'four'" in told(ROADGPT_SEED="four", **both)
    assert "on a map of 200 m" in told(ROADGPT_DESCRIPTION="a straight road of 5 km", **both)
