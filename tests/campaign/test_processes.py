"""Workers that die, hang, or lose their parent; jobs that fail: every job ends once, and says how."""

import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from campaign import jobs
from campaign.jobs import TESTS, is_alive
from roadgpt.campaign.executors import FinishedJob, Job, WorkerConfig
from roadgpt.campaign.executors import processes as shelf
from roadgpt.campaign.executors.processes import Processes
from roadgpt.errors import RoadGPTError, UsageError

SOON = 60.0  # s: far more than anything here takes


@pytest.fixture
def two(tmp_path: Path) -> Iterator[Processes]:
    """Two workers whose jobs may take two seconds."""
    made = Processes(WorkerConfig(2, jobs.nothing, 2.0, tmp_path / "log"))
    yield made
    made.stop()


def ended(workers: Processes, count: int) -> list[FinishedJob]:
    """What becomes of so many jobs."""
    found: list[FinishedJob] = []
    until = time.monotonic() + SOON
    while len(found) < count and time.monotonic() < until:
        found += workers.done(0.5)
    return found


def pid_in(file: Path) -> int:
    """The pid that a job writes down."""
    until = time.monotonic() + SOON
    while not (file.exists() and file.read_text()) and time.monotonic() < until:
        time.sleep(0.05)
    return int(file.read_text())


def test_results_come_in_order_with_their_values_and_errors_are_raised_again(two: Processes) -> None:
    assert two.map(jobs.square, range(100)) == [number * number for number in range(100)]
    assert two.map(jobs.square, []) == []
    with pytest.raises(ValueError, match="no number 3"):
        two.map(jobs.fails_at_three, range(5))
    two.share("hundred", 100)
    two.share("thousand", 1000)
    two.submit([Job(key, jobs.plus, key, ("hundred", "thousand")) for key in range(40)])
    assert {done.key: done.value for done in ended(two, 40)} == {key: key + 1100 for key in range(40)}
    two.forget("hundred")
    two.share("hundred", 7)  # another value of the same name, once nobody has the old one
    two.submit([Job(key, jobs.plus, key, ("thousand",)) for key in range(4)])
    assert {done.value for done in ended(two, 4)} == {1000, 1001, 1002, 1003}


def test_what_fails_costs_its_own_job(two: Processes) -> None:
    kinds = [jobs.fails_at_three, jobs.square, jobs.unanswerable, jobs.raises_what_cannot_travel, jobs.prints]
    two.submit([Job(key, function, 3) for key, function in enumerate(kinds)])
    found = {done.key: done for done in ended(two, 5)}
    assert isinstance(found[0].error, ValueError)
    assert found[1].value == 9
    assert found[2].error is not None
    assert "cannot travel" in str(found[3].error)
    assert found[4].value == 3  # what a driver prints does not get between us
    with pytest.raises((AttributeError, TypeError, ValueError)):
        two.submit([Job(9, lambda item: item, 1)])
    assert two.map(jobs.square, [5]) == [25]


@pytest.mark.skipif(os.name == "nt", reason="kills as Unix does")
def test_a_job_that_kills_or_hangs_is_given_up_after_three_workers_and_others_are_done(
    two: Processes, tmp_path: Path
) -> None:
    """What the hanging workers have started ends with each of them."""
    two.submit(
        [
            Job(1, jobs.dies, 7),
            Job(2, jobs.starts_a_program_and_works, str(tmp_path / "pid")),
            *(Job(key, jobs.square, key) for key in range(3, 30)),
        ]
    )
    first = pid_in(tmp_path / "pid")
    found = {done.key: done for done in ended(two, 29)}
    assert found[1].lost == "given up: 3 workers ended over it (the last one ended with status 7)"
    assert found[2].lost == "given up: 3 workers ended over it (the last one took longer than 2 s)"
    assert {key: found[key].value for key in range(3, 30)} == {key: key * key for key in range(3, 30)}
    last = pid_in(tmp_path / "pid")
    assert first != last
    until = time.monotonic() + 5  # killing is quick, and not at once
    while is_alive(last) and time.monotonic() < until:
        time.sleep(0.05)
    assert not is_alive(first)
    assert not is_alive(last)
    with pytest.raises(RoadGPTError, match="3 workers ended over it"):
        two.map(jobs.dies, [1])


def test_every_job_ends_once_while_workers_are_killed(tmp_path: Path) -> None:
    workers = Processes(WorkerConfig(2, jobs.nothing, SOON, tmp_path / "log"))
    try:
        workers.submit([Job(key, jobs.sleeps, 0.02) for key in range(120)])
        found: list[FinishedJob] = []
        for _ in range(5):
            found += workers.done(5.0)
            for doing in workers.under_way()[:1]:
                os.kill(int(doing.worker.split("(")[1].rstrip(")")), signal.SIGKILL)
            time.sleep(0.15)
        found += ended(workers, 120 - len(found))
        assert Counter(done.key for done in found) == Counter(range(120))
        assert not any(done.lost or done.error for done in found)
    finally:
        workers.stop()


def test_a_worker_without_a_sign_of_life_is_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shelf, "SILENCE", 2.0)
    workers = Processes(WorkerConfig(1, jobs.nothing, SOON, tmp_path / "log"))
    try:
        workers.submit([Job(1, jobs.stops_itself, str(tmp_path / "was_here"))])
        (done,) = ended(workers, 1)
        assert done.value == "second time"
    finally:
        workers.stop()


def test_a_map_goes_before_jobs_that_wait(two: Processes) -> None:
    two.map(jobs.square, [1, 2])  # both are ready
    two.submit([Job(key, jobs.sleeps, 0.1) for key in range(40)])
    assert two.map(jobs.square, range(8)) == [number * number for number in range(8)]
    assert len(two.done(0.0)) < 30


def test_workers_that_cannot_begin_are_told(tmp_path: Path) -> None:
    workers = Processes(WorkerConfig(1, jobs.refuses, SOON, tmp_path / "log"))
    workers.submit([Job(1, jobs.square, 1)])
    with pytest.raises(UsageError, match="there is no driver of that name"):
        ended(workers, 1)
    workers.stop()
    workers = Processes(WorkerConfig(1, jobs.leaves, SOON, tmp_path / "log"))
    with pytest.raises(
        RoadGPTError, match=r"workers end before they begin \(the last one ended with status 5\).*log"
    ):
        workers.map(jobs.square, [1])
    workers.stop()


@pytest.mark.skipif(os.name == "nt", reason="kills as Unix does")
def test_workers_end_when_their_parent_was_killed() -> None:
    parent = subprocess.Popen(
        [sys.executable, str(TESTS / "campaign" / "jobs.py")], stdout=subprocess.PIPE, text=True, cwd=TESTS
    )
    assert parent.stdout is not None
    pids = [int(pid) for pid in parent.stdout.readline().split()]
    assert len(pids) == 2
    assert all(is_alive(pid) for pid in pids)
    parent.kill()
    parent.wait()
    parent.stdout.close()
    until = time.monotonic() + SOON
    while any(is_alive(pid) for pid in pids) and time.monotonic() < until:
        time.sleep(0.1)
    assert not any(is_alive(pid) for pid in pids)


@pytest.mark.skipif(os.name == "nt", reason="kills as Unix does")
@pytest.mark.parametrize("job", [jobs.leaves_its_programs, jobs.starts_a_program_and_works])
def test_what_a_worker_has_started_ends_with_it(tmp_path: Path, job: Callable[[str], object]) -> None:
    workers = Processes(WorkerConfig(2, jobs.nothing, SOON, tmp_path / "log"))
    workers.submit([Job(1, job, str(tmp_path / "pid"))])
    pid = pid_in(tmp_path / "pid")
    if job is jobs.leaves_its_programs:
        assert len(ended(workers, 1)) == 1
    assert is_alive(pid)
    begun = time.monotonic()
    workers.stop()
    assert time.monotonic() - begun < 8
    time.sleep(0.2)  # killing is quick, and not at once
    assert not is_alive(pid)
