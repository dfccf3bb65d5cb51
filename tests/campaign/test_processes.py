"""Workers that die, hang, or lose their parent; jobs that fail: every job ends once, and says how."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Executor, Future, as_completed, wait
from pathlib import Path
from typing import Any

import pytest

from campaign import jobs
from campaign.jobs import TESTS, at_work, is_alive
from roadgpt import children
from roadgpt.campaign.executors import LostWorkerError, Shared, WorkerConfig
from roadgpt.campaign.executors import processes as shelf
from roadgpt.campaign.executors.processes import Processes
from roadgpt.errors import RoadGPTError, UsageError

SOON = 60.0  # s: far more than anything here takes
unix = pytest.mark.skipif(os.name == "nt", reason="kills as Unix does")


def pool(workers: int, seconds: float, folder: Path) -> Processes:
    """Workers whose jobs may take so long."""
    return Processes(WorkerConfig(workers, jobs.nothing, seconds, folder / "log"))


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Processes]:
    """Two workers, ready, for jobs that let them live."""
    with pool(2, SOON, tmp_path_factory.mktemp("two")) as made:
        [*made.map(jobs.sleeps, [0.1] * 8)]
        yield made


def pid_in(file: Path) -> int:
    """The pid that a job writes down."""
    until = time.monotonic() + SOON
    while not (file.exists() and file.read_text()) and time.monotonic() < until:
        time.sleep(0.05)
    return int(file.read_text())


def gone(*pids: int, seconds: float = 5.0) -> None:
    """Waits until processes have ended: killing is quick, and not at once."""
    until = time.monotonic() + seconds
    while any(map(is_alive, pids)):
        assert time.monotonic() < until
        time.sleep(0.05)


def test_results_come_in_order_with_their_values_and_errors_are_raised_again(two: Processes) -> None:
    assert isinstance(two, Executor)
    assert [*two.map(jobs.square, range(100))] == [number * number for number in range(100)]
    assert [*two.map(jobs.square, [])] == []
    with pytest.raises(ValueError, match="no number 3"):
        [*two.map(jobs.fails_at_three, range(5))]
    assert two.submit(int, "11", base=2).result(SOON) == 3
    assert [each.result() for each in as_completed([two.submit(jobs.square, 7)], SOON)] == [49]


def test_a_shared_value_is_made_once_in_each_worker(two: Processes) -> None:
    hundred, thousand = Shared(100), Shared(1000)
    done = [two.submit(jobs.plus, key, hundred, thousand) for key in range(40)]
    assert [each.result(SOON) for each in done] == [key + 1100 for key in range(40)]
    held = Shared([1, 2])
    places = {two.submit(jobs.identity, held).result(SOON) for _ in range(20)}
    assert len({pid for pid, _ in places}) == len(places)
    with pytest.raises((AttributeError, TypeError)):
        two.submit(jobs.plus, 1, Shared(lambda: 1)).result(SOON)


def test_what_fails_costs_its_own_job(two: Processes) -> None:
    kinds = [jobs.fails_at_three, jobs.square, jobs.unanswerable, jobs.raises_what_cannot_travel, jobs.prints]
    fails, nine, unanswerable, heavy, prints = (two.submit(function, 3) for function in kinds)
    assert isinstance(fails.exception(SOON), ValueError)
    assert nine.result(SOON) == 9
    assert unanswerable.exception(SOON) is not None
    assert "cannot travel" in str(heavy.exception(SOON))
    assert prints.result(SOON) == 3  # what a driver prints does not get between us
    with pytest.raises((AttributeError, TypeError, ValueError)):
        two.submit(lambda item: item, 1).result(SOON)
    assert two.submit(jobs.square, 5).result(SOON) == 25


def test_large_questions_and_answers_come_through(two: Processes) -> None:
    answers = [two.submit(jobs.is_large, 30_000_000) for _ in range(2)]
    assert [len(each.result(SOON)) for each in answers] == [30_000_003] * 2
    assert two.submit(len, bytes(30_000_000)).result(SOON) == 30_000_000


@unix
def test_a_job_that_kills_or_hangs_is_given_up_after_three_workers_and_others_are_done(
    tmp_path: Path,
) -> None:
    """What the hanging workers have started ends with each of them."""
    workers = pool(2, 2.0, tmp_path)
    dies = workers.submit(jobs.dies, 7)
    hangs = workers.submit(jobs.starts_a_program_and_works, str(tmp_path / "pid"))
    others = [workers.submit(jobs.square, key) for key in range(3, 30)]
    first = pid_in(tmp_path / "pid")
    with pytest.raises(LostWorkerError) as error:
        dies.result(SOON)
    assert str(error.value) == "given up: 3 workers ended over it (the last one ended with status 7)"
    with pytest.raises(LostWorkerError) as error:
        hangs.result(SOON)
    assert str(error.value) == "given up: 3 workers ended over it (the last one took longer than 2 s)"
    assert [each.result(SOON) for each in others] == [key * key for key in range(3, 30)]
    last = pid_in(tmp_path / "pid")
    assert first != last
    gone(first, last)
    workers.shutdown(cancel_futures=True)


@pytest.mark.skipif(sys.platform != "linux", reason="asks /proc")
def test_a_job_that_takes_too_much_memory_is_given_up_and_others_are_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(children, "memory_limit", lambda: 700e6)
    monkeypatch.setattr("roadgpt.campaign.workers.MOST_DEATHS", 1)
    workers = pool(1, SOON, tmp_path)
    eats, other = workers.submit(jobs.eats, 800), workers.submit(jobs.square, 5)
    with pytest.raises(LostWorkerError, match=r"1 workers .* last one took 0\.\d GB of memory"):
        eats.result(SOON)
    assert other.result(SOON) == 25
    workers.shutdown()


@unix
def test_every_job_ends_once_while_workers_are_killed(tmp_path: Path) -> None:
    """Also those that have nothing to do, which is nobody's fault."""
    patient, begun = pool(2, SOON, tmp_path), list[Future[float]]()
    for _ in range(3):
        begun += [patient.submit(jobs.sleeps, 0.02) for _ in range(40)]
        time.sleep(0.3)
        for pid in at_work(patient)[:1]:
            os.kill(pid, signal.SIGKILL)
    assert [each.result(SOON) for each in begun] == [0.02] * 120
    for worker in [*patient._workers]:
        assert isinstance(worker, shelf.Process)
        worker.process.kill()
    assert patient.submit(jobs.square, 3).result(SOON) == 9
    patient.shutdown(cancel_futures=True)


def test_a_map_goes_before_jobs_that_wait(two: Processes) -> None:
    waiting = [two.submit(jobs.sleeps, 0.1) for _ in range(40)]
    assert [*two.map(jobs.square, range(8))] == [number * number for number in range(8)]
    assert sum(each.done() for each in waiting) < 30


def test_workers_that_cannot_begin_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("roadgpt.campaign.workers.MOST_DEATHS", 2)
    workers = Processes(WorkerConfig(1, jobs.refuses, SOON, tmp_path / "log"))
    with pytest.raises(UsageError, match="there is no driver of that name"):
        workers.submit(jobs.square, 1).result(SOON)
    with pytest.raises(UsageError, match="there is no driver of that name"):
        workers.submit(jobs.square, 1)
    workers.shutdown()
    workers = Processes(WorkerConfig(1, jobs.leaves, SOON, tmp_path / "log"))
    with pytest.raises(
        RoadGPTError, match=r"workers end before they begin \(the last one ended with status 5\).*log"
    ):
        [*workers.map(jobs.square, [1])]
    workers.shutdown()


def test_workers_that_the_system_cannot_start_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: object, **__: object) -> Any:
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(children, "start", refused)
    workers = Processes(WorkerConfig(2, jobs.nothing, SOON, tmp_path / "log"))
    with pytest.raises(
        RoadGPTError,
        match=r"a worker cannot be started \(Resource temporarily unavailable\); ask for fewer with -j",
    ):
        workers.submit(jobs.square, 1).result(SOON)
    workers.shutdown()


def test_a_shutdown_waits_for_what_was_asked_or_ends_it_at_once(tmp_path: Path) -> None:
    with pool(1, SOON, tmp_path) as workers:
        done = [workers.submit(jobs.sleeps, 0.01) for _ in range(20)]
    assert all(each.done() for each in done)
    assert not workers._workers
    with pytest.raises(RuntimeError):
        workers.submit(jobs.square, 1)
    for is_begun in (False, True):
        workers = pool(2, SOON, tmp_path)
        if is_begun:
            [*workers.map(jobs.square, [1, 2])]
        left = [workers.submit(jobs.sleeps, 1000.0) for _ in range(4)]
        assert left[3].cancel()
        time.sleep(0.2)
        begun = time.monotonic()
        workers.shutdown(cancel_futures=True)
        assert time.monotonic() - begun < 8
        assert not wait(left, 0).not_done
        for each in left:
            with pytest.raises(CancelledError):
                each.result()


@unix
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
    gone(*pids, seconds=SOON)


@unix
@pytest.mark.parametrize("job", [jobs.leaves_its_programs, jobs.starts_a_program_and_works])
def test_what_a_worker_has_started_ends_with_it(tmp_path: Path, job: Callable[[str], object]) -> None:
    patient = pool(1, SOON, tmp_path)
    done = patient.submit(job, str(tmp_path / "pid"))
    pid = pid_in(tmp_path / "pid")
    if job is jobs.leaves_its_programs:
        assert done.result(SOON) == pid
    assert is_alive(pid)
    begun = time.monotonic()
    patient.shutdown(cancel_futures=True)
    assert time.monotonic() - begun < 8
    gone(pid, seconds=0.5)
