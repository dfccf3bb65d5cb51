"""Work on many items: here or in other processes, with a line now and then on how long it takes."""

import time
from collections.abc import Generator, Iterator
from itertools import islice
from pathlib import Path

import pytest

from roadgpt import children
from roadgpt.campaign.executors.processes import unordered_map
from roadgpt.cli.streams import watched
from roadgpt.errors import UsageError


def test_a_line_now_and_then_says_how_long_it_takes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])

    def steps() -> Iterator[int]:
        for number in range(20):
            now[0] += 4.0
            yield number

    assert [*watched(steps(), 20, "faults")] == [*range(20)]
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "roadgpt: 3 of 20 faults, about 1 min 08 s to go"
    assert len(lines) == 6
    assert [*watched(iter([1]), 1, "faults", quiet=True)] == [1]
    assert capsys.readouterr().err == ""


def twice(number: int) -> int:
    if number > 100:
        raise UsageError("too large")
    time.sleep(60 if number == 50 else 0)
    return 2 * number


def test_work_is_done_here_and_what_goes_wrong_comes_back(tmp_path: Path) -> None:
    log = tmp_path / "workers.log"
    assert sorted(unordered_map(twice, [3, 1, 2], 1, log)) == [2, 4, 6]
    with pytest.raises(UsageError, match="too large"):
        [*unordered_map(twice, [101, 1], 1, log)]


def test_work_is_shared_and_who_stops_listening_stops_the_workers(tmp_path: Path) -> None:
    others = {*children._running}  # of earlier tests in this process
    work = unordered_map(twice, [3, 1, 2, 50, 50, 50], 2, tmp_path / "workers.log")
    assert sorted(islice(work, 3)) == [2, 4, 6]
    assert len(children._running - others) == 2
    assert isinstance(work, Generator)
    begun = time.perf_counter()
    work.close()
    assert time.perf_counter() - begun < 10
    assert not children._running - others
