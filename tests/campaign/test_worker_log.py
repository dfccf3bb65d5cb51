"""What workers print is kept, but not for ever."""

from pathlib import Path

import pytest

from campaign import jobs
from roadgpt.campaign import workers
from roadgpt.campaign.executors import WorkerConfig
from roadgpt.campaign.executors.processes import Processes


def test_a_log_that_has_become_too_long_keeps_its_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "LONGEST_LOG", 700)
    monkeypatch.setattr(workers, "KEPT_OF_LOG", 300)
    path = tmp_path / "log"
    lines = [f"line {number}\n".encode() for number in range(100)]
    with path.open("ab") as worker:  # as a worker has it, before and after
        worker.writelines(lines)
        worker.flush()
        workers.shorten(path)
        left = path.read_bytes().splitlines(keepends=True)
        assert left[0] == workers.NOTE
        assert left[1:] == lines[-len(left[1:]) :]
        assert 200 < sum(map(len, left[1:])) <= 300
        worker.write(b"the last line\n")
    assert path.read_bytes() == b"".join(left) + b"the last line\n"
    before = path.read_bytes()
    workers.shorten(path)  # short enough: nothing is changed
    assert path.read_bytes() == before
    workers.shorten(tmp_path / "none")


def test_workers_that_print_much_leave_a_short_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "LONGEST_LOG", 20_000)
    monkeypatch.setattr(workers, "KEPT_OF_LOG", 5_000)
    staff = Processes(WorkerConfig(1, jobs.nothing, 60.0, tmp_path / "log"))
    for key in range(50):
        staff.submit(jobs.talks, key)
    staff.shutdown()
    said = (tmp_path / "log").read_text()
    assert len(said) <= 20_000
    assert said.endswith("49 says so\n")
