"""What workers print is kept, but not for ever."""

from pathlib import Path

import pytest

from campaign import jobs
from roadgpt.campaign.executors import Job, WorkerConfig
from roadgpt.campaign.executors.processes import Processes
from roadgpt.campaign.workers import worker_log


def test_a_log_that_has_become_too_long_keeps_its_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker_log, "MOST", 700)
    monkeypatch.setattr(worker_log, "KEPT", 300)
    path = tmp_path / "log"
    lines = [f"line {number}\n".encode() for number in range(100)]
    with path.open("ab") as worker:  # as a worker has it, before and after
        worker.writelines(lines)
        worker.flush()
        worker_log.shorten(path)
        left = path.read_bytes().splitlines(keepends=True)
        assert left[0] == worker_log.NOTE
        assert left[1:] == lines[-len(left[1:]) :]
        assert 200 < sum(map(len, left[1:])) <= 300
        worker.write(b"the last line\n")
    assert path.read_bytes() == b"".join(left) + b"the last line\n"
    before = path.read_bytes()
    worker_log.shorten(path)  # short enough: nothing is changed
    assert path.read_bytes() == before
    worker_log.shorten(tmp_path / "none")


def test_one_endless_line_is_no_harm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker_log, "MOST", 1000)
    monkeypatch.setattr(worker_log, "KEPT", 300)
    (tmp_path / "log").write_bytes(b"x" * 5000)
    worker_log.shorten(tmp_path / "log")
    assert (tmp_path / "log").read_bytes() == worker_log.NOTE


def test_workers_that_print_much_leave_a_short_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker_log, "MOST", 20_000)
    monkeypatch.setattr(worker_log, "KEPT", 5_000)
    workers = Processes(WorkerConfig(1, jobs.nothing, 60.0, tmp_path / "log"))
    workers.submit([Job(key, jobs.talks, key) for key in range(50)])
    found = []
    while len(found) < 50:
        found += workers.done(60.0)
    workers.stop()
    said = (tmp_path / "log").read_text()
    assert len(said) <= 20_000
    assert said.endswith("49 says so\n")
