"""Generators of the competition in our simulator: whatever they do, what they brought is on the disk."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

from misbehaving import write
from roadgpt.errors import UsageError
from roadgpt.run import Run
from roadgpt_sbft import Competition, Experiment, compete
from roadgpt_sbft.generator_process import NAMES

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "sbft"
POSIX = os.name == "posix"


def let_loose(folder: Path, tests: int | None = 10, **more: object) -> tuple[Competition, list[Run]]:
    values = {"module_name": "misbehaves", "class_name": "Generator", "module_path": str(folder)}
    experiment = Experiment.model_validate({**values, "test_budget": tests, "patience": 60, **more})
    work = compete(experiment, out=folder / "out")
    return work, list(work)


def numbers(folder: Path) -> list[int]:
    return sorted(int(path.name.split(".")[1]) for path in (folder / "out").glob("test.*.json"))


def counted(folder: Path) -> dict[str, str]:
    header, row = (folder / "out" / "generation_stats.csv").read_text().splitlines()
    return dict(zip(header.split(","), row.split(","), strict=True))


ENDS = {
    "exits": ("sys.exit(3)", "exit", r"sys.exit\(3\)"),
    "leaves": ("os._exit(9)", "died", "exit status 9"),
    "interrupt": ("raise KeyboardInterrupt", "raised", "KeyboardInterrupt"),
    "noise, and raises": (
        'print(\'{"op": "end", "how": "died"}\', flush=True)\nos.write(1, b\'x\' * 300000)\n'
        "sys.stdin.read()\nraise KeyError('lane')",
        "raised",
        r"KeyError \(.*misbehaves.py, line \d+\): 'lane'",
    ),
    "closed, but for a thread": (
        "os.close(0); os.close(1); os.close(2)\nthreading.Thread(target=time.sleep, args=(600,)).start()",
        "done",
        "finished by itself",
    ),
}
if POSIX:
    ENDS["crash"] = ("os.kill(os.getpid(), signal.SIGSEGV)", "died", "signal 11")


@pytest.mark.parametrize("name", ENDS)
def test_however_a_generator_ends_its_tests_are_kept(name: str, tmp_path: Path) -> None:
    does, how, said = ENDS[name]
    write(tmp_path, does)
    work, runs = let_loose(tmp_path)
    assert work.ending is not None
    assert work.ending.how == how
    assert re.search(said, work.ending.sentence), work.ending.sentence
    assert [run.outcome for run in runs] == ["PASS", "PASS"]
    assert numbers(tmp_path) == [1, 2]
    assert counted(tmp_path)["test_passed"] == "2"


def test_one_that_hangs_is_stopped(tmp_path: Path) -> None:
    write(tmp_path, "time.sleep(600)")
    begun = time.monotonic()
    work, runs = let_loose(tmp_path, patience=3)
    assert time.monotonic() - begun < 120
    assert work.ending is not None
    assert work.ending.how == "hung"
    assert "3 s" in work.ending.sentence
    assert len(runs) == 2
    assert numbers(tmp_path) == [1, 2]


@pytest.mark.skipif(not POSIX, reason="processes are looked for by their numbers")
def test_processes_that_it_started_end_with_it(tmp_path: Path) -> None:
    write(
        tmp_path,
        "other = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])\n"
        f"open({str(tmp_path / 'pid')!r}, 'w').write(str(other.pid))",
    )
    let_loose(tmp_path)
    pid = int((tmp_path / "pid").read_text())
    for _ in range(100):
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        except (FileNotFoundError, ProcessLookupError):
            return
        if state == "Z":
            return
        time.sleep(0.05)
    raise AssertionError(f"process {pid} is still there")


def test_garbage_is_an_invalid_test(tmp_path: Path) -> None:
    write(
        tmp_path,
        "answers = [self.executor.execute_test(what)[:2] for what in ('a road', None, 7, [[1, 2], [3, 4]])]\n"
        "assert answers == [('INVALID', 'Wrong type')] * 4, answers\n"
        "test = RoadTestFactory.create_road_test(straight())\n"
        "test.road_points[1] = (float('nan'), 3)\n"
        "assert self.executor.validate_test(test)[0] is False\n"
        "assert self.executor.execute_test(test)[0] == 'INVALID'\n"
        "test = RoadTestFactory.create_road_test(straight(5.0))\n"
        "test.id = '../../evil'\n"
        "outcome, said, records = self.executor.execute_test(test)\n"
        "assert (outcome, records) == ('PASS', test.execution_data), said\n"
        "test = RoadTestFactory.create_road_test([(100 + i, 100) for i in range(501)])\n"
        "assert self.executor.execute_test(test)[:2] == "
        "('INVALID', 'The road definition contains too many points')\n"
        "assert (test.is_valid, test.validation_message) == "
        "(False, 'The road definition contains too many points')\n"
        "refused = []\n"
        "for points in [(1, 2, 3), (4, 5, 6)], [(50, 50), (50, 50)], [(0, 0), (1e9, 0)]:\n"
        "    try:\n"
        "        RoadTestFactory.create_road_test(points)\n"
        "    except (AssertionError, ValueError) as error:\n"
        "        refused.append(type(error).__name__)\n"
        "assert refused == ['AssertionError', 'ValueError', 'ValueError'], refused",
    )
    work, runs = let_loose(tmp_path, tests=20)
    assert work.ending is not None
    assert work.ending.how == "done", work.ending.sentence
    assert [run.outcome for run in runs] == ["PASS"] * 2 + ["INVALID"] * 5 + ["PASS", "INVALID"]
    assert len(numbers(tmp_path)) == len(runs)
    assert counted(tmp_path)["test_invalid"] == "6"


def test_the_budget_of_tests_ends_it_with_123(tmp_path: Path) -> None:
    write(
        tmp_path,
        "assert not self.executor.is_over()\n"
        "self.two()\n"
        "assert self.executor.is_over()\n"
        "assert self.executor.get_remaining_time()['time-budget'] == 0\n"
        "assert str(self.executor.get_stats()).startswith('test generated: 4')\n"
        "try:\n"
        "    self.two()\n"
        "except SystemExit as error:\n"
        "    print('left with', error.code)\n"
        "    raise",
    )
    work, runs = let_loose(tmp_path, tests=4)
    assert work.ending is not None
    assert work.ending.how == "budget"
    assert len(runs) == 4
    assert "left with 123" in (tmp_path / "out" / "generator.log").read_text()


def test_the_budget_of_time_drops_the_last_test(tmp_path: Path) -> None:
    write(tmp_path, "while True:\n    self.two()")
    work, runs = let_loose(tmp_path, tests=None, time_budget=2, grace=20)
    assert work.ending is not None
    assert work.ending.how == "budget"
    assert runs
    assert numbers(tmp_path) == [*range(1, len(runs) + 1)]
    assert int(counted(tmp_path)["test_generated"]) == len(runs)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"class_name": "Nobody"}, "has no class 'Nobody'; it has .*Generator"),
        ({"module_name": "leaving"}, "SystemExit"),
    ],
)
def test_one_that_cannot_be_loaded_is_told_of(values: dict[str, str], said: str, tmp_path: Path) -> None:
    write(tmp_path, "pass")
    (tmp_path / "leaving.py").write_text("import sys\nsys.exit(4)")
    with pytest.raises(UsageError, match=said):
        let_loose(tmp_path, **values)


def test_folders_and_budgets_are_looked_at_first(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="needs a budget"):
        let_loose(tmp_path, tests=None)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.txt").write_text("mine")
    with pytest.raises(UsageError, match="is not empty"):
        let_loose(tmp_path)


@pytest.mark.parametrize(
    ("module", "name", "tests"), [("random_points", "RandomPoints", 30), ("simple_ga", "SimpleGA", 6)]
)
def test_the_examples_work(module: str, name: str, tests: int, tmp_path: Path) -> None:
    work, runs = let_loose(tmp_path, tests, module_name=module, class_name=name, module_path=str(EXAMPLES))
    assert work.ending is not None
    assert work.ending.is_fine, work.ending.sentence
    assert len(runs) == tests
    assert {run.outcome for run in runs} <= {"PASS", "FAIL", "INVALID"}
    assert any(run.outcome == "PASS" for run in runs)


def test_a_generators_process_needs_no_simulator() -> None:
    code = (
        f"import sys; sys.path.insert(0, {str(NAMES)!r}); import roadgpt_task\n"
        "import roadgpt_inside, roadgpt_sbft.answers\n"
        "roadgpt_inside.Answering.here = roadgpt_sbft.answers.answer\n"
        "from code_pipeline.tests_generation import RoadTestFactory\n"
        "RoadTestFactory.create_road_test([(60, 100), (80, 100), (100, 100)])\n"
        "print(*{name.split('.')[0] for name in sys.modules})"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"mujoco", "numba", "matplotlib"} & {*done.stdout.split()}
